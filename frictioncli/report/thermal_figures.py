"""Figures 4 to 7: the thermal cycle, and friction against temperature."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.arrays import Array
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.paper_method import branch_means
from frictioncli.report.labels import TEMPERATURE_LABELS, figure_text, friction_label
from frictioncli.report.results import MOST_RUNS, JointResults, by_speed
from frictioncli.report.style import (
    COOLING,
    FAINT,
    HEATING,
    OTHER_PHASE,
    PHASE_COLOURS,
    PHASE_WORDS,
    PHASES,
    label_right,
    legend_above,
    panels,
    points,
)
from frictioncli.wording import duration_text, number_text, speed_text

_PANEL_HEIGHT = 3.6

_LABEL_WIDTH = 0.19
"""Least share of a run's time that a phase must last for its label to fit."""


def thermal_runs(results: JointResults, *columns: str) -> list[str]:
    """Return the runs with heating or cooling phases and a measured temperature, at most three.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    *columns : str
        Temperature columns, at least one of which must have values.
    """
    pairs = results.thermal_pairs
    known = pairs[pairs[list(columns)].notna().any(axis=1)]
    return runs_in_order(known)[:MOST_RUNS]


def temperature_figure(results: JointResults) -> Figure:
    """Draw Figure 4: motor and housing temperature over time, with phases shaded.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    runs = thermal_runs(results, "motor_temperature", "housing_temperature")
    figure, axes = panels(len(runs), height=3.2)
    for run, panel in zip(runs, axes, strict=True):
        own = results.pairs[results.pairs["run"] == run].sort_values("time")
        minutes = own["time"] / 60.0
        for column, name, colour in (
            ("motor_temperature", "motor Tm", HEATING),
            ("housing_temperature", "housing Tc", COOLING),
        ):
            if own[column].notna().any():
                panel.plot(minutes, own[column], color=colour, label=name)
        low, high = panel.get_ylim()
        panel.set_ylim(low, high + 0.16 * (high - low))
        for start, end, phase in phase_spans(own):
            colour = PHASE_COLOURS.get(phase, OTHER_PHASE)
            panel.axvspan(start / 60.0, end / 60.0, color=colour, alpha=0.08, linewidth=0)
            # a label wider than its phase would overlap the next one
            if phase in PHASE_WORDS and end - start > _LABEL_WIDTH * own["time"].iloc[-1]:
                panel.annotate(
                    f"{PHASE_WORDS[phase]}, {duration_text(end - start)}",
                    ((start + end) / 120.0, 0.97),
                    xycoords=("data", "axes fraction"),
                    ha="center",
                    va="top",
                    color=colour,
                    fontsize=9,
                    fontweight="bold",
                )
        panel.set_title(figure_text(run))
        panel.set_ylabel("temperature [°C]")
        legend_above(panel)
    axes[-1].set_xlabel("time t [min]")
    return figure


def phase_spans(pairs: pd.DataFrame) -> list[tuple[float, float, str]]:
    """Return ``(start, end, phase)`` of each contiguous phase of one run, times in s.

    Parameters
    ----------
    pairs : DataFrame
        One row per pair of one run, in order of time.
    """
    block = (pairs["phase"] != pairs["phase"].shift()).cumsum()
    return [
        (float(rows["time"].iloc[0]), float(rows["time"].iloc[-1]), str(rows["phase"].iloc[0]))
        for _, rows in pairs.groupby(block)
    ]


def friction_temperature_figure(results: JointResults, kind: str) -> Figure:
    """Draw Figure 5 or 6: friction at zero load against a measured temperature, per speed.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    kind : {"motor", "housing"}
        The temperature: motor gives Figure 5, housing Figure 6.
    """
    column = f"{kind}_temperature"
    runs = thermal_runs(results, column)
    figure, axes = panels(len(runs), height=_PANEL_HEIGHT)
    for run, panel in zip(runs, axes, strict=True):
        own = results.thermal_pairs.dropna(subset=[column])
        own = own[own["run"] == run]
        labels = []
        for speed, group in by_speed(own):
            style = results.style(speed)
            at, friction = group[column].to_numpy(), group["friction_torque"].to_numpy()
            phases = group["phase"].to_numpy(object)
            for phase in PHASES:
                branch = phases == phase
                points(
                    panel,
                    at[branch],
                    friction[branch],
                    style,
                    filled=phase == "heat-up",
                    size=4.5,
                    tooltips=_tooltips(
                        at[branch], friction[branch], speed, PHASE_WORDS[phase], results.unit
                    ),
                )
            at_hottest = friction[np.argsort(at, kind="stable")[-1]]
            labels.append((float(at_hottest), speed_text(speed), style.colour))
        panel.set_title(figure_text(run))
        _phase_legend(panel)
        panel.set_ylabel(friction_label(results.unit))
        label_right(panel, labels, height=_PANEL_HEIGHT)
    axes[-1].set_xlabel(TEMPERATURE_LABELS[kind])
    return figure


def _tooltips(at: Array, friction: Array, speed: float, what: str, unit: str) -> list[str]:
    return [
        f"{speed_text(speed)}, {what}, {temperature:.1f} °C: {number_text(torque)} {unit}"
        for temperature, torque in zip(at, friction, strict=True)
    ]


def _phase_legend(panel: Axes) -> None:
    panel.plot([], [], "o", color=FAINT, label="heating")
    panel.plot([], [], "o", color=FAINT, markerfacecolor="white", label="cooling")
    legend_above(panel)


def branch_means_figure(results: JointResults) -> Figure:
    """Draw Figure 7: mean of the heating and cooling branches (11) per speed, with the model.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    kind = results.model.temperature
    means = means_per_run(results)
    runs = runs_in_order(means)[:MOST_RUNS]
    figure, axes = panels(len(runs), height=_PANEL_HEIGHT)
    for run, panel in zip(runs, axes, strict=True):
        labels = []
        for speed, group in by_speed(means[means["run"] == run]):
            style = results.style(speed)
            measured, friction = (
                group[name].to_numpy() for name in ("temperature", "friction_torque")
            )
            tooltips = _tooltips(measured, friction, speed, "mean", results.unit)
            points(panel, measured, friction, style, tooltips=tooltips)
            at = np.linspace(measured.min(), measured.max(), 60)
            curve = results.predict(load=0.0, speed=speed, temperature=at)
            panel.plot(at, curve, color=style.colour)
            labels.append((float(curve[-1]), speed_text(speed), style.colour))
        panel.plot([], [], "o", color=FAINT, markersize=3.5, label="mean of both branches")
        panel.plot([], [], "-", color=FAINT, label="model (12), (13)")
        panel.set_title(figure_text(run))
        legend_above(panel)
        panel.set_ylabel(friction_label(results.unit).replace("τ", "τ*"))
        label_right(panel, labels, height=_PANEL_HEIGHT)
    axes[-1].set_xlabel(TEMPERATURE_LABELS[kind])
    return figure


def means_per_run(results: JointResults) -> pd.DataFrame:
    """Return the branch means (11) of each run against the model's temperature.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    present = list(_means(results))
    if not present:
        return pd.DataFrame(columns=["speed", "temperature", "friction_torque", "run"])
    return pd.concat(present, ignore_index=True)


def has_means(results: JointResults) -> bool:
    """Return whether any run has branch means (11).

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    return any(True for _ in _means(results))


def _means(results: JointResults) -> Iterator[pd.DataFrame]:
    """Yield the branch means of each run that has some."""
    for run, own in results.thermal_pairs.groupby("run"):
        means = branch_means(own, results.model.temperature)
        if len(means):
            yield means.assign(run=str(run))
