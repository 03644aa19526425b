"""Axes of a drawn figure, so that the page can show the values under the pointer."""

import json

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, ScalarFormatter

_DIGITS = 6
"""Digits of limits and positions, more than a screen resolves."""


def panels_text(figure: Figure) -> str:
    """Return the panels of a figure whose axes are quantities, as JSON.

    Each has its left, upper, right and lower edge in points of the SVG, and per axis its name, both
    limits, and whether it is logarithmic. Axes of categories, such as the rows of a map, are left
    out.

    Parameters
    ----------
    figure : Figure
        The figure, drawn, so that its layout is final.
    """
    height, points_per_dot = figure.get_figheight() * 72.0, 72.0 / figure.dpi
    panels = []
    for axes in figure.axes:
        across, up = _quantity(axes, "x"), _quantity(axes, "y")
        if across is None or up is None:
            continue
        box = axes.get_window_extent()
        left, lower, right, upper = (value * points_per_dot for value in box.extents)
        edges = (left, height - upper, right, height - lower)
        panels.append([[round(edge, 2) for edge in edges], across, up])
    return json.dumps(panels, ensure_ascii=False, separators=(",", ":"))


def _quantity(axes: Axes, letter: str) -> list[object] | None:
    """Return name, limits and scale of an axis; None if its places are not values."""
    axis: Axis = getattr(axes, f"{letter}axis")
    if axis.get_scale() not in ("linear", "log") or not _ticks_are_values(axis):
        return None
    # panels that share an axis have its name once
    siblings = getattr(axes, f"get_shared_{letter}_axes")().get_siblings(axes)
    names = (getattr(one, f"get_{letter}label")() for one in (axes, *siblings))
    name = next((text for text in names if text), "")
    if not name:
        return None
    low, high = (float(f"{limit:.{_DIGITS}g}") for limit in getattr(axes, f"get_{letter}lim")())
    return [name, low, high, int(axis.get_scale() == "log")]


def _ticks_are_values(axis: Axis) -> bool:
    formatter = axis.get_major_formatter()
    if isinstance(formatter, ScalarFormatter | LogFormatter):
        return True
    places = [float(place) for place in axis.get_majorticklocs()]
    texts = formatter.format_ticks(places)
    return all(_is_value(text, place) for text, place in zip(texts, places, strict=True))


def _is_value(text: str, place: float) -> bool:
    try:
        return abs(float(text.replace("−", "-")) - place) <= 0.05 * abs(place)
    except ValueError:
        return False
