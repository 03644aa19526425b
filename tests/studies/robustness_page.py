"""The parts of docs/robustness.md that studies write."""

from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "robustness.md"


def row(name: str, begin: str) -> str:
    """Return the line between a name's marks that begins so; empty if there is none."""
    _, _, rest = PAGE.read_text(encoding="utf-8").partition(f"<!-- {name} -->\n")
    part, _, _ = rest.partition(f"<!-- /{name} -->")
    return next((line for line in part.splitlines() if line.startswith(begin)), "")


def put(name: str, text: str) -> None:
    """Replace what stands between the page's marks ``<!-- name -->`` and ``<!-- /name -->``."""
    begin, end = f"<!-- {name} -->\n", f"<!-- /{name} -->"
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(begin)
    _, _, after = rest.partition(end)
    PAGE.write_text(f"{before}{begin}{text}\n{end}{after}", encoding="utf-8", newline="\n")
