"""The report of a work folder: a page that needs nothing but itself, and its figures as files."""

from base64 import b64encode
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

from frictioncli import __version__
from frictioncli.files import whole
from frictioncli.plain_text import without_control_characters
from frictioncli.report import style
from frictioncli.report.data_section import data_section
from frictioncli.report.diagnosis_section import DiagnosisSection, diagnosis_sections
from frictioncli.report.explorer import Explorer, explorers
from frictioncli.report.figures import FIGURES, FigureSpec, runs_drawn_note
from frictioncli.report.formula import formula_symbols, friction_formula, unit_markup
from frictioncli.report.labels import list_text
from frictioncli.report.missing_data import evaluation_missing
from frictioncli.report.page_tables import TextTable, epsilon_tables, pairs_table
from frictioncli.report.parameters import (
    ParameterRow,
    correlation_table,
    is_published_joint,
    limitations,
    parameter_rows,
)
from frictioncli.report.quality_ratings import IngestCounts, QualityRating, quality_ratings
from frictioncli.report.results import JointResults, read_results
from frictioncli.report.summary import KeyNumber, key_numbers, measurement_text, summary_text


@dataclass(frozen=True, slots=True, kw_only=True)
class PageFigure:
    """A figure on the page, or the statement that stands in its place when ``svg`` is empty."""

    name: str
    title: str
    text: str
    svg: Markup
    png: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class PageJoint:
    """What the template shows of one joint."""

    number: int
    summary: str
    measured: str
    formula: Markup
    symbols: str
    key_numbers: list[KeyNumber]
    lights: list[QualityRating]
    parameters: list[ParameterRow]
    published: bool
    remarks: bool
    correlations: TextTable | None
    unknowns: list[str]
    epsilon: list[TextTable]
    epsilon_missing: str
    explorer: Explorer
    diagnosis: DiagnosisSection
    diagnosis_figures: list[PageFigure]
    runs_note: str
    figures: list[PageFigure]
    undrawn: list[tuple[str, str]]
    pairs: TextTable


def write_report(work: Path) -> Path:
    """Write the report of a work folder and return the path of its page.

    The folder ``report`` in it is replaced as a whole. The same inputs give the same bytes.

    Parameters
    ----------
    work : Path
        The work folder, with at least ``torques.parquet`` and ``model.json``.

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
    quality = data_section(work, results)
    shown = _page_joints(work, results, quality.reading, " ".join(quality.files))
    runs = sorted({run for joint in results for run in joint.runs})
    script = _packaged("explorer.js")
    page = _template().render(
        title=_title(results),
        runs=f"{'Run' if len(runs) == 1 else 'Runs'}: {list_text(runs)}",
        css=Markup(_packaged("style.css")),
        script=Markup(script),
        script_digest=b64encode(sha256(script.encode()).digest()).decode(),
        joints=shown,
        quality=quality,
        version=__version__,
    )
    folder = work / "report"
    with whole(folder) as draft:
        draft.mkdir()
        (draft / "index.html").write_text(page, encoding="utf-8", newline="\n")
        drawn = [one for own in shown for one in (*own.diagnosis_figures, *own.figures) if one.svg]
        for figure in drawn:
            (draft / f"{figure.name}.svg").write_text(
                f'<?xml version="1.0" encoding="utf-8"?>\n{figure.svg}',
                encoding="utf-8",
                newline="\n",
            )
            (draft / f"{figure.name}.png").write_bytes(figure.png)
    return folder / "index.html"


def _packaged(name: str) -> str:
    return (files("frictioncli.report") / name).read_text(encoding="utf-8")


def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        finalize=_cleaned,
    )
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters["unit"] = unit_markup
    return environment.from_string(_packaged("page.html.jinja"))


def _cleaned(value: Any) -> Any:
    """Remove control characters from a value that the template shows, before it is escaped."""
    if isinstance(value, Markup):
        return Markup(without_control_characters(value))
    return without_control_characters(value) if isinstance(value, str) else value


def _title(results: list[JointResults]) -> str:
    numbers = [str(joint.joint) for joint in results]
    if len(numbers) == 1:
        return f"Friction of joint {numbers[0]}"
    return f"Friction of joints {list_text(numbers)}"


def _page_joints(
    work: Path, results: list[JointResults], reading: IngestCounts, traces: str
) -> list[PageJoint]:
    diagnoses, explored = diagnosis_sections(work, results), explorers(work, results)
    return [
        _page_joint(
            own,
            diagnoses[own.joint],
            explored[own.joint],
            quality_ratings(own, reading, diagnoses[own.joint].document),
            published=is_published_joint(own, traces),
            prefix="" if len(results) == 1 else f"joint{own.joint}-",
        )
        for own in results
    ]


def _page_joint(
    results: JointResults,
    diagnosis: DiagnosisSection,
    explorer: Explorer,
    judged: list[QualityRating],
    *,
    published: bool,
    prefix: str,
) -> PageJoint:
    parameters = parameter_rows(results)
    figures = [page_figure(entry, results, prefix) for entry in FIGURES]
    return PageJoint(
        number=results.joint,
        summary=summary_text(results, diagnosis.document),
        measured=measurement_text(results),
        formula=friction_formula(results),
        symbols=formula_symbols(results),
        key_numbers=key_numbers(results, diagnosis.document),
        lights=judged,
        parameters=parameters,
        published=published,
        remarks=any(row.remark for row in parameters),
        correlations=correlation_table(results),
        unknowns=limitations(results, diagnosis.document),
        epsilon=epsilon_tables(results),
        epsilon_missing=evaluation_missing(results),
        explorer=explorer,
        diagnosis=diagnosis,
        diagnosis_figures=[page_figure(entry, results, prefix) for entry in diagnosis.entries],
        runs_note=runs_drawn_note(results),
        figures=[figure for figure in figures if figure.svg],
        undrawn=_undrawn(figures),
        pairs=pairs_table(results),
    )


def _undrawn(figures: list[PageFigure]) -> list[tuple[str, str]]:
    """Return the titles of figures that could not be drawn, by the reason."""
    titles: dict[str, list[str]] = {}
    for figure in figures:
        if not figure.svg:
            titles.setdefault(figure.text, []).append(figure.title)
    return [("; ".join(own), reason) for reason, own in titles.items()]


def page_figure(entry: FigureSpec, results: JointResults, prefix: str = "") -> PageFigure:
    """Draw one figure, or state why it cannot be drawn.

    Parameters
    ----------
    entry : FigureSpec
        The figure.
    results : JointResults
        One joint's results.
    prefix : str
        Stands before the figure's name where several joints have the same figure.
    """
    name = f"{prefix}{entry.name}"
    if missing := entry.missing(results):
        return PageFigure(name=name, title=entry.title, text=missing, svg=Markup(""), png=b"")
    with style.style_context(name):
        figure = entry.draw(results)
        return PageFigure(
            name=name,
            title=entry.title,
            text=entry.caption(results),
            svg=Markup(style.svg(figure, name, str(escape(entry.title)))),
            png=style.png(figure),
        )
