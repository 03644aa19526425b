"""The report of a work folder: a self-contained page, and its figures as files."""

from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from frictioncli import __version__
from frictioncli.files import atomic_write
from frictioncli.plain_text import without_control_characters
from frictioncli.report.data_section import data_section, ingest_counts
from frictioncli.report.downloads import downloads, write_downloads
from frictioncli.report.drawing import draw_figures
from frictioncli.report.figure_files import svg_file
from frictioncli.report.formula import unit_markup
from frictioncli.report.joint_section import JointSection, joint_section
from frictioncli.report.results import WorkFolderResults, read_results
from frictioncli.wording import list_text


def write_report(work: Path, *, png: bool = False) -> Path:
    """Write the report of a work folder and return the path of its page.

    An earlier folder ``report`` is replaced. The same inputs give the same bytes.

    Parameters
    ----------
    work : Path
        The work folder, with at least ``torques.parquet`` and ``model.json``.
    png : bool
        Whether each figure is also written as PNG, which takes as long as drawing it.

    Returns
    -------
    Path
        ``work/report/index.html``.

    Raises
    ------
    TableError
        If a needed file is missing, or a file is damaged.
    """
    results = read_results(work)
    several = len(results.joints) > 1
    figures = [
        draw_figures(joint, prefix=f"joint{joint.joint}-" if several else "", png=png)
        for joint in results.joints
    ]
    counts = ingest_counts(results)
    log_files = " ".join(str(file) for file in results.log_files["file"])
    sections = [
        joint_section(joint, drawn, counts, log_files)
        for joint, drawn in zip(results.joints, figures, strict=True)
    ]
    page = _page(results, sections)
    folder = work / "report"
    offered = downloads(results)
    with atomic_write(folder) as draft:
        draft.mkdir()
        write_downloads(work, draft, offered)
        (draft / "index.html").write_text(page, encoding="utf-8", newline="\n")
        for drawn in figures:
            for figure in drawn.all:
                (draft / f"{figure.name}.svg").write_text(
                    svg_file(figure.svg), encoding="utf-8", newline="\n"
                )
                if figure.png:
                    (draft / f"{figure.name}.png").write_bytes(figure.png)
    return folder / "index.html"


def _page(results: WorkFolderResults, sections: Sequence[JointSection]) -> str:
    """Fill in the template of the page."""
    scripts = [_script("figures.js")]
    if any(not section.explorer.missing for section in sections):
        scripts.append(_script("explorer.js"))
    return _template().render(
        title=_title([section.number for section in sections]),
        runs=f"{'Run' if len(results.runs) == 1 else 'Runs'}: {list_text(results.runs)}",
        css=Markup(_resource("style.css")),
        scripts=scripts,
        joints=sections,
        left_out=results.left_out,
        data=data_section(results),
        downloads=downloads(results),
        version=__version__,
    )


def _script(name: str) -> dict[str, str]:
    """Return a script with the digest by which the page allows it."""
    code = _resource(name)
    return {
        "code": Markup(code),
        "digest": b64encode(sha256(code.encode()).digest()).decode(),
    }


def _title(joints: Sequence[int]) -> str:
    if len(joints) == 1:
        return f"Friction of joint {joints[0]}"
    return f"Friction of joints {list_text([str(joint) for joint in joints])}"


def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        finalize=_cleaned,
    )
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters["unit"] = unit_markup
    return environment.from_string(_resource("page.html.jinja"))


def _resource(name: str) -> str:
    return (files("frictioncli.report") / name).read_text(encoding="utf-8")


def _cleaned(value: Any) -> Any:
    """Replace control characters in a value that the template shows, before it is escaped."""
    if isinstance(value, Markup):
        return Markup(without_control_characters(value))
    return without_control_characters(value) if isinstance(value, str) else value
