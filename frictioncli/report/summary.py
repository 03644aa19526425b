"""The top of the page: the verdict in a paragraph, the figures that matter, what was measured."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.model.document import PARAMETERS
from frictioncli.report.evaluation_figure import compared_criterion, setting_text
from frictioncli.report.labels import (
    CRITERION_WORDS,
    PARAMETER_SYMBOLS,
    TEMPERATURE_WORDS,
    count_text,
    in_words,
    list_text,
    number_text,
    range_text,
    speed_text,
)
from frictioncli.report.results import JointResults
from frictioncli.report.style import PHASE_WORDS, PHASES

_REACHED = 2.0
"""Error that the source paper reaches. [N·m]"""

_REMAINS = 0.25
"""Share of the uncorrected error that may remain, where torque is not in N·m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyNumber:
    """A figure that matters: its name, value with unit, and what it is to be read with."""

    name: str
    value: str
    context: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Gained:
    """Errors and corrections of the simulated setting in one phase, over the runs, as text."""

    error: str
    tried: str
    never: str


def summary_text(results: JointResults, diagnosis: DiagnosisDocument | None = None) -> str:
    """Return the verdict on one joint.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : DiagnosisDocument or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    sentences = [
        _fitted(results),
        _corrected(results),
        _judged(results, diagnosis),
        _undetermined(results),
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def measurement_text(results: JointResults) -> str:
    """Return what was measured.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
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
    load = results.model.range.load
    loads = (
        f", under loads from {number_text(load[0])} to {number_text(load[1])} {results.load_unit}"
        if load
        else ""
    )
    return (
        f"Joint {results.joint} was measured in {count_text(len(results.runs), 'run')}"
        f" ({list_text(results.runs)}): {count_text(len(results.pairs), 'pair')} of"
        " counter-directed"
        f" moves {at}{warm}{loads}."
    )


def key_numbers(results: JointResults, diagnosis: DiagnosisDocument | None) -> list[KeyNumber]:
    """Return the figures that matter, those that there are.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : DiagnosisDocument or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    found = []
    for phase in PHASES:
        if gained := _gained(results, phase):
            never = f"; without correction {gained.never} {results.unit}" if gained.never else ""
            found.append(
                KeyNumber(
                    name=f"error ε in {PHASE_WORDS[phase]}",
                    value=f"{gained.error} {results.unit}",
                    context=f"with {gained.tried}{never}",
                )
            )
    if needed := corrections_needed(results):
        found.append(needed)
    found.append(
        KeyNumber(
            name="misfit of the fitted function",
            value=f"{number_text(results.model.rmse)} {results.unit}",
            context=f"RMS without correction; single points scatter by"
            f" {number_text(results.model.noise.point)} {results.unit}",
        )
    )
    gain = diagnosis.gain if diagnosis else None
    if diagnosis and gain:
        new = (
            f"on {diagnosis.held_out}, a run it has not seen"
            if gain.basis == "new_run"
            else "on the data that it was fitted to"
        )
        found.append(
            KeyNumber(
                name="misfit of the extended model",
                value=f"{number_text(gain.rmse_after)} {results.unit}",
                context=f"RMS of the torque without correction, {new}; base model"
                f" {number_text(gain.rmse_before)} {results.unit}",
            )
        )
    return found


def corrections_needed(results: JointResults) -> KeyNumber | None:
    """Return the fewest corrections per phase that make the error small; none if not evaluated.

    Small is 2 N·m, the error that the source paper reaches; in another unit, a quarter of the error
    without correction.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    criterion = compared_criterion(results)
    told = []
    in_torque = results.unit == "N·m"
    for phase in PHASES:
        rows = results.evaluation[results.evaluation["phase"] == phase]
        counts = []
        for _, own in rows.groupby("run"):
            never = own.loc[own["criterion"] == "none", "epsilon"]
            limit = _REACHED if in_torque else _REMAINS * float(never.max())
            enough = own[(own["criterion"] == criterion) & (own["epsilon"] <= limit)]
            counts.append(int(enough["corrections"].min()) if len(enough) else None)
        if reached := sorted(count for count in counts if count is not None):
            missed = counts.count(None)
            not_all = f" ({count_text(missed, 'run')} never)" if missed else ""
            told.append(f"{range_text([str(n) for n in reached])} in {PHASE_WORDS[phase]}{not_all}")
        elif counts:
            told.append(f"never enough in {PHASE_WORDS[phase]}")
    if not told or not criterion:
        return None
    small = "2 N·m, as in the paper" if in_torque else "a quarter of that without correction"
    return KeyNumber(
        name="corrections needed",
        value=", ".join(told),
        context=f"fewest of all settings tried whose ε is at most {small}; criterion"
        f" “{CRITERION_WORDS.get(criterion, criterion)}”"
        f"{', extended model' if results.evaluated_extended else ''}",
    )


def _fitted(results: JointResults) -> str:
    inputs = ["load", "speed"]
    if results.model.knows_temperature:
        inputs.append(TEMPERATURE_WORDS[results.model.temperature])
    return (
        f"Equation (16), a function of {list_text(inputs)}, gives the friction of joint"
        f" {results.joint} to {number_text(results.model.rmse)} {results.unit} (RMS)."
    )


def _corrected(results: JointResults) -> str:
    gained = {phase: _gained(results, phase) for phase in PHASES}
    told = [
        f"{own.error} {results.unit} in {PHASE_WORDS[phase]} ({own.tried})"
        for phase, own in gained.items()
        if own
    ]
    if not told:
        return ""
    never = [
        f"{own.never} {results.unit} in {PHASE_WORDS[phase]}"
        for phase, own in gained.items()
        if own and own.never
    ]
    without = f", against {' and '.join(never)} without correction" if never else ""
    return (
        f"With the temperature parameter corrected on the way ({setting_text(results)}), the error"
        f" ε of the predicted friction is {' and '.join(told)}{without}."
    )


def _gained(results: JointResults, phase: str) -> _Gained | None:
    through = results.schedule[results.schedule["phase"] == phase]
    runs = [own for _, own in through.groupby("run")]
    if not runs:
        return None
    errors = [_error(own) for own in runs]
    tried = sorted(int((own["corrected"].astype(bool) | own["failed"]).sum()) for own in runs)
    table = results.evaluation
    never = table[(table["phase"] == phase) & (table["criterion"] == "none")]["epsilon"]
    if results.simulated_extended != results.evaluated_extended or not any(tried):
        never = never[:0]
    return _Gained(
        error=range_text([number_text(error) for error in sorted(errors)]),
        tried=f"{range_text([str(n) for n in tried])} correction{'' if tried[-1] == 1 else 's'}",
        never=range_text([number_text(error) for error in sorted(never)]) if len(never) else "",
    )


def _error(own: pd.DataFrame) -> float:
    """Return the error (21) of rows of a schedule. [torque unit]."""
    return float(np.sqrt(np.mean(np.square(own["friction_smoothed"] - own["friction_predicted"]))))


def _judged(results: JointResults, diagnosis: DiagnosisDocument | None) -> str:
    if diagnosis is None:
        return ""
    lacking = [
        " or ".join(in_words(n) for n in one.effects) for one in diagnosis.causes if one.effects
    ]
    if diagnosis.verdict == "no_evidence":
        return "No cause was found in what the function misses."
    told = f"The function lacks {list_text(lacking)}" if lacking else "No known effect is named"
    if diagnosis.verdict == "unnamed":
        told += ", and structure is left that no known effect explains"
    gain = diagnosis.gain
    if gain is None or gain.ci95[0] <= 0:
        return f"{told}."
    where = f" on {diagnosis.held_out}, which it has not seen," if gain.basis == "new_run" else ""
    return (
        f"{told}; extended by that, it misses the torque{where} by"
        f" {number_text(gain.rmse_after)}"
        f" {results.unit} instead of {number_text(gain.rmse_before)} {results.unit}, without any"
        " correction."
    )


def _undetermined(results: JointResults) -> str:
    names = [name for name in PARAMETERS if not results.model.parameters[name].determined]
    if not names:
        return ""
    symbols = list_text([PARAMETER_SYMBOLS[name] for name in names])
    return f"These data do not determine {symbols}; the table of parameters says why."
