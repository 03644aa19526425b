"""Figure of the evidence for one cause: residuals, fitted term, probabilities of effects."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.report.binning import (
    BinnedMeans,
    BinnedSeries,
    bin_means,
    bin_numbers,
    residual_series,
)
from frictioncli.report.panel import name_ticks, stacked
from frictioncli.report.results import JointResults
from frictioncli.report.style import FAINT, MODEL, WIDTH
from frictioncli.wording import in_words, probability_text

AXES = {
    "speed": ("speed |φ'| [deg/s]", 1.0),
    "temperature": ("temperature T [°C]", 1.0),
    "motor_temperature": ("motor temperature Tm [°C]", 1.0),
    "housing_temperature": ("housing temperature Tc [°C]", 1.0),
    "position": ("joint angle φ [deg]", 1.0),
    "load": ("load torque L", 1.0),
    "clock": ("time, run after run [h]", 1 / 3600.0),
    "time": ("time in the run [h]", 1 / 3600.0),
    "travel": ("way travelled [1000 deg]", 1e-3),
    "rest": ("rest before [min]", 1 / 60.0),
    "order": ("pair after the last rest", 1.0),
}
"""Label and scale of each quantity against which residuals are drawn."""

_DISCRETE = ("speed", "order", "position")
"""Variables with a few measured values, between which a line may be drawn."""

_MOST_BARS = 6
_CREDIBLE = "#0072B2"
_PANELS = ("base model", "without this cause", "extended model")


def evidence_figure(results: JointResults, *, diagnosis: Reloaded, index: int) -> Figure:
    """Draw the evidence for one cause: residuals, fitted term, and probabilities of effects.

    The residuals are those of the base model, of the extended model without this cause, and of the
    extended model.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : Reloaded
        The joint's diagnosis.
    index : int
        Index of the cause, from 0.
    """
    seen, cause = diagnosis.seen, diagnosis.causes[index]
    axis, channel = str(cause.seen_in), str(cause.channel)
    bars = shown_probabilities(cause.probabilities, cause.effects)
    low = 0.62 + 0.24 * len(bars)
    figure = Figure(figsize=(WIDTH, 6.6 + low), layout="constrained")
    upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(6.6, low))[:, 0]
    panels = stacked(upper, 3, share_x=True, share_y=True)
    table = seen.problem.table
    rows = pd.DataFrame(
        {
            "bin": bin_numbers(axis, getattr(table, axis)),
            "pair": table.pair,
            "at": getattr(table, axis) * AXES[axis][1] + (axis == "order"),
            "term": seen.terms[index].of(channel),
        }
    )
    residuals = (seen.before[channel], seen.without(index, channel), seen.after[channel])
    for panel, title, residual in zip(panels, _PANELS, residuals, strict=True):
        for series in residual_series(table, axis, channel):
            means = bin_means(rows.assign(mean=residual)[series.rows])
            _draw_means(panel, series, means)
            if title == _PANELS[1]:
                _draw_term(panel, means, series.colour, broken=axis not in _DISCRETE)
        panel.axhline(0.0, color=MODEL, linewidth=0.9, zorder=1)
        panel.set_title(title)
    panels[1].plot([], [], color=FAINT, label="fitted term")
    if axis == "order" or (axis == "speed" and table.speed.max() > 8 * table.speed.min()):
        _logarithmic(panels[0], rows["at"])
    label = AXES[axis][0] + (f" [{results.load_unit}]" if axis == "load" else "")
    panels[-1].set_xlabel(label)
    unit = results.unit if channel == "friction" else results.load_unit
    panels[1].set_ylabel(f"{channel}: measured − simulated [{unit}]")
    handles, labels = panels[1].get_legend_handles_labels()
    upper.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    (shares,) = stacked(lower, 1)
    _draw_probabilities(shares, bars, set(cause.effects))
    return figure


def shown_probabilities(
    probabilities: Mapping[str, float], chosen: Sequence[str]
) -> list[tuple[str, float]]:
    """Return the probabilities shown: the credible set, the most probable others, and the rest.

    Parameters
    ----------
    probabilities : mapping of str to float
        Probability of each effect.
    chosen : sequence of str
        Names of the effects in the credible set.
    """
    ordered = sorted(probabilities.items(), key=lambda entry: (entry[0] not in chosen, -entry[1]))
    shown = ordered[: max(_MOST_BARS, len(chosen))]
    rest = 1.0 - sum(share for _, share in shown)
    return [*shown, ("all others", rest)] if rest >= 5e-4 else shown


def _draw_means(panel: Axes, series: BinnedSeries, means: BinnedMeans) -> None:
    panel.errorbar(
        means.at,
        means.mean,
        yerr=2 * np.nan_to_num(means.error),
        fmt="o",
        color=series.colour,
        markerfacecolor=series.colour if series.filled else "white",
        markersize=4.5 if series.filled else 4,
        elinewidth=1.0,
        capsize=2,
        label=series.name or "residual",
    )


def _draw_term(panel: Axes, means: BinnedMeans, colour: str, *, broken: bool) -> None:
    """Draw the means of the fitted term as a line, broken at bins without data."""
    gaps = np.flatnonzero(np.diff(means.bin) > 1)[: None if broken else 0] + 1
    parts = zip(np.split(means.at, gaps), np.split(means.term, gaps), strict=True)
    for at, term in parts:
        panel.plot(at, term, color=colour, marker="_" if len(at) == 1 else None, markersize=12)


def _logarithmic(panel: Axes, values: pd.Series) -> None:
    panel.set_xscale("log")
    low, high = 0.8 * values.min(), 1.2 * values.max()
    ticks = [mark for mark in (0.1, 0.3, 1, 3, 10, 30, 100, 300) if low < mark < high]
    name_ticks(panel.xaxis, ticks, [f"{value:g}" for value in ticks])


def _draw_probabilities(panel: Axes, bars: list[tuple[str, float]], chosen: set[str]) -> None:
    names = [in_words(name) for name, _ in bars]
    colours = [_CREDIBLE if name in chosen else FAINT for name, _ in bars]
    places = np.arange(len(bars))
    panel.barh(places, [100 * share for _, share in bars], color=colours, height=0.65)
    for place, (_, share) in zip(places, bars, strict=True):
        panel.annotate(
            probability_text(share),
            (100 * share, place),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=9,
        )
    name_ticks(panel.yaxis, places, names)
    panel.set_ylim(len(bars) - 0.3, -0.7)
    panel.set_xlim(0, 112)
    panel.xaxis.set_major_locator(FixedLocator([0, 25, 50, 75, 100]))
    panel.grid(axis="y", visible=False)
    panel.set_xlabel("probability [%]")
