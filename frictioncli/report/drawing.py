"""Figures of the page, drawn as SVG and PNG."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup, escape

from frictioncli.report.diagnosis_section import diagnosis_figures
from frictioncli.report.figure_files import png as png_bytes
from frictioncli.report.figure_files import svg
from frictioncli.report.figures import FIGURES, FigureSpec
from frictioncli.report.operating_point import OVERVIEW
from frictioncli.report.results import JointResults
from frictioncli.report.style import style_context


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnFigure:
    """A figure on the page.

    Attributes
    ----------
    name : str
        Stem of its files.
    title : str
        Heading.
    text : str
        Caption, or why the figure could not be drawn.
    svg : Markup
        SVG element; empty if the figure could not be drawn.
    png : bytes
        Content of the PNG file; empty if it was not asked for.
    printed : bool
        Whether it belongs to the summary that is printed.
    """

    name: str
    title: str
    text: str
    svg: Markup
    png: bytes
    printed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFigures:
    """Figures of one joint.

    Attributes
    ----------
    overview : DrawnFigure
        Friction at a glance.
    paper : list of DrawnFigure
        Figures of the source paper and of the residuals.
    diagnosis : list of DrawnFigure
        Figures of the diagnosis.
    undrawn : list of (str, str)
        Titles of figures that could not be drawn, and the reason that they share.
    """

    overview: DrawnFigure
    paper: list[DrawnFigure]
    diagnosis: list[DrawnFigure]
    undrawn: list[tuple[str, str]]

    @property
    def all(self) -> list[DrawnFigure]:
        """Every figure, in the order of the page."""
        return [self.overview, *self.paper, *self.diagnosis]


def draw_figures(results: JointResults, prefix: str = "", *, png: bool = False) -> JointFigures:
    """Draw all figures of one joint.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    prefix : str
        Prefix of the figures' names, to tell those of several joints apart.
    png : bool
        Whether they are also drawn as PNG.
    """
    paper = [draw_figure(spec, results, prefix, png=png) for spec in FIGURES]
    diagnosis = diagnosis_figures(results.diagnosis)
    return JointFigures(
        overview=draw_figure(OVERVIEW, results, prefix, png=png),
        paper=[figure for figure in paper if figure.svg],
        diagnosis=[draw_figure(spec, results, prefix, png=png) for spec in diagnosis],
        undrawn=_undrawn(paper),
    )


def draw_figure(
    spec: FigureSpec, results: JointResults, prefix: str = "", *, png: bool = False
) -> DrawnFigure:
    """Draw one figure, or state why it cannot be drawn.

    Parameters
    ----------
    spec : FigureSpec
        The figure.
    results : JointResults
        One joint's results.
    prefix : str
        Prefix of the figure's name, to tell those of several joints apart.
    png : bool
        Whether it is also drawn as PNG.
    """
    name = f"{prefix}{spec.name}"
    if missing := spec.missing(results):
        return DrawnFigure(name=name, title=spec.title, text=missing, svg=Markup(""), png=b"")
    with style_context(name):
        figure = spec.draw(results)
        return DrawnFigure(
            name=name,
            title=spec.title,
            text=spec.caption(results),
            svg=Markup(svg(figure, name, str(escape(spec.title)))),
            png=png_bytes(figure) if png else b"",
            printed=spec.printed,
        )


def _undrawn(figures: Sequence[DrawnFigure]) -> list[tuple[str, str]]:
    """Return the titles of figures that could not be drawn, grouped by reason."""
    titles: dict[str, list[str]] = {}
    for figure in figures:
        if not figure.svg:
            titles.setdefault(figure.text, []).append(figure.title)
    return [("; ".join(names), reason) for reason, names in titles.items()]
