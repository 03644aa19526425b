"""Figures 9 and 10: friction predicted with corrected temperature in heating and cooling."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.friction import friction_torque
from frictioncli.report.labels import TEMPERATURE_SYMBOLS, figure_text, friction_label
from frictioncli.report.panel import stacked
from frictioncli.report.results import MOST_RUNS, JointResults, by_speed
from frictioncli.report.style import FAINT, MODEL, WIDTH, label_right, legend_above, points
from frictioncli.wording import number_text, range_text, speed_text

_LABEL_DISTANCE = 0.028
"""Least distance between two labels as a share of the time shown."""

_DEGREES = ("first_degree", "latest_degree")
"""Criteria that count degrees."""

_PAPER_K, _PAPER_TMAX, _PAPER_COUNT = 5.0, 3600.0, 6
"""Scale of (20) [-], time [s] and number of corrections of the source paper."""

_FRICTION_HEIGHT = 3.6
_STRIP_HEIGHT = 1.5


def corrected_friction_figure(results: JointResults, phase: str) -> Figure:
    """Draw Figure 9 or 10: measured, smoothed and predicted friction over one phase.

    A panel below shows the measured temperature and the temperature parameter of (17).

    Parameters
    ----------
    results : JointResults
        One joint's results.
    phase : {"heat-up", "cool-down"}
        Heating gives Figure 9, cooling Figure 10.
    """
    schedule = results.schedule[results.schedule["phase"] == phase]
    runs = runs_in_order(schedule)[:MOST_RUNS]
    height = _FRICTION_HEIGHT + _STRIP_HEIGHT
    figure = Figure(figsize=(WIDTH, height * len(runs) + 0.4), layout="constrained")
    grid = stacked(figure, 2 * len(runs), [_FRICTION_HEIGHT, _STRIP_HEIGHT] * len(runs))
    for index, run in enumerate(runs):
        friction, temperature = grid[2 * index], grid[2 * index + 1]
        own = schedule[schedule["run"] == run].sort_values("time")
        _draw_friction(friction, own, results)
        _draw_temperature(temperature, own, results)
        _draw_corrections(friction, temperature, own)
        friction.set_title(figure_text(run))
        friction.tick_params(labelbottom=False)
        friction.sharex(temperature)
        temperature.set_xlabel("time t [min]")
    return figure


def corrections_text(results: JointResults, phase: str) -> str:
    """Return why a phase has as many corrections as it has; empty where none follows the degrees.

    Parameters
    ----------
    results : JointResults
        One joint's results, with a schedule.
    phase : {"heat-up", "cool-down"}
        The phase.
    """
    schedule = results.schedule[results.schedule["phase"] == phase]
    made = schedule[schedule["corrected"].astype(bool) | schedule["failed"].astype(bool)]
    motor = results.pairs[["run", "pair", "motor_temperature"]]
    made = made.merge(motor, on=["run", "pair"]).sort_values(["run", "time"])
    passed = made.groupby("run")["motor_temperature"].diff().abs().dropna()
    if not (schedule["criterion"].isin(_DEGREES).all() and len(passed)):
        return ""
    counts = sorted(made.groupby("run").size())
    text = (
        f" {range_text([str(count) for count in counts])} corrections: the first at"
        " the start of the phase, then one after every"
        f" {number_text(passed.median(), 1)} °C of motor temperature (median)."
    )
    same = (schedule["k"] == _PAPER_K).all() and (schedule["tmax"] == _PAPER_TMAX).all()
    if same and any(count != _PAPER_COUNT for count in counts):
        text += (
            f" The paper has {_PAPER_COUNT} at this k and tmax over 40 °C, one every 8 °C or so;"
            " no reading of (20) gives that if successive degrees take similar times."
        )
    return text


def _draw_friction(panel: Axes, own: pd.DataFrame, results: JointResults) -> None:
    labels = []
    for speed, group in by_speed(own):
        style = results.style(speed)
        minutes = group["time"] / 60.0
        stepped, predicted = predicted_steps(own, group, results)
        tooltips = [
            f"{speed_text(speed)}, {row['time'] / 60.0:.0f} min: measured"
            f" {number_text(row['friction_torque'])} {results.unit}, predicted"
            f" {number_text(row['friction_predicted'])} {results.unit}"
            for row in group.to_dict("records")
        ]
        points(panel, minutes, group["friction_torque"], style, opacity=0.5, tooltips=tooltips)
        panel.plot(minutes, group["friction_smoothed"], color=style.colour, linewidth=1.0)
        panel.plot(stepped / 60.0, predicted, "--", color=style.colour, linewidth=2.0)
        labels.append(
            (float(group["friction_predicted"].iloc[-1]), speed_text(speed), style.colour)
        )
    panel.plot([], [], "o", color=FAINT, markersize=3.5, label="measured")
    panel.plot([], [], "-", color=FAINT, linewidth=1.0, label="smoothed")
    panel.plot([], [], "--", color=FAINT, linewidth=2.0, label="predicted")
    panel.plot([], [], "-", color=MODEL, linewidth=0.9, label="correction, new ΔT")
    low, high = panel.get_ylim()
    # room above the data for the labels of the corrections
    panel.set_ylim(low, high + 0.32 * (high - low))
    panel.set_ylabel(friction_label(results.unit))
    legend_above(panel)
    label_right(panel, labels, height=_FRICTION_HEIGHT)


def _draw_temperature(panel: Axes, own: pd.DataFrame, results: JointResults) -> None:
    symbol = TEMPERATURE_SYMBOLS[results.model.temperature]
    minutes = own["time"] / 60.0
    measured = own["temperature_parameter"] - own["temperature_correction"]
    panel.plot(minutes, measured, color=FAINT, label=symbol)
    time, parameter = _parameter_steps(own, own["time"].to_numpy())
    panel.plot(time / 60.0, parameter, color=MODEL, label=f"T = {symbol} + ΔT")
    panel.set_ylabel("T [°C]")
    legend_above(panel)


def predicted_steps(
    own: pd.DataFrame, group: pd.DataFrame, results: JointResults
) -> tuple[Array, Array]:
    """Return the predicted friction of one speed over time, with a step at every correction.

    A correction takes effect at once, but the pairs of a speed are minutes apart: a line through
    them alone would show ramps.

    Parameters
    ----------
    own : DataFrame
        Rows of the schedule of one run and phase, by time.
    group : DataFrame
        Those of one speed.
    results : JointResults
        One joint's results.

    Returns
    -------
    time, friction : ndarray, shape (points,)
        Times occur twice at corrections. [s], [torque unit]
    """
    model = results.extended_model if results.simulated_extended else results.model
    at = group["time"].to_numpy()
    time, parameter = _parameter_steps(own, at)
    speed = float(group["speed"].iloc[0])

    def friction(temperature: ArrayLike) -> Array:
        assert model is not None  # the schedule was simulated with it
        return friction_torque(model.friction, load=0.0, speed=speed, temperature=temperature)

    # what effects of an extended model add changes slowly
    added = group["friction_predicted"] - friction(group["temperature_parameter"])
    return time, friction(parameter) + np.interp(time, at, added)


def _parameter_steps(own: pd.DataFrame, at: Array) -> tuple[Array, Array]:
    """Return times with each correction between ``at`` twice, and the temperature parameter."""
    known = own["time"].to_numpy()
    correction = own["temperature_correction"].to_numpy()
    measured = own["temperature_parameter"].to_numpy() - correction
    events = known[own["corrected"].astype(bool).to_numpy()]
    events = events[(events > at[0]) & (events <= at[-1])]
    time = np.concatenate([np.setdiff1d(at, events), events, events])
    after = np.repeat([1, 0, 1], [len(time) - 2 * len(events), len(events), len(events)])
    order = np.lexsort((after, time))
    time, after = time[order], after[order]
    last = np.searchsorted(known, time, side="right") - 1
    first = np.maximum(np.searchsorted(known, time, side="left") - 1, 0)
    place = np.where(after == 1, last, first)
    return time, np.interp(time, known, measured) + correction[place]


def _draw_corrections(friction: Axes, temperature: Axes, own: pd.DataFrame) -> None:
    corrections = own[own["corrected"].astype(bool) | own["failed"].astype(bool)]
    span = (own["time"].iloc[-1] - own["time"].iloc[0]) / 60.0
    last_label = float("-inf")
    for row in corrections.to_dict("records"):
        at = row["time"] / 60.0
        style = ":" if row["failed"] else "-"
        for panel in (friction, temperature):
            panel.axvline(at, color=MODEL, linewidth=0.9, linestyle=style, alpha=0.6, zorder=0.5)
        # labels that would overlap are left out; every correction has its line
        if at - last_label < _LABEL_DISTANCE * span:
            continue
        last_label = at
        friction.annotate(
            "failed" if row["failed"] else correction_text(row["temperature_correction"]),
            (at, 0.985),
            xycoords=("data", "axes fraction"),
            xytext=(2, 0),
            textcoords="offset points",
            rotation=90,
            ha="left",
            va="top",
            fontsize=9,
            color=MODEL,
        )


def correction_text(correction: float) -> str:
    """Return a temperature correction with its sign and unit.

    Parameters
    ----------
    correction : float
        Temperature correction. [°C]

    Examples
    --------
    >>> correction_text(2.34)
    '+2.3 °C'
    """
    # adding zero makes -0.0 positive
    return f"{round(correction, 1) + 0.0:+.1f} °C".replace("-", "−")
