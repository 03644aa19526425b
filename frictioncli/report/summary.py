"""Top of the page: the result in a paragraph, the key numbers, and what was measured."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.sentences import alternatives_text
from frictioncli.model.document import PARAMETERS
from frictioncli.report.evaluation_figure import (
    compared_criterion,
    error_per_count,
    setting_text,
)
from frictioncli.report.labels import CRITERION_WORDS, PARAMETER_SYMBOLS, TEMPERATURE_WORDS
from frictioncli.report.results import JointResults
from frictioncli.report.style import PHASE_WORDS, PHASES
from frictioncli.report.target_error import target_error, target_text
from frictioncli.wording import count_text, list_text, number_text, range_text, speed_text


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyNumber:
    """A key number: its name, its value with unit, and the context needed to read it."""

    name: str
    value: str
    context: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _CorrectionResult:
    """Result of the simulated setting in one phase, as ranges over the runs.

    Attributes
    ----------
    error : str
        Error (21).
    corrections : str
        Number of corrections, with its noun.
    uncorrected : str
        Error (21) without correction; empty if it cannot be compared.
    worse : bool
        Whether it is larger than without correction in any run.
    """

    error: str
    corrections: str
    uncorrected: str
    worse: bool


def summary_text(results: JointResults, diagnosis: DiagnosisDocument | None = None) -> str:
    """Return the result for one joint in a paragraph.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : DiagnosisDocument or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    sentences = [
        _fit_sentence(results),
        _correction_sentence(results),
        _diagnosis_sentence(results, diagnosis),
        _undetermined_sentence(results),
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def measurement_text(results: JointResults) -> str:
    """Return a sentence on what was measured.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    # as the text of ``pair`` counts them
    speeds = sorted({round(speed, 1) for speed in results.styles})
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
    rows = f"{count_text(len(results.pairs), results.row_noun)} {results.rows_meaning}"
    return (
        f"Joint {results.joint} was measured in {count_text(len(results.runs), 'run')}"
        f" ({list_text(results.runs)}): {rows} {at}{warm}{loads}."
    )


def key_numbers(results: JointResults, diagnosis: DiagnosisDocument | None) -> list[KeyNumber]:
    """Return the key numbers that are available.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : DiagnosisDocument or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    numbers = []
    for phase in PHASES:
        if result := _correction_result(results, phase):
            uncorrected = (
                f"; without correction {result.uncorrected} {results.unit}"
                if result.uncorrected
                else ""
            )
            numbers.append(
                KeyNumber(
                    name=f"error ε in {PHASE_WORDS[phase]}",
                    value=f"{result.error} {results.unit}",
                    context=f"with {result.corrections}{uncorrected}",
                )
            )
    if needed := corrections_needed(results):
        numbers.append(needed)
    numbers.append(
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
            f"on {diagnosis.held_out}, a run not used for fitting"
            if gain.basis == "new_run"
            else "on its own training data"
        )
        numbers.append(
            KeyNumber(
                name="misfit of the extended model",
                value=f"{number_text(gain.rmse_after)} {results.unit}",
                context=f"RMS of the torque without correction, {new}; base model"
                f" {number_text(gain.rmse_before)} {results.unit}",
            )
        )
    return numbers


def corrections_needed(results: JointResults) -> KeyNumber | None:
    """Return the least number of corrections per phase that reaches the target error.

    Without an evaluation the result is None.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    criterion = compared_criterion(results)
    texts = []
    limit = target_error(results)
    for phase in PHASES:
        rows = results.evaluation[results.evaluation["phase"] == phase]
        counts = []
        for _, own in rows.groupby("run"):
            tried = own["criterion"].isin([criterion, "none"])  # none may be needed
            errors = error_per_count(own[tried])["epsilon"]
            enough = errors.index[errors <= limit]
            counts.append(int(enough.min()) if len(enough) else None)
        if reached := sorted(count for count in counts if count is not None):
            failing = counts.count(None)
            not_all = f" (not reached in {count_text(failing, 'run')})" if failing else ""
            texts.append(
                f"{range_text([str(n) for n in reached])} in {PHASE_WORDS[phase]}{not_all}"
            )
        elif counts:
            texts.append(f"no number suffices in {PHASE_WORDS[phase]}")
    if not texts or not criterion:
        return None
    return KeyNumber(
        name="corrections needed",
        value=", ".join(texts),
        context="fewest whose median ε over the settings tried is at most"
        f" {target_text(results)}; criterion “{CRITERION_WORDS.get(criterion, criterion)}”"
        f"{', extended model' if results.evaluated_extended else ''}",
    )


def _fit_sentence(results: JointResults) -> str:
    inputs = ["load", "speed"]
    if results.model.knows_temperature:
        inputs.append(TEMPERATURE_WORDS[results.model.temperature])
    return (
        f"Equation (16), a function of {list_text(inputs)}, predicts the friction of joint"
        f" {results.joint} to within {number_text(results.model.rmse)} {results.unit} (RMS)."
    )


def _correction_sentence(results: JointResults) -> str:
    by_phase = {phase: _correction_result(results, phase) for phase in PHASES}
    errors = [
        f"{result.error} {results.unit} in {PHASE_WORDS[phase]} ({result.corrections})"
        for phase, result in by_phase.items()
        if result
    ]
    if not errors:
        return ""
    uncorrected = [
        f"{result.uncorrected} {results.unit} in {PHASE_WORDS[phase]}"
        for phase, result in by_phase.items()
        if result and result.uncorrected
    ]
    without = f", against {' and '.join(uncorrected)} without correction" if uncorrected else ""
    worse = [PHASE_WORDS[phase] for phase, result in by_phase.items() if result and result.worse]
    warning = f" In {list_text(worse)}, corrections make the prediction worse." if worse else ""
    return (
        f"With periodic temperature corrections ({setting_text(results)}), the error ε of the"
        f" predicted friction is {' and '.join(errors)}{without}.{warning}"
    )


def _correction_result(results: JointResults, phase: str) -> _CorrectionResult | None:
    schedule = results.schedule[results.schedule["phase"] == phase]
    runs = dict(list(schedule.groupby("run")))
    if not runs:
        return None
    errors = {run: _error(rows) for run, rows in runs.items()}
    counts = sorted(
        int((rows["corrected"].astype(bool) | rows["failed"]).sum()) for rows in runs.values()
    )
    table = results.evaluation
    without = table[(table["phase"] == phase) & (table["criterion"] == "none")]
    uncorrected = without.set_index("run")["epsilon"]
    if results.simulated_extended != results.evaluated_extended or not any(counts):
        # another model's errors, or equal to those of the schedule: no comparison
        uncorrected = uncorrected[:0]
    return _CorrectionResult(
        error=range_text([number_text(error) for error in sorted(errors.values())]),
        corrections=f"{range_text([str(n) for n in counts])}"
        f" correction{'' if counts[-1] == 1 else 's'}",
        uncorrected=range_text([number_text(error) for error in sorted(uncorrected)])
        if len(uncorrected)
        else "",
        worse=any(errors[run] > error for run, error in uncorrected.items() if run in errors),
    )


def _error(schedule: pd.DataFrame) -> float:
    """Return the error (21) over rows of a schedule [torque unit]."""
    return float(
        np.sqrt(np.mean(np.square(schedule["friction_smoothed"] - schedule["friction_predicted"])))
    )


def _diagnosis_sentence(results: JointResults, diagnosis: DiagnosisDocument | None) -> str:
    if diagnosis is None:
        return ""
    causes = diagnosis.modelled_causes
    lacking = [alternatives_text(cause) for cause in causes if not cause.is_measurement]
    measured = [alternatives_text(cause) for cause in causes if cause.is_measurement]
    if diagnosis.verdict == "no_evidence":
        found = "is named" if diagnosis.visible else "was found"
        return f"No cause {found} in the errors of the function."
    text = "No known effect is named"
    if lacking:
        text = f"The function does not model {list_text(lacking)}"
    if measured:
        beside = f"{text}, and the" if lacking else "The"
        text = f"{beside} measurement adds {list_text(measured)}"
    if diagnosis.verdict == "unnamed":
        text += ", and there is structure that no known effect explains"
    gain = diagnosis.gain
    if gain is None or gain.ci95[0] <= 0:
        return f"{text}."
    where = f" on {diagnosis.held_out}, not used for fitting," if gain.basis == "new_run" else ""
    return (
        f"{text}; with that added, its torque error{where} is"
        f" {number_text(gain.rmse_after)}"
        f" {results.unit} instead of {number_text(gain.rmse_before)} {results.unit}, without any"
        " correction."
    )


def _undetermined_sentence(results: JointResults) -> str:
    names = [name for name in PARAMETERS if not results.model.parameters[name].determined]
    if not names:
        return ""
    symbols = list_text([PARAMETER_SYMBOLS[name] for name in names])
    return f"These data do not determine {symbols}; the table of parameters says why."
