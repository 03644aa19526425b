"""The simulator shares no code with what is fitted to its logs."""

import ast
from pathlib import Path

import frictioncli.simulator

ALLOWED = ("errors", "files", "provenance", "simulator")


def test_simulator_imports_nothing_of_the_analysis():
    package = Path(frictioncli.simulator.__file__).parent
    imported = set()
    for module in package.glob("*.py"):
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module == "frictioncli":
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0
                imported |= {(node.module or "").removeprefix("frictioncli.").split(".")[0]} & {
                    part.stem for part in package.parent.iterdir()
                }
    assert imported <= {*ALLOWED, "__version__"}
