"""Write the table of folders in docs/design.md: what each holds, and what it imports.

Usage: python docs/folders.py
"""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "frictioncli"
PAGE = Path(__file__).with_name("design.md")
BEGIN, END = "<!-- folders -->\n", "<!-- /folders -->"


def parts() -> dict[str, list[Path]]:
    """Return the modules of each folder of the package; a module outside them is its own part."""
    found: dict[str, list[Path]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        first = path.relative_to(PACKAGE).parts[0]
        if not first.startswith("__"):
            found.setdefault(first, []).append(path)
    return found


def imported(module: Path) -> set[str]:
    """Return the parts of the package that a module imports, inside functions too."""
    names = set()
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    inside = (name.split(".") for name in names)
    return {rest[0] for package, *rest in inside if package == "frictioncli" and rest}


def table() -> str:
    """Return the table as Markdown, folders that import most first."""
    modules = parts()
    known = {name.removesuffix(".py"): name for name in modules}
    imports = {
        name: set().union(*map(imported, paths)) & known.keys() - {name.removesuffix(".py")}
        for name, paths in modules.items()
    }

    def depth(name: str) -> int:
        return 1 + max((depth(known[one]) for one in imports[name]), default=0)

    lines = ["| part | holds | imports |", "|---|---|---|"]
    for name in sorted(modules, key=lambda one: (-depth(one), one)):
        first = PACKAGE / name if name.endswith(".py") else PACKAGE / name / "__init__.py"
        summary = (ast.get_docstring(ast.parse(first.read_text(encoding="utf-8"))) or "").split(
            "\n"
        )
        shown = name if name.endswith(".py") else f"{name}/"
        folders = sorted(one for one in imports[name] if not known[one].endswith(".py"))
        lines.append(f"| `{shown}` | {summary[0].rstrip('.')} | {', '.join(folders)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Replace the table in the page."""
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    PAGE.write_text(before + BEGIN + table() + END + rest.split(END)[1], encoding="utf-8")


if __name__ == "__main__":
    main()
