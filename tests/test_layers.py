"""Imports go only downwards, never in circles; the simulator shares no code with the analysis."""

import ast
import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "frictioncli"

LAYERS = [
    {"__main__"},
    {"cli"},
    {"fleet", "challenge"},
    {"stages"},
    {"report"},
    {"inspection", "design", "deployment", "comparison"},
    {"correction", "diagnosis", "regression"},
    {"model", "effects"},
    {"pairs", "logs", "simulator"},
    {"workfolder"},
    {"tables", "documents", "challenge_schema"},
    {"schemas", "files", "provenance", "workfiles", "options", "parquet_footer"},
    {"linear_algebra", "distributions"},
    {"quantities", "errors", "arrays", "plain_text", "wording", "__init__"},
]
"""Top to bottom; parts of one layer do not know each other."""

MODULES = sorted(PACKAGE.rglob("*.py"))
SCRIPTS = sorted(PACKAGE.rglob("*.js"))


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


SIMULATOR = sorted((PACKAGE / "simulator").rglob("*.py"))


@pytest.mark.parametrize("module", SIMULATOR, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_simulator_shares_no_code_with_the_analysis(module):
    assert imported_parts(module) <= {
        "simulator",
        "errors",
        "files",
        "provenance",
        "documents",
        "options",
        "arrays",
        "__init__",
    }


def test_subfolders_of_the_simulator_are_examined():
    assert {module.parent.name for module in SIMULATOR} == {"simulator", "planted", "nuisances"}


def module_name(module: Path) -> str:
    parts = module.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_modules(code: str, known: set[str]) -> set[str]:
    """Return modules that are imported by name, at the top or inside a function."""
    found = set()
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom):
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in known else node.module or "" for name in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return found & known


def import_graph(modules: list[Path]) -> dict[str, set[str]]:
    # compiled modules are known by their stubs
    known = {module_name(module) for module in [*modules, *PACKAGE.rglob("*.pyi")]}
    return {
        module_name(module): imported_modules(module.read_text(encoding="utf-8"), known)
        for module in modules
    }


def test_no_modules_import_each_other_in_a_circle():
    # raises CycleError, which names the modules of a circle
    order = [*TopologicalSorter(import_graph(MODULES)).static_order()]
    assert {*map(module_name, MODULES)} <= {*order}


def test_an_import_circle_inside_a_function_would_be_seen():
    graph = import_graph(MODULES)
    code = "def f():\n    from frictioncli.files import DRAFT\n    from frictioncli import cli\n"
    seen = imported_modules(code, set(graph))
    assert seen == {"frictioncli.files", "frictioncli.cli"}
    graph["frictioncli.errors"] |= seen
    with pytest.raises(CycleError):
        [*TopologicalSorter(graph).static_order()]


def test_an_upward_import_would_be_seen(tmp_path):
    """The guard itself is tried: a module of ``pairs`` that reaches up to ``model``."""
    module = tmp_path / "bad.py"
    module.write_text("from frictioncli.model.friction import FORM\nimport frictioncli.stages\n")
    assert imported_parts(module) == {"model", "stages"}
    assert all(level(part) < level("pairs") for part in imported_parts(module))


@pytest.mark.parametrize(
    "module", [*MODULES, *SCRIPTS], ids=lambda path: str(path.relative_to(PACKAGE))
)
def test_modules_stay_small(module):
    assert len(module.read_text(encoding="utf-8").splitlines()) <= 320


@pytest.mark.parametrize(
    ("folder", "allowed"),
    [
        ("channels", {"channels", "log_source"}),
        ("formats", {"formats", "channels", "log_source"}),
    ],
)
def test_formats_import_channels_and_channels_import_neither_formats_nor_runs(folder, allowed):
    for module in (PACKAGE / "logs" / folder).glob("*.py"):
        imported = re.findall(r"frictioncli\.logs\.(\w+)", module.read_text(encoding="utf-8"))
        assert set(imported) <= allowed, module


def test_no_class_name_stands_for_two_things():
    owners: dict[str, list[str]] = {}
    for module in MODULES:
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                owners.setdefault(node.name, []).append(str(module.relative_to(PACKAGE)))
    assert {name: places for name, places in owners.items() if len(places) > 1} == {}
