"""Figures as SVG and PNG: the same figure always gives the same bytes."""

import io
import re

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from frictioncli.report.tooltips import tooltips_as_titles

_DPI = 200


def svg(figure: Figure, name: str, title: str) -> str:
    """Return a figure as an SVG element that can stand in a page beside others.

    Parameters
    ----------
    figure : Figure
        The figure.
    name : str
        Prefix of all identifiers in the element, so that those of two figures differ.
    title : str
        Text for screen readers, with markup already escaped.
    """
    stream = io.StringIO()
    # printing by the canvas draws once, where Figure.savefig draws twice
    FigureCanvasSVG(figure).print_svg(
        stream, metadata={"Date": None, "Creator": None, "Format": None, "Type": None}
    )
    # the layout is computed by now: the next drawing need not repeat it
    figure.set_layout_engine("none")
    text = tooltips_as_titles(stream.getvalue())
    text = text[text.index("<svg") :]
    # two images of equal content would have equal identifiers, and nothing refers to them
    text = re.sub(r' id="image[0-9a-f]+"', "", text)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = text.replace("url(#", f"url(#{name}-").replace('href="#', f'href="#{name}-')
    return text.replace("<svg ", f'<svg role="img" aria-label="{title}" ', 1)


def svg_file(element: str) -> str:
    """Return the content of an SVG file.

    Parameters
    ----------
    element : str
        The SVG element.
    """
    return f'<?xml version="1.0" encoding="utf-8"?>\n{element}'


def png(figure: Figure) -> bytes:
    """Return a figure as a PNG without dates or program names.

    Parameters
    ----------
    figure : Figure
        The figure.
    """
    stream = io.BytesIO()
    figure.dpi = _DPI
    FigureCanvasAgg(figure).print_png(stream, metadata={"Software": None})
    return stream.getvalue()
