"""Figures of measured and simulated torque, and of the residuals before and after extension."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.diagnosis.documents.reload import Misfits, Reloaded
from frictioncli.report.binning import bin_numbers, is_warming, merge_close_values
from frictioncli.report.labels import figure_text
from frictioncli.report.panel import stacked
from frictioncli.report.results import JointResults
from frictioncli.report.style import (
    COOLING,
    FAINT,
    HEATING,
    MODEL,
    WIDTH,
    SpeedStyle,
    legend_above,
)
from frictioncli.wording import number_text, speed_text

_CLOCK = 1 / 3600.0
_MOST_SPEEDS = 4
_BEFORE, _AFTER = "#D55E00", "#0072B2"

_ROOM_FOR_NAMES = 0.15
"""Room for the names of runs in a panel, as a share of its height without it."""
_DIRECTIONS = (("forward", 1.0, True), ("reverse", -1.0, False))
_HEATING, _COOLING = 1.0, -1.0
_LEAST_SHARE = 0.5
"""Least share of a speed's pairs that reach an angle, for the mean at this angle to be drawn.

Pairs of fewer angles were measured at other temperatures.
"""

_TAIL_PERCENTILE = 99.5
_EDGES = 61


def simulated_rows(results: JointResults, diagnosis: Reloaded) -> pd.DataFrame:
    """Return measured and simulated torque of both directions, one row per pair and angle bin.

    Columns are ``time`` [h], ``run``, ``pair``, ``speed``, ``bin`` and ``position``, ``series``,
    1 where the temperature rises and -1 where it falls, the measured torques ``forward`` and
    ``reverse``, and the simulated ones ``forward_simulated`` and ``reverse_simulated``. If the log
    has a load channel, the torque is that of friction alone.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : Reloaded
        The joint's diagnosis.
    """
    parts = [
        _rows(results, misfits)
        for misfits in (diagnosis.seen, diagnosis.new)
        if misfits is not None
    ]
    rows = pd.concat(parts, ignore_index=True)
    return rows.assign(
        speed=merge_close_values(rows["speed"].to_numpy()),
        bin=bin_numbers("position", rows["position"].to_numpy()),
    )


def _rows(results: JointResults, misfits: Misfits) -> pd.DataFrame:
    problem, table = misfits.problem, misfits.problem.table
    names = dict(zip(np.unique(table.run), problem.runs, strict=True))
    load = np.zeros_like(problem.load) if problem.has_load_channel else problem.load
    load_misfit = np.zeros_like(load) if problem.has_load_channel else misfits.before["load"]
    columns: dict[str, object] = {
        "time": table.clock * _CLOCK,
        "run": [names[run] for run in table.run],
        "pair": table.pair,
        "speed": table.speed,
        "position": table.position,
        "series": np.where(is_warming(table), _HEATING, _COOLING),
    }
    for name, sign, _ in _DIRECTIONS:
        direction = sign * results.model.sign
        columns[name] = load + direction * problem.friction
        misfit = load_misfit + direction * misfits.before["friction"]
        columns[f"{name}_simulated"] = load + direction * problem.friction - misfit
    return pd.DataFrame(columns)


def simulation_figure(results: JointResults, *, diagnosis: Reloaded) -> Figure:
    """Draw measured and simulated torque over time and angle, and their difference below.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : Reloaded
        The joint's diagnosis.
    """
    rows = simulated_rows(results, diagnosis)
    figure = Figure(figsize=(WIDTH, 9.0), layout="constrained")
    parts = figure.subfigures(2, 1, squeeze=False)[:, 0]
    columns = [stacked(part, 2, (1.25, 1), share_x=True) for part in parts]
    over_time, over_angle = columns
    pairs = rows.groupby(["run", "pair", "speed"], as_index=False).mean(numeric_only=True)
    shown = _shown_speeds(pairs)
    _draw_torque(over_time, pairs, _series(results, shown), "time")
    _name_runs(over_time[0], pairs, diagnosis)
    fastest = rows[rows["speed"] == shown[-1]]
    series = _series_by_direction(fastest, results)
    _draw_torque(over_angle, _means_by_angle(fastest), series, "position")
    shown_part = _shown_part(diagnosis, "torque u")
    for upper, lower in columns:
        upper.set_ylabel(f"{shown_part} [{results.unit}]")
        lower.set_ylabel(f"measured − simulated [{results.unit}]")
        lower.axhline(0.0, color=MODEL, linewidth=0.9, zorder=1)
    over_time[1].set_xlabel("time, run after run [h]")
    over_angle[1].set_xlabel("joint angle φ [deg]")
    over_time[0].set_title(f"means of {results.row_noun}s")
    over_angle[0].set_title(f"means at {speed_text(shown[-1])}")
    _legend(over_time[0], [(speed_text(speed), results.style(speed)) for speed in shown])
    _legend(over_angle[0], [(name, style) for name, _, style in series if name])
    return figure


def _shown_part(diagnosis: Reloaded, whole: str) -> str:
    """Return the name of the torque that is drawn: that of friction where load is logged."""
    return "friction's part of torque" if diagnosis.seen.problem.has_load_channel else whole


def _legend(panel: Axes, series: list[tuple[str, SpeedStyle]]) -> None:
    """Put a legend of the series, of both directions and of the simulation above a panel."""
    marks = [(name, style, True) for name, style in series]
    grey = SpeedStyle(FAINT, "o")
    for label, style, filled in (*marks, ("forward", grey, True), ("reverse", grey, False)):
        panel.plot([], [], label=label, **_marker_style(style, filled=filled))
    panel.plot([], [], color=MODEL, linewidth=1.2, label="simulated")
    legend_above(panel)


def _series(results: JointResults, speeds: list[float]) -> list[tuple[str, float, SpeedStyle]]:
    return [("", speed, results.style(speed)) for speed in speeds]


def _series_by_direction(
    rows: pd.DataFrame, results: JointResults
) -> list[tuple[str, float, SpeedStyle]]:
    """Return heating and cooling as series; they would cancel each other in a common mean."""
    marker = results.style(float(rows["speed"].iloc[0])).marker
    if rows["series"].nunique() < 2:
        return [("", float(rows["series"].iloc[0]), results.style(float(rows["speed"].iloc[0])))]
    return [
        ("heating", _HEATING, SpeedStyle(HEATING, marker)),
        ("cooling", _COOLING, SpeedStyle(COOLING, marker)),
    ]


def _means_by_angle(rows: pd.DataFrame) -> pd.DataFrame:
    """Return means per angle and direction of temperature, of angles that most pairs reach."""
    pairs_at_angle = rows.groupby(["series", "bin"])["time"].transform("size")
    most = pairs_at_angle.groupby(rows["series"]).transform("max")
    common = rows[pairs_at_angle >= _LEAST_SHARE * most]
    return common.groupby(["series", "bin"], as_index=False).mean(numeric_only=True)


def _shown_speeds(pairs: pd.DataFrame) -> list[float]:
    """Return at most four of the speeds measured most often, slowest first."""
    counts = pairs["speed"].value_counts()
    most = counts[counts >= 0.2 * counts.max()].index
    ordered = sorted(float(speed) for speed in most)
    if len(ordered) <= _MOST_SPEEDS:
        return ordered
    chosen = np.linspace(0, len(ordered) - 1, _MOST_SPEEDS).round().astype(int)
    return [ordered[i] for i in chosen]


def _draw_torque(
    panels: list[Axes],
    rows: pd.DataFrame,
    series: list[tuple[str, float, SpeedStyle]],
    along: str,
) -> None:
    upper, lower = panels
    for _, number, style in series:
        own = rows[rows["series" if along == "position" else "speed"] == number].sort_values(along)
        for name, _, filled in _DIRECTIONS:
            marker_style = _marker_style(style, filled=filled)
            upper.plot(own[along], own[name], **marker_style)
            lower.plot(own[along], own[name] - own[f"{name}_simulated"], **marker_style)
            for _, run in own.groupby("run") if "run" in own else [("", own)]:
                upper.plot(
                    run[along], run[f"{name}_simulated"], color=MODEL, linewidth=1.0, zorder=3
                )


def _marker_style(style: SpeedStyle, *, filled: bool) -> dict[str, Any]:
    return {
        "linestyle": "none",
        "marker": style.marker,
        "color": style.colour,
        "markersize": 3.4,
        "markeredgewidth": 0.0 if filled else 0.8,
        "markerfacecolor": style.colour if filled else "white",
    }


def _name_runs(panel: Axes, pairs: pd.DataFrame, diagnosis: Reloaded) -> None:
    """Write the names of the runs above their points, and mark the held-out run."""
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + _ROOM_FOR_NAMES * (high - low))
    spans = pairs.groupby("run")["time"].agg(["min", "max"]).sort_values("min")
    held_out = diagnosis.document.held_out
    for run, span in spans.iterrows():
        new = " (new)" if run == held_out else ""
        panel.annotate(
            f"{figure_text(str(run))}{new}",
            ((span["min"] + span["max"]) / 2, 0.98),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="top",
            fontsize=9,
            fontweight="bold",
        )
    for start in spans["min"].iloc[1:]:
        panel.axvline(start, color=FAINT, linestyle=":", linewidth=1.2)


def gain_figure(results: JointResults, *, diagnosis: Reloaded, floor: float) -> Figure:
    """Draw the distribution of the torque residuals before and after the extension.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : Reloaded
        The joint's diagnosis.
    floor : float
        RMS of the noise, which no model can predict. [torque unit]
    """
    judged = diagnosis.judged
    models = (
        ("base model", judged.torque(judged.before), _BEFORE, "--"),
        ("extended model", judged.torque(judged.after), _AFTER, "-"),
    )
    reach = max(
        float(np.percentile(np.abs(misfit), _TAIL_PERCENTILE)) for _, misfit, _, _ in models
    )
    edges = np.linspace(-reach, reach, _EDGES)
    figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
    left, right = stacked(figure, 2)
    for name, misfit, colour, line in models:
        rms = float(np.sqrt(np.mean(np.square(misfit))))
        label = f"{name}, RMS {number_text(rms)} {results.unit}"
        density = np.histogram(misfit, edges)[0] / (len(misfit) * (edges[1] - edges[0]))
        left.stairs(density, edges, color=colour, linestyle=line, linewidth=1.6, label=label)
        left.stairs(density, edges, color=colour, fill=True, alpha=0.12)
        sizes = np.linspace(0, reach, 200)
        beyond = 100 * (1 - np.searchsorted(np.sort(np.abs(misfit)), sizes, "right") / len(misfit))
        right.plot(sizes, beyond, color=colour, linestyle=line)
    left.axvspan(-floor, floor, color=FAINT, alpha=0.22, linewidth=0, zorder=0)
    right.axvspan(0, floor, color=FAINT, alpha=0.22, linewidth=0, zorder=0)
    left.fill(
        [], [], color=FAINT, alpha=0.3, label=f"noise floor, {number_text(floor)} {results.unit}"
    )
    left.set_xlim(-reach, reach)
    # room above the curves for the legend
    left.set_ylim(0, 1.35 * left.get_ylim()[1])
    left.set_xlabel(f"{_shown_part(diagnosis, 'torque')}, measured − simulated [{results.unit}]")
    left.set_ylabel(f"share of points per {results.unit}")
    right.set_xlim(0, reach)
    right.set_ylim(0, 100)
    right.set_xlabel(f"size of the misfit [{results.unit}]")
    right.set_ylabel("points with a larger misfit [%]")
    left.legend(loc="upper left")
    return figure
