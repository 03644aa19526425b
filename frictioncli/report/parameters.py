"""Parameters of the model: estimates, correlations, and what the data cannot determine."""

from dataclasses import dataclass
from itertools import combinations

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import PUBLISHED
from frictioncli.report.labels import PARAMETER_SYMBOLS
from frictioncli.report.page_tables import TextTable
from frictioncli.report.quality_ratings import imprecise_parameters
from frictioncli.report.results import JointResults
from frictioncli.wording import in_words, list_text, number_text

_MEANINGS = {
    "tau_c": "Coulomb friction",
    "alpha": "load coefficient",
    "beta": "viscous, independent of temperature",
    "gamma": "viscous, falls with temperature",
    "delta": "rate at which γ falls",
}

_STRONG_CORRELATION = 0.9
"""Absolute correlation of two estimates above which they cannot be separated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRow:
    """One parameter of the model as the page states it.

    Attributes
    ----------
    symbol, meaning, unit : str
        Symbol in equation (16), meaning and unit.
    estimate, interval : str
        Estimate with its 95 % interval.
    published : str
        Value published for joint 2 of a KUKA KR10.
    remark : str
        Why the data do not determine it; empty if they do.
    """

    symbol: str
    meaning: str
    estimate: str
    interval: str
    unit: str
    published: str
    remark: str


def parameter_rows(results: JointResults) -> list[ParameterRow]:
    """Return the model's parameters with intervals, units and the published values.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    rows = []
    for name in PARAMETERS:
        stated = results.model.parameters[name]
        interval = stated.ci95
        remark = "" if stated.determined else "not determined by these data"
        if stated.reason:
            remark = f"{remark}: {stated.reason}".removeprefix(": ")
        rows.append(
            ParameterRow(
                symbol=PARAMETER_SYMBOLS[name],
                meaning=_MEANINGS[name],
                estimate=number_text(stated.estimate, 4),
                interval=f"{number_text(interval[0])} to {number_text(interval[1])}"
                if interval
                else "–",
                unit=stated.unit,
                published=f"{getattr(PUBLISHED, name):g}",
                remark=remark,
            )
        )
    return rows


def is_published_joint(results: JointResults, log_files: str) -> bool:
    """Return whether the published values belong to this joint: joint 2 of a KR10, in N·m.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    log_files : str
        Names of the logs, which may contain the robot's name.
    """
    if results.joint != 2 or results.unit != "N·m":
        return False
    named = " ".join([*results.runs, log_files]).lower().replace(" ", "").replace("-", "")
    return results.model.torque_side == "joint" and "kr10" in named


def correlation_table(results: JointResults) -> TextTable | None:
    """Return the correlations of the estimates; None if they are not known.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    known = results.model.correlation
    names = [name for name in PARAMETERS if name in known]
    if len(names) < 2:
        return None
    return TextTable(
        title="Correlations of the estimates",
        header=("", *(PARAMETER_SYMBOLS[name] for name in names)),
        rows=tuple(
            (
                PARAMETER_SYMBOLS[row],
                *(
                    correlation_text(known[row][column])
                    if place < index
                    else ("1" if place == index else "")
                    for place, column in enumerate(names)
                ),
            )
            for index, row in enumerate(names)
        ),
    )


def correlation_text(value: float) -> str:
    """Return a correlation with its sign and two digits."""
    shown = f"{value:+.2f}"
    return "0" if float(shown) == 0 else shown.replace("-", "−")


def limitations(results: JointResults, diagnosis: DiagnosisDocument | None) -> list[str]:
    """Return what the data cannot determine, one sentence each.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : DiagnosisDocument or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    model = results.model
    sentences = [
        f"{PARAMETER_SYMBOLS[name]} is not determined: {model.parameters[name].reason}."
        for name in PARAMETERS
        if not model.parameters[name].determined
    ]
    for name in imprecise_parameters(results):
        low, high = model.parameters[name].ci95 or (0.0, 0.0)
        sentences.append(
            f"{PARAMETER_SYMBOLS[name]} is known only roughly: {number_text(low)} to"
            f" {number_text(high)}"
            f" {model.parameters[name].unit}."
        )
    for first, second in combinations(
        [name for name in PARAMETERS if name in model.correlation], 2
    ):
        value = model.correlation[first][second]
        if abs(value) > _STRONG_CORRELATION:
            both = f"{PARAMETER_SYMBOLS[first]} and {PARAMETER_SYMBOLS[second]}"
            sentences.append(
                f"{both} are not determined separately (correlation {correlation_text(value)}):"
                " they compensate each other."
            )
    return sentences + _undetermined_causes(results, diagnosis)


def _undetermined_causes(results: JointResults, diagnosis: DiagnosisDocument | None) -> list[str]:
    if diagnosis is None:
        return ["The errors of the simulated torque have not been diagnosed."]
    sentences = [
        f"These data cannot distinguish {list_text([in_words(name) for name in cause.effects])}."
        f" {cause.experiment}"
        for cause in diagnosis.causes
        if len(cause.effects) > 1
    ]
    undetectable = [
        in_words(name)
        for name, size in diagnosis.detectable.items()
        if size is None and name not in diagnosis.found
    ]
    if undetectable:
        sentences.append(f"Effects that these data cannot show: {', '.join(undetectable)}.")
    if len(results.runs) == 1:
        sentences.append(
            "One run shows neither how well the model predicts another day, nor whether a slow"
            " change is a drift or an offset."
        )
    return sentences
