"""Figures as SVG and PNG: the same figure always gives the same bytes."""

import io
import re
from collections.abc import Iterator
from html import escape

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, FigureBase, SubFigure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import Bbox

from frictioncli.report.pointer_values import panels_text
from frictioncli.report.svg_renderer import drawn_as_svg
from frictioncli.report.tooltips import tooltips_as_titles

_DPI = 200

_DIGITS = 9
"""Digits of positions as shares of the figure: fewer than the layout's last ones."""


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
    if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
        figure.set_layout_engine(_RoundedLayout())
    drawn = drawn_as_svg(figure)
    # the layout is computed by now: the next drawing need not repeat it
    figure.set_layout_engine("none")
    panels = escape(panels_text(figure))
    text = tooltips_as_titles(drawn)
    text = text[text.index("<svg") :]
    # two images of equal content would have equal identifiers, and nothing refers to them
    text = re.sub(r' id="image[0-9a-f]+"', "", text)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = text.replace("url(#", f"url(#{name}-").replace('href="#', f'href="#{name}-')
    return text.replace("<svg ", f'<svg role="img" aria-label="{title}" data-panels="{panels}" ', 1)


class _RoundedLayout(ConstrainedLayoutEngine):
    """Constrained layout whose last digits do not depend on where its variables are in memory.

    The solver orders them by address, so that positions differ by 4e-16 from one call to another.
    """

    def execute(self, fig: Figure) -> None:
        """Lay a figure out, and round its positions."""
        super().execute(fig)
        for part in _parts_of(fig):
            corners = part.bbox_relative.get_points().round(_DIGITS)
            part.bbox_relative.p0, part.bbox_relative.p1 = corners
        for axes in fig.axes:
            axes.set_position(Bbox(axes.get_position(original=True).get_points().round(_DIGITS)))


def _parts_of(figure: FigureBase) -> Iterator[SubFigure]:
    for part in figure.subfigs:
        yield part
        yield from _parts_of(part)


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
