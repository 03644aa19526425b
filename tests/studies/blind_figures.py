# ruff: noqa: TID251
"""The pictures of the blind study: what was said of what was hidden, and how often it was found."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from frictioncli.simulator.settings import PROTOCOLS
from tests.studies.blind_rows import POWER, asked, claimed_size, interval, powers, sets_of
from tests.studies.blind_worlds import SIZES, UNLISTED
from tests.studies.effect_names import EFFECT_NAMES

COLOURS = dict(zip(PROTOCOLS, ("#0072B2", "#D55E00"), strict=True))
MARKERS = dict(zip(PROTOCOLS, ("o", "s"), strict=True))
SHIFTS = dict(zip(PROTOCOLS, (0.96, 1.04), strict=True))

ANSWERS = ("AMBIGUOUS", "UNNAMED", "NONE")
NOTHING = "(nothing)"
LEAST = 1.0
"""The matrix counts single effects from this size on. [N·m]"""

DPI = 110


def answer(row: dict[str, object]) -> str:
    """Return what a row says: the strongest cause's name, or why there is none."""
    sets = sets_of(str(row["sets"]))
    if row["verdict"] == "no_evidence":
        return "NONE"
    if row["verdict"] == "unnamed" or not sets:
        return "UNNAMED"
    return sets[0][0] if len(sets[0]) == 1 else "AMBIGUOUS"


def confusion(rows: pd.DataFrame) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the shares of the answers per row of the matrix, and the joints behind each row."""
    titles = [*EFFECT_NAMES, *ANSWERS]
    single = asked(rows, "single")
    parts = [asked(rows, "clean")]
    parts += [
        single[(single["hidden"] == name) & (single["size"] >= LEAST)] for name in EFFECT_NAMES
    ]
    unlisted = asked(rows, "unlisted")
    parts += [unlisted[unlisted["hidden"] == name] for name in UNLISTED]
    shares = np.zeros((len(parts), len(titles)))
    for number, part in enumerate(parts):
        for row in part.to_dict("records"):
            shares[number, titles.index(answer(row))] += 1.0 / len(part)
    return shares, np.array([len(part) for part in parts])


def confusion_picture(rows: pd.DataFrame, path: Path) -> None:
    """Draw the confusion matrix of each protocol."""
    figure = Figure(figsize=(13.0, 17.5), layout="constrained")
    panels = figure.subplots(2, 1)
    for axes, protocol in zip(panels, PROTOCOLS, strict=True):
        shares, counts = confusion(rows[rows["protocol"] == protocol])
        _matrix(axes, shares, counts)
        axes.set_title(f"{protocol}: said, in % of what was hidden", loc="left", weight="bold")
    _saved(figure, path)


def _matrix(axes: Axes, shares: NDArray[np.float64], counts: NDArray[np.intp]) -> None:
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
    hidden = [NOTHING, *EFFECT_NAMES, *UNLISTED]
    labels = [f"{name}  ({count})" for name, count in zip(hidden, counts, strict=True)]
    axes.set_yticks(range(len(hidden)), labels, fontsize=9)
    names = [*EFFECT_NAMES, *ANSWERS]
    axes.set_xticks(range(len(names)), names, rotation=45, ha="right", fontsize=9)
    axes.set_xticks(np.arange(len(names) + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(hidden) + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="#E4E6EA", linewidth=0.6)
    axes.tick_params(which="both", length=0)
    axes.axvline(len(EFFECT_NAMES) - 0.5, color="#6B7078", linewidth=1.2)
    for line in (0.5, len(EFFECT_NAMES) + 0.5):
        axes.axhline(line, color="#6B7078", linewidth=1.2)
    right = [
        len(EFFECT_NAMES) + 2,
        *range(len(EFFECT_NAMES)),
        *[len(EFFECT_NAMES) + 1] * len(UNLISTED),
    ]
    for line, column in enumerate(right):
        axes.add_patch(
            Rectangle((column - 0.46, line - 0.46), 0.92, 0.92, fill=False, edgecolor="#D55E00")
        )
    axes.set_ylabel("hidden (joints)")


def power_picture(rows: pd.DataFrame, path: Path) -> None:
    """Draw how often each effect is found by its size, with what the diagnosis claims."""
    figure = Figure(figsize=(13.0, 14.0), layout="constrained")
    panels = figure.subplots(5, 4, sharex=True, sharey=True)
    for axes, name in zip(panels.flat, EFFECT_NAMES, strict=True):
        for protocol in PROTOCOLS:
            _power(axes, rows, name, protocol)
        axes.set_title(name, loc="left", fontsize=10.5, weight="bold")
        axes.axhline(POWER, color="#9AA0A6", linewidth=0.8, linestyle=":")
        axes.set_xscale("log")
        axes.set_xlim(SIZES[0] / 1.5, SIZES[-1] * 1.5)
        axes.set_ylim(-0.04, 1.04)
        axes.set_xticks(SIZES, [f"{size:g}" for size in SIZES])
        axes.set_xticks([], minor=True)
        axes.set_yticks([0.0, 0.5, POWER, 1.0], ["0", "50 %", "80 %", "100 %"])
        axes.grid(color="#E4E6EA", linewidth=0.7)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    figure.supxlabel("size hidden, RMS torque [N·m]")
    figure.supylabel("share of joints with a finding")
    figure.legend(handles=_legend(), loc="outside upper center", ncols=3, frameon=False)
    _saved(figure, path)


def _power(axes: Axes, rows: pd.DataFrame, name: str, protocol: str) -> None:
    power = powers(rows, name, protocol)
    if power.empty:
        return
    found = (power["count"] / power["total"]).to_numpy(float)
    limits = np.array(
        [interval(int(n), int(total)) for n, total in zip(*power.to_numpy().T, strict=True)]
    )
    axes.errorbar(
        power.index.to_numpy(float) * SHIFTS[protocol],
        found,
        yerr=np.maximum([found - limits[:, 0], limits[:, 1] - found], 0.0),
        color=COLOURS[protocol],
        marker=MARKERS[protocol],
        markersize=4.5,
        linewidth=1.6,
        elinewidth=0.8,
        label=protocol,
    )
    claim = claimed_size(rows, name, protocol)
    if claim is not None and claim <= SIZES[-1] * 1.5:
        axes.plot(
            [max(claim, SIZES[0] / 1.4)],
            [POWER],
            color=COLOURS[protocol],
            marker="D",
            markersize=7,
            markerfacecolor="white",
            linestyle="none",
            zorder=5,
        )


def _legend() -> list[Artist]:
    curves: list[Artist] = [
        Line2D([], [], color=COLOURS[protocol], marker=MARKERS[protocol], label=protocol)
        for protocol in PROTOCOLS
    ]
    claim = Line2D([], [], color="#4B4B4B", marker="D", markerfacecolor="white", linestyle="none")
    claim.set_label("size that the diagnosis says it finds four times in five")
    return [*curves, claim]


def _saved(figure: Figure, path: Path) -> None:
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
