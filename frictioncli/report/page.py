"""The report of a work folder: a self-contained page, and its figures as files."""

from collections.abc import Sequence
from pathlib import Path

from frictioncli import __version__
from frictioncli.files import atomic_write
from frictioncli.report.data_section import data_section, ingest_counts
from frictioncli.report.downloads import downloads, write_downloads
from frictioncli.report.drawing import draw_figures
from frictioncli.report.effect_explanations import explanations
from frictioncli.report.figure_files import svg_file
from frictioncli.report.joint_section import JointSection, joint_section
from frictioncli.report.joints_summary import joints_summary
from frictioncli.report.results import WorkFolderResults, read_results
from frictioncli.report.template import render
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
        joint_section(joint, drawn, counts, log_files, len(results.joints))
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
    scripts = [
        "numbers.js",
        "figures.js",
        "pointer.js",
        "points.js",
        "chart.js",
        "maps.js",
        "look.js",
    ]
    if any(not section.explorer.missing for section in sections):
        scripts += ["shapes.js", "explorer.js"]
    return render(
        "page.html.jinja",
        scripts=scripts,
        title=_title([section.number for section in sections]),
        runs=f"{'Run' if len(results.runs) == 1 else 'Runs'}: {list_text(results.runs)}",
        joints=sections,
        summary=joints_summary(sections),
        left_out=results.left_out,
        effects=explanations(results.joints),
        data=data_section(results),
        downloads=downloads(results),
        version=__version__,
    )


def _title(joints: Sequence[int]) -> str:
    if len(joints) == 1:
        return f"Friction of joint {joints[0]}"
    return f"Friction of joints {list_text([str(joint) for joint in joints])}"
