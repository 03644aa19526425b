"""Imports go only downwards, and the simulator shares no code with what it tests."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "frictioncli"

LAYERS = [
    {"__main__"},
    {"cli"},
    {"fleet"},
    {"stages"},
    {"workfolder"},
    {"report", "inspection", "design", "deployment", "comparison"},
    {"correction", "diagnosis"},
    {"model", "effects"},
    {"pairs", "logs", "simulator"},
    {"tables", "documents"},
    {"schemas", "files", "provenance", "workfiles"},
    {"linear_algebra"},
    {"quantities", "errors", "arrays", "plain_text", "__init__"},
]
"""Top to bottom; parts of one layer do not know each other."""

MODULES = sorted(PACKAGE.rglob("*.py"))


def level(part: str) -> int:
    return next(number for number, layer in enumerate(LAYERS) if part in layer)


def part_of(module: Path) -> str:
    return module.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported_parts(module: Path) -> set[str]:
    parts = set()
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            if node.module != "frictioncli":
                names = [node.module or ""]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            package, _, rest = name.partition(".")
            if package == "frictioncli":
                part = rest.split(".")[0]
                parts.add("__init__" if part == "__version__" or not part else part)
    return parts


@pytest.mark.parametrize("module", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_go_downwards(module):
    own = part_of(module)
    upward = {part for part in imported_parts(module) if part != own and level(part) <= level(own)}
    assert not upward


def test_every_part_has_a_layer():
    assert {part_of(module) for module in MODULES} == set().union(*LAYERS)


def test_simulator_knows_nothing_of_the_model_it_tests():
    for module in (PACKAGE / "simulator").glob("*.py"):
        forbidden = {"model", "pairs", "correction", "logs", "report", "stages"}
        assert not imported_parts(module) & forbidden, module


def test_an_upward_import_would_be_seen(tmp_path):
    """The guard itself is tried: a module of ``pairs`` that reaches up to ``model``."""
    module = tmp_path / "bad.py"
    module.write_text("from frictioncli.model.friction import FORM\nimport frictioncli.stages\n")
    assert imported_parts(module) == {"model", "stages"}
    assert all(level(part) < level("pairs") for part in imported_parts(module))


@pytest.mark.parametrize("module", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_modules_stay_small(module):
    assert len(module.read_text(encoding="utf-8").splitlines()) <= 320
