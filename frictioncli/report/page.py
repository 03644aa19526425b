"""The report of a work folder: a page that needs nothing but itself, and its figures as files."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

from frictioncli import __version__
from frictioncli.files import whole
from frictioncli.model.friction import FORM
from frictioncli.report import style
from frictioncli.report.catalogue import FIGURES, FigureEntry, runs_drawn_note
from frictioncli.report.content import (
    ParameterRow,
    TextTable,
    epsilon_tables,
    is_published_joint,
    pairs_table,
    parameter_rows,
)
from frictioncli.report.diagnosis import DiagnosisSection, diagnosis_sections
from frictioncli.report.labels import TEMPERATURE_WORDS, listed
from frictioncli.report.missing import evaluation_missing
from frictioncli.report.quality import data_quality
from frictioncli.report.results import JointResults, read_results
from frictioncli.report.summary import summary


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
    form: str
    symbols: str
    parameters: list[ParameterRow]
    published: bool
    remarks: bool
    epsilon: list[TextTable]
    epsilon_missing: str
    diagnosis: DiagnosisSection
    diagnosis_figures: list[PageFigure]
    runs_note: str
    figures: list[PageFigure]
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
    quality = data_quality(work, results)
    traces = " ".join(quality.files)
    sections = diagnosis_sections(work, results)
    alone = len(results) == 1
    joints = [_page_joint(own, sections[own.joint], traces, alone=alone) for own in results]
    runs = sorted({run for joint in results for run in joint.runs})
    page = _template().render(
        title=_title(results),
        runs=f"{'Run' if len(runs) == 1 else 'Runs'}: {listed(runs)}",
        css=Markup((files("frictioncli.report") / "style.css").read_text(encoding="utf-8")),
        joints=joints,
        quality=quality,
        version=__version__,
    )
    folder = work / "report"
    with whole(folder) as draft:
        draft.mkdir()
        (draft / "index.html").write_text(page, encoding="utf-8", newline="\n")
        drawn = [one for own in joints for one in (*own.diagnosis_figures, *own.figures) if one.svg]
        for figure in drawn:
            (draft / f"{figure.name}.svg").write_text(
                f'<?xml version="1.0" encoding="utf-8"?>\n{figure.svg}',
                encoding="utf-8",
                newline="\n",
            )
            (draft / f"{figure.name}.png").write_bytes(figure.png)
    return folder / "index.html"


def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, keep_trailing_newline=True
    )
    text = (files("frictioncli.report") / "page.html.jinja").read_text(encoding="utf-8")
    return environment.from_string(text)


def _title(results: list[JointResults]) -> str:
    numbers = [str(joint.joint) for joint in results]
    if len(numbers) == 1:
        return f"Friction of joint {numbers[0]}"
    return f"Friction of joints {listed(numbers)}"


def _page_joint(
    results: JointResults, diagnosis: DiagnosisSection, traces: str, *, alone: bool
) -> PageJoint:
    parameters = parameter_rows(results)
    prefix = "" if alone else f"joint{results.joint}-"
    return PageJoint(
        number=results.joint,
        summary=summary(results),
        form=FORM,
        symbols=_symbols(results),
        parameters=parameters,
        published=is_published_joint(results, traces),
        remarks=any(row.remark for row in parameters),
        epsilon=epsilon_tables(results),
        epsilon_missing=evaluation_missing(results),
        diagnosis=diagnosis,
        diagnosis_figures=[page_figure(entry, results, prefix) for entry in diagnosis.entries],
        runs_note=runs_drawn_note(results),
        figures=[page_figure(entry, results, prefix) for entry in FIGURES],
        pairs=pairs_table(results),
    )


def page_figure(entry: FigureEntry, results: JointResults, prefix: str = "") -> PageFigure:
    """Draw one figure, or state why it cannot be drawn.

    Parameters
    ----------
    entry : FigureEntry
        The figure.
    results : JointResults
        One joint's results.
    prefix : str
        Stands before the figure's name where several joints have the same figure.
    """
    name = f"{prefix}{entry.name}"
    if missing := entry.missing(results):
        return PageFigure(name=name, title=entry.title, text=missing, svg=Markup(""), png=b"")
    with style.styled(name):
        figure = entry.draw(results)
        drawn = style.svg(figure, name, str(escape(entry.title)))
        return PageFigure(
            name=name,
            title=entry.title,
            text=entry.caption(results),
            svg=Markup(drawn),
            png=style.png(figure),
        )


def _symbols(results: JointResults) -> str:
    unit, side = results.unit, results.model.torque_side
    at = "" if unit == "A" else f", at the {side}'s side"
    warm = (
        f"; T: {TEMPERATURE_WORDS[results.model.temperature]} in °C"
        if results.model.knows_temperature
        else ""
    )
    return (
        f"tau: friction torque in {unit}{at}; L: load torque in {results.load_unit};"
        f" v: speed in deg/s{warm}."
    )
