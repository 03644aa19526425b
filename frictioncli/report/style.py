"""Appearance of the figures: one style, one colour per speed, labels that do not overlap.

matplotlib's global settings stay as they are: :func:`style_context` applies the style within a
``with`` block only.
"""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from frictioncli.report.panel import stacked
from frictioncli.report.tooltips import set_tooltips

WIDTH = 5.6
"""Width of every figure, narrow enough that its text can be read on a phone. [inch]"""

RASTER_FROM = 3000
"""Number of points above which they are stored as an image in the SVG, to keep it small."""

_MOST_TOOLTIPS = 1000
"""Greatest number of tooltips per series; more would make the page large."""

_LINE_HEIGHT = 0.18
"""Line height of the smallest text. [inch]"""

_LEGEND_CHARACTERS = 56
"""Characters that have room above a panel, in a legend and a title."""

_HANDLE_CHARACTERS = 5
"""Width of a legend's mark, in characters."""

_LEGEND_ROW = 13.0
"""Height of a row of a legend. [pt]"""

HEATING = "#C44536"
COOLING = "#2B6CB0"
OTHER_PHASE = "#8A8F98"
MODEL = "#222222"
FAINT = "#9AA0A6"

PHASES = ("heat-up", "cool-down")
"""The phases of a thermal cycle, in the order in which they are drawn."""

PHASE_COLOURS = {"heat-up": HEATING, "cool-down": COOLING}
PHASE_WORDS = {"heat-up": "heating", "cool-down": "cooling"}

_SPEED_COLOURS = ("#0072B2", "#009E73", "#9A7D00", "#D55E00", "#A03C78", "#4B4B4B")
_DARK_ENOUGH = 1.05 / 4.6 - 0.05
"""Relative luminance of text that stands out of white by 4.6 to 1; WCAG 2.1 AA asks for 4.5."""

_SLOWEST = "#6A5ACD"
_FASTEST = "#5C1A33"
_MARKERS = ("o", "s", "^", "D", "v", "P")

_STYLE = {
    "font.family": "sans-serif",
    # every text of an SVG repeats this list; these fonts are about as wide as each other
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial", "Helvetica"],
    "font.size": 9.5,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    # the height at which titles stand anyway: matplotlib would measure every tick label for it
    "axes.titley": 1.0,
    "axes.labelsize": 9.5,
    "xtick.labelsize": 9.0,
    "ytick.labelsize": 9.0,
    "legend.fontsize": 9.0,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E4E6EA",
    "grid.linewidth": 0.7,
    "axes.edgecolor": "#6B7078",
    "lines.linewidth": 1.6,
    "lines.markersize": 4.5,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "axes.unicode_minus": True,
    "svg.fonttype": "none",
}


@dataclass(frozen=True, slots=True)
class SpeedStyle:
    """Colour and marker of one speed, the same in every figure of a joint."""

    colour: str
    marker: str


def style_context(salt: str = "frictioncli") -> AbstractContextManager[None]:
    """Return a context manager in which figures are drawn and saved in this style.

    Parameters
    ----------
    salt : str
        Seed of the identifiers in the SVG, which are then the same at every call.
    """
    settings: dict[Any, Any] = {**_STYLE, "svg.hashsalt": salt}
    return matplotlib.rc_context(settings)


def speed_styles(pairs: pd.DataFrame) -> dict[float, SpeedStyle]:
    """Return a style per speed: distinct colours for the main speeds, interpolated between them.

    The main speeds are those of the thermal cycle or, without one, all speeds.

    Parameters
    ----------
    pairs : DataFrame
        One row per pair with ``speed`` and ``phase``.
    """
    speeds = sorted({float(speed) for speed in pairs["speed"]})
    main = sorted({float(s) for s in pairs.loc[pairs["phase"].isin(PHASES), "speed"]}) or speeds
    anchors = dict(zip(main, _spread_colours(len(main)), strict=True))
    if speeds[0] < main[0]:
        anchors[speeds[0]] = _SLOWEST
    if speeds[-1] > main[-1]:
        anchors[speeds[-1]] = _FASTEST
    at = sorted(anchors)
    channels = np.array([to_rgb(anchors[speed]) for speed in at])
    return {
        speed: SpeedStyle(
            _interpolated(np.log(speed), np.log(at), channels),
            _MARKERS[(main.index(speed) if speed in main else rank) % len(_MARKERS)],
        )
        for rank, speed in enumerate(speeds)
    }


def _spread_colours(count: int) -> list[str]:
    if count <= len(_SPEED_COLOURS):
        # few speeds: skip colours in the middle, so that neighbours differ most
        chosen = {1: (0,), 2: (0, 3), 3: (0, 1, 3)}.get(count, range(count))
        return [_SPEED_COLOURS[i] for i in chosen]
    channels = np.array([to_rgb(colour) for colour in _SPEED_COLOURS])
    at = np.linspace(0, len(_SPEED_COLOURS) - 1, count)
    known = np.arange(len(_SPEED_COLOURS))
    return [_interpolated(float(x), known, channels) for x in at]


def _interpolated(at: float, known: np.ndarray, channels: np.ndarray) -> str:
    red, green, blue = (float(np.interp(at, known, channels[:, i])) for i in range(3))
    return to_hex((red, green, blue))


def panels(rows: int, *, height: float, share_y: bool = True) -> tuple[Figure, list[Axes]]:
    """Return a figure of panels in one column with a common horizontal axis, and its panels.

    Parameters
    ----------
    rows : int
        Number of panels.
    height : float
        Height of each panel. [inch]
    share_y : bool
        Whether they also share the vertical axis.
    """
    figure = Figure(figsize=(WIDTH, height * rows + 0.5), layout="constrained")
    return figure, stacked(figure, rows, share_x=True, share_y=share_y)


def points(
    axes: Axes,
    x: ArrayLike,
    y: ArrayLike,
    style: SpeedStyle,
    *,
    filled: bool = True,
    size: float = 3.5,
    opacity: float = 1.0,
    tooltips: Sequence[str] = (),
) -> None:
    """Draw measured points of one speed.

    Parameters
    ----------
    axes : Axes
        The panel.
    x, y : array_like
        Coordinates of the points.
    style : SpeedStyle
        Colour and marker.
    filled : bool
        Whether the markers are filled or hollow.
    size : float
        Size of the markers. [pt]
    opacity : float
        Opacity of the markers, from 0 to 1.
    tooltips : sequence of str
        Tooltip of each point; empty for none.
    """
    if not np.size(x):
        return
    (drawn,) = axes.plot(
        np.asarray(x),
        np.asarray(y),
        linestyle="none",
        marker=style.marker,
        color=style.colour,
        markerfacecolor=style.colour if filled else "white",
        markeredgewidth=0.0 if filled else 1.0,
        markersize=size,
        alpha=opacity,
        rasterized=np.size(x) > RASTER_FROM,
    )
    if 0 < len(tooltips) <= _MOST_TOOLTIPS:
        set_tooltips(drawn, tooltips)


def legend_above(axes: Axes) -> None:
    """Put the legend above the panel, right of its title, so that it covers no data.

    A long legend has several rows, and a title beside which it has no room stands above it. Call
    this after the title is set.
    """
    labels = axes.get_legend_handles_labels()[1]
    if not labels:
        return
    widths = [len(label) + _HANDLE_CHARACTERS for label in labels]
    rows = -(-sum(widths) // _LEGEND_CHARACTERS)
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 0.99),
        ncols=-(-len(labels) // rows),
        borderaxespad=0.0,
        columnspacing=1.0,
        handlelength=1.4,
        handletextpad=0.4,
    )
    title = axes.get_title("left")
    if title and len(title) + sum(widths) / rows > _LEGEND_CHARACTERS:
        axes.set_title(title, loc="left", pad=6 + _LEGEND_ROW * rows)


def label_right(axes: Axes, labels: Sequence[tuple[float, str, str]], *, height: float) -> None:
    """Write labels to the right of a panel, moved apart where they would overlap.

    Parameters
    ----------
    axes : Axes
        The panel; its vertical limits must be final.
    labels : sequence of (float, str, str)
        Vertical position in data units, text and colour of each label.
    height : float
        Height of the panel with its margins. [inch]
    """
    ordered = sorted(label for label in labels if np.isfinite(label[0]))
    if not ordered:
        return
    low, high = axes.get_ylim()
    axes.set_ylim(low, high)
    line = (high - low) * _LINE_HEIGHT / height
    positions = _moved_apart(np.array([y for y, _, _ in ordered]), line)
    for position, (y, text, colour) in zip(positions, ordered, strict=True):
        axes.annotate(
            text,
            xy=(1.0, y),
            xytext=(1.02, position),
            xycoords=("axes fraction", "data"),
            textcoords=("axes fraction", "data"),
            color=_text_colour(colour),
            fontsize=9,
            va="center",
            annotation_clip=False,
        )


def _text_colour(colour: str) -> str:
    """Return a colour, darkened at the same hue where text in it would be faint on white."""
    srgb = np.array(to_rgb(colour))
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    linear *= _DARK_ENOUGH / max(float(linear @ (0.2126, 0.7152, 0.0722)), _DARK_ENOUGH)
    darkened = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    return to_hex((float(darkened[0]), float(darkened[1]), float(darkened[2])))


def _moved_apart(wanted: np.ndarray, gap: float) -> np.ndarray:
    """Return ascending positions at least ``gap`` apart, closest to ``wanted`` in least squares."""
    offsets = np.arange(len(wanted)) * gap
    reduced = wanted - offsets
    # isotonic regression by pooling adjacent violators
    blocks: list[list[float]] = []
    for value in reduced:
        blocks.append([float(value), 1.0])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            mean, count = blocks.pop()
            before, size = blocks.pop()
            blocks.append([(mean * count + before * size) / (count + size), count + size])
    return np.concatenate([np.full(int(size), mean) for mean, size in blocks]) + offsets
