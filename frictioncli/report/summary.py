"""The page's first paragraph: what was measured, fitted and gained, in plain words."""

import numpy as np

from frictioncli.model.document import PARAMETERS
from frictioncli.report.epsilon import setting_text
from frictioncli.report.labels import (
    TEMPERATURE_WORDS,
    counted,
    listed,
    number,
    span,
    speed_text,
)
from frictioncli.report.results import JointResults
from frictioncli.report.style import PHASE_WORDS, PHASES


def summary(results: JointResults) -> str:
    """Return the summary of one joint.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    sentences = [_measured(results), _fitted(results), _undetermined(results), _gained(results)]
    return " ".join(sentence for sentence in sentences if sentence)


def _measured(results: JointResults) -> str:
    speeds = sorted(results.styles)
    at = (
        f"at {speed_text(speeds[0])}"
        if len(speeds) == 1
        else f"at {len(speeds)} speeds from {speed_text(speeds[0])} to {speed_text(speeds[-1])}"
    )
    motor = results.pairs["motor_temperature"].dropna()
    warm = (
        f", with the motor between {motor.min():.0f} and {motor.max():.0f} °C"
        if len(motor)
        else ", without a motor temperature"
    )
    return (
        f"Joint {results.joint} was measured in {counted(len(results.runs), 'run')}"
        f" ({listed(results.runs)}): {counted(len(results.pairs), 'pair')} of counter-directed"
        f" moves {at}{warm}."
    )


def _fitted(results: JointResults) -> str:
    inputs = ["load", "speed"]
    if results.model.knows_temperature:
        inputs.append(TEMPERATURE_WORDS[results.model.temperature])
    noise = results.model.noise.point
    beside = f"; single points scatter by {number(noise)} {results.unit}" if noise else ""
    load = results.model.range.get("load")
    span = (
        f" It holds for loads from {number(load[0])} to {number(load[1])} {results.load_unit}."
        if load
        else ""
    )
    return (
        f"Friction was fitted as equation (16), a function of {listed(inputs)}. The fit misses the"
        f" measured friction by {number(results.model.rmse)} {results.unit} (RMS){beside}.{span}"
    )


def _undetermined(results: JointResults) -> str:
    names = [name for name in PARAMETERS if not results.model.parameters[name].determined]
    if not names:
        return ""
    return f"These data do not determine {listed(names)}; the table says why."


def _gained(results: JointResults) -> str:
    if results.schedule.empty:
        return ""
    told = []
    for phase in PHASES:
        through = results.schedule[results.schedule["phase"] == phase]
        runs = [(str(run), own) for run, own in through.groupby("run")]
        if not runs:
            continue
        errors = [_error(results, run, phase) for run, _ in runs]
        tried = [int((own["corrected"].astype(bool) | own["failed"]).sum()) for _, own in runs]
        told.append(
            f"{span([number(error) for error in sorted(errors)])} {results.unit} in"
            f" {PHASE_WORDS[phase]} ({span([str(count) for count in sorted(tried)])}"
            f" {'correction' if tried == [1] else 'corrections'})"
        )
    if not told:
        return ""
    return (
        f"With the temperature parameter corrected on the way ({setting_text(results)}), the error"
        f" ε of the predicted friction is {' and '.join(told)}."
    )


def _error(results: JointResults, run: str, phase: str) -> float:
    """Return the evaluated error of the simulated setting, else the schedule's own."""
    own = results.schedule[(results.schedule["run"] == run) & (results.schedule["phase"] == phase)]
    first = own.iloc[0]
    table = results.evaluation
    same = table[
        (table["run"] == run)
        & (table["phase"] == phase)
        & (table["criterion"] == first["criterion"])
        & (table["k"] == first["k"])
        & (table["tmax"] == first["tmax"])
    ]
    if len(same):
        return float(same["epsilon"].iloc[0])
    return float(np.sqrt(np.mean(np.square(own["friction_smoothed"] - own["friction_predicted"]))))
