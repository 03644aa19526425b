# ruff: noqa: TID251
"""The pictures of the blind study: what was said of what was hidden, and how often it was named."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from frictioncli.report.style import style_context
from frictioncli.simulator.settings import PROTOCOLS
from tests.studies.blind_rows import Joint, interval, of_kind
from tests.studies.blind_worlds import LISTED, UNLISTED

ANSWERS = ("SET", "UNNAMED", "NONE")
NOTHING = "(nothing)"
LEAST = 1.0
"""The matrix counts single effects from this size on. [N·m]"""

EDGES = np.array([0.0, 0.35, 0.7, 1.0, 1.5, 2.5, 5.0, np.inf])
"""Edges of what is left of an effect, over the margin."""

COLOURS = ("#0072B2", "#009E73", "#D55E00")

DPI = 110


def answer(joint: Joint) -> str:
    """Return what is said of a joint: the strongest cause's name, or why there is none."""
    if joint.sets:
        first = joint.sets[0]
        return first[0] if len(first) == 1 else "SET"
    return "UNNAMED" if joint.structure is not None else "NONE"


def confusion(joints: Sequence[Joint]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the shares of the answers per row of the matrix, and the joints behind each row."""
    titles = [*LISTED, *ANSWERS]
    single = [one for one in of_kind(joints, "single") if one.world.size >= LEAST and one.possible]
    unlisted = of_kind(joints, "unlisted")
    parts = [of_kind(joints, "clean")]
    parts += [[one for one in single if one.world.hidden == name] for name in LISTED]
    parts += [[one for one in unlisted if one.world.hidden == name] for name in UNLISTED]
    shares = np.zeros((len(parts), len(titles)))
    for number, part in enumerate(parts):
        for one in part:
            shares[number, titles.index(answer(one))] += 1.0 / len(part)
    return shares, np.array([len(part) for part in parts])


def confusion_picture(joints: Sequence[Joint], path: Path) -> None:
    """Draw the confusion matrix of each programme."""
    with style_context():
        _draw_confusion(joints, path)


def _draw_confusion(joints: Sequence[Joint], path: Path) -> None:
    figure = Figure(figsize=(13.0, 18.0), layout="constrained")
    panels = figure.subplots(2, 1)
    for axes, protocol in zip(panels, PROTOCOLS, strict=True):
        shares, counts = confusion([one for one in joints if one.world.protocol == protocol])
        _matrix(axes, shares, counts)
        axes.set_title(f"{protocol} programme: share of joints [%]; orange: right answer")
    _saved(figure, path)


def _matrix(axes: Axes, shares: NDArray[np.float64], counts: NDArray[np.intp]) -> None:
    axes.grid(visible=False)
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for line, column in np.argwhere(shares >= 0.005):
        value = shares[line, column]
        axes.text(
            column,
            line,
            f"{100 * value:.0f}",
            ha="center",
            va="center",
            fontsize=9,
            color="white" if value > 0.6 else "black",
        )
    hidden = [NOTHING, *LISTED, *UNLISTED]
    labels = [f"{name}  ({count})" for name, count in zip(hidden, counts, strict=True)]
    axes.set_yticks(range(len(hidden)), labels, fontsize=9)
    names = [*LISTED, *ANSWERS]
    axes.set_xticks(range(len(names)), names, rotation=45, ha="right", fontsize=9)
    axes.set_xticks(np.arange(len(names) + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(hidden) + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="#E4E6EA", linewidth=0.6)
    axes.tick_params(which="both", length=0)
    axes.axvline(len(LISTED) - 0.5, color="#6B7078", linewidth=1.2)
    for line in (0.5, len(LISTED) + 0.5):
        axes.axhline(line, color="#6B7078", linewidth=1.2)
    right = [len(LISTED) + 2, *range(len(LISTED)), *[len(LISTED) + 1] * len(UNLISTED)]
    for line, column in enumerate(right):
        axes.add_patch(
            Rectangle((column - 0.46, line - 0.46), 0.92, 0.92, fill=False, edgecolor="#D55E00")
        )
    axes.set_ylabel("hidden effect (number of joints)")
    axes.set_xlabel("diagnosis: name given, set of names, structure without a name, or nothing")


def power_picture(joints: Sequence[Joint], path: Path) -> None:
    """Draw how often a single effect is named, by what is left of it over the margin."""
    with style_context():
        _draw_power(joints, path)


def _draw_power(joints: Sequence[Joint], path: Path) -> None:
    single = [one for one in of_kind(joints, "single") if one.possible]
    ratio = np.array([one.hidden[0]["left"] / one.margin for one in single])
    place = np.searchsorted(EDGES, ratio, side="right") - 1
    figure = Figure(figsize=(9.0, 4.6), layout="constrained")
    axes = figure.subplots()
    series = (
        ("right name in a set", [one.held for one in single]),
        ("right name alone", [one.alone for one in single]),
        ("any wrong name", [bool(one.wrong) for one in single]),
    )
    bins = [number for number in range(len(EDGES) - 1) if np.any(place == number)]
    for shift, colour, (label, flags) in zip((-0.12, 0.0, 0.12), COLOURS, series, strict=True):
        told = np.array(flags, dtype=bool)
        counts = [(int(told[place == one].sum()), int(np.sum(place == one))) for one in bins]
        shares = np.array([count / total for count, total in counts])
        ends = np.array([interval(count, total) for count, total in counts]).reshape(-1, 2)
        reach = np.abs(np.array([shares - ends[:, 0], ends[:, 1] - shares]))
        at = np.arange(len(bins)) + shift
        axes.errorbar(at, shares, yerr=reach, fmt="o", color=colour, label=label, capsize=2)
    axes.set_xticks(
        range(len(bins)),
        [f"{_span(one)}\n({int(np.sum(place == one))})" for one in bins],
    )
    axes.axhline(0.9, color="#9AA0A6", linewidth=0.8, linestyle=":")
    axes.set_ylim(-0.03, 1.03)
    axes.set_ylabel("share of joints, with 95 % interval")
    axes.set_xlabel(
        "RMS that the base model leaves of the effect, divided by the margin (number of joints)"
    )
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    _saved(figure, path)


def _span(number: int) -> str:
    low, high = EDGES[number], EDGES[number + 1]
    return f"> {low:g}" if np.isinf(high) else f"{low:g} to {high:g}"


def _saved(figure: Figure, path: Path) -> None:
    FigureCanvasAgg(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
