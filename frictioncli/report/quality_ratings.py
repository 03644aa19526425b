"""Data quality at a glance: each light good, fair or poor, with the reason in words."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from frictioncli.model.document import PARAMETERS
from frictioncli.report.labels import (
    PARAMETER_SYMBOLS,
    count_text,
    in_words,
    list_text,
    number_text,
    speed_text,
    thousands_text,
)
from frictioncli.report.results import JointResults
from frictioncli.report.style import PHASE_WORDS, PHASES

GOOD, FAIR, POOR = "good", "fair", "poor"

_REJECTED = (0.001, 0.05)
"""Shares of rejected rows up to which reading is good, and fair."""

_PAIRS = (100, 30)
_SPEEDS = (4, 2)
_SPEED_RATIOS = (4.0, 1.5)
_TEMPERATURE_SPANS = (20.0, 10.0)
_VAGUE = 0.5
"""A parameter whose half interval exceeds this share of it is known only roughly."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityRating:
    """One light.

    Attributes
    ----------
    level : {"good", "fair", "poor"}
        Shown green, amber or red.
    name : str
        What is judged.
    reason : str
        Why it has that level.
    """

    level: str
    name: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IngestCounts:
    """What became of the logs.

    Attributes
    ----------
    rows, rejected : int
        Rows read, and those of them that were rejected.
    files, lost : int
        Files used, and files that could not be used at all.
    time_known : bool or None
        Whether the logs tell when each recording began; none where that is not known.
    warnings : int
        Warnings of the stages.
    """

    rows: int
    rejected: int
    files: int
    lost: int
    time_known: bool | None
    warnings: int


def quality_ratings(
    results: JointResults, reading: IngestCounts, diagnosis: Mapping[str, Any] | None
) -> list[QualityRating]:
    """Return all lights of one joint.

    Parameters
    ----------
    results : JointResults
        The joint's results.
    reading : IngestCounts
        What became of the logs.
    diagnosis : dict or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    return [
        *([reading_rating(reading)] if reading.files else []),
        *([time_rating(reading)] if reading.time_known is not None else []),
        runs_rating(results),
        pairs_rating(results),
        speeds_rating(results),
        temperature_rating(results),
        parameters_rating(results),
        model_rating(results, diagnosis),
    ]


def reading_rating(reading: IngestCounts) -> QualityRating:
    """Judge how much of the logs could be read."""
    share = reading.rejected / max(reading.rows, 1)
    level = _at_most(share, _REJECTED)
    if reading.lost and level == GOOD:
        level = FAIR
    lost = f"; {count_text(reading.lost, 'file')} could not be used at all" if reading.lost else ""
    return QualityRating(
        level=level,
        name="Reading",
        reason=f"{thousands_text(reading.rejected)} of {count_text(reading.rows, 'row')} in"
        f" {count_text(reading.files, 'file')} rejected{lost}.",
    )


def time_rating(reading: IngestCounts) -> QualityRating:
    """Judge whether times and units of the logs are sure."""
    if not reading.time_known:
        return QualityRating(
            level=POOR,
            name="Time",
            reason="The logs do not tell when each recording began, so effects of time and of"
            " temperature history cannot be judged. A manifest.csv tells it.",
        )
    if reading.warnings:
        return QualityRating(
            level=FAIR,
            name="Time and units",
            reason=f"{count_text(reading.warnings, 'warning')} of reading; see the notes below.",
        )
    return QualityRating(
        level=GOOD, name="Time and units", reason="Start times are known; reading gave no warning."
    )


def runs_rating(results: JointResults) -> QualityRating:
    """Judge whether there are runs enough to try the model on new data."""
    count = len(results.runs)
    if count > 1:
        return QualityRating(
            level=GOOD,
            name="Runs",
            reason=f"{count_text(count, 'run')}: a model can be tried on one that it has not seen.",
        )
    return QualityRating(
        level=FAIR,
        name="Runs",
        reason="One run only: a slow drift cannot be told from an offset, and no other run is left"
        " to try the model on.",
    )


def pairs_rating(results: JointResults) -> QualityRating:
    """Judge the number of pairs of counter-directed moves."""
    count = len(results.pairs)
    return QualityRating(
        level=_at_least(count, _PAIRS),
        name="Pairs",
        reason=f"{count_text(count, 'pair')} of counter-directed moves; good from {_PAIRS[0]}.",
    )


def speeds_rating(results: JointResults) -> QualityRating:
    """Judge whether the speeds tell Coulomb from viscous friction."""
    speeds = sorted(results.styles)
    level = _worst(
        _at_least(len(speeds), _SPEEDS), _at_least(speeds[-1] / speeds[0], _SPEED_RATIOS)
    )
    told = (
        speed_text(speeds[0])
        if len(speeds) == 1
        else f"{len(speeds)} speeds, {speed_text(speeds[0])} to {speed_text(speeds[-1])}"
    )
    return QualityRating(
        level=level,
        name="Speeds",
        reason=f"{told}; good from {_SPEEDS[0]} speeds over a ratio of {_SPEED_RATIOS[0]:g}.",
    )


def temperature_rating(results: JointResults) -> QualityRating:
    """Judge whether the joint was heated and cooled far enough, in every run."""
    warm = results.thermal_pairs["motor_temperature"].dropna()
    if warm.empty:
        lacking = (
            "No heating or cooling of the motor was found"
            if results.has("motor_temperature")
            else "The log has no motor temperature"
        )
        return QualityRating(
            level=POOR,
            name="Temperature",
            reason=f"{lacking}: what temperature does to friction stays unknown.",
        )
    span = float(warm.max() - warm.min())
    found = [phase for phase in PHASES if (results.thermal_pairs["phase"] == phase).any()]
    level = _at_least(span, _TEMPERATURE_SPANS)
    alone = ""
    if len(found) == 1:
        level = _worst(level, FAIR)
        alone = f" Only {PHASE_WORDS[found[0]]} was measured, so a lag cannot be seen."
    return QualityRating(
        level=level,
        name="Temperature",
        reason=f"Motor from {warm.min():.0f} to {warm.max():.0f} °C in"
        f" {list_text([PHASE_WORDS[phase] for phase in found])}; good from a span of"
        f" {_TEMPERATURE_SPANS[0]:.0f} °C.{alone}",
    )


def parameters_rating(results: JointResults) -> QualityRating:
    """Judge how well the data determine the model's parameters."""
    stated = results.model.parameters
    unknown = [PARAMETER_SYMBOLS[name] for name in PARAMETERS if not stated[name].determined]
    if unknown:
        return QualityRating(
            level=POOR,
            name="Parameters",
            reason=f"The data do not determine {list_text(unknown)}.",
        )
    rough = [PARAMETER_SYMBOLS[name] for name in imprecise_parameters(results)]
    if rough:
        return QualityRating(
            level=FAIR,
            name="Parameters",
            reason=f"All determined, but {list_text(rough)} only to within more than"
            f" ±{100 * _VAGUE:.0f} %.",
        )
    return QualityRating(
        level=GOOD,
        name="Parameters",
        reason=f"All determined to within ±{100 * _VAGUE:.0f} % or better.",
    )


def imprecise_parameters(results: JointResults) -> list[str]:
    """Return the parameters whose interval is wider than ±50 % of the estimate."""
    rough = []
    for name in PARAMETERS:
        stated = results.model.parameters[name]
        if stated.determined and stated.ci95 is not None:
            low, high = stated.ci95
            if high - low > 2 * _VAGUE * abs(stated.estimate):
                rough.append(name)
    return rough


def model_rating(results: JointResults, diagnosis: Mapping[str, Any] | None) -> QualityRating:
    """Judge whether the friction function describes the joint."""
    if diagnosis is None:
        return QualityRating(
            level=FAIR, name="Model", reason="What the model misses has not been judged yet."
        )
    missed = f"{number_text(diagnosis['simulation']['rmse'])} {results.unit} (RMS)"
    causes = [[in_words(name) for name in cause["effects"]] for cause in diagnosis["causes"]]
    told = list_text([" or ".join(names) for names in causes if names] or ["nothing"])
    if diagnosis["verdict"] == "no_evidence":
        return QualityRating(
            level=GOOD,
            name="Model",
            reason=f"No cause was found in what the simulated torque misses, {missed}.",
        )
    if diagnosis["verdict"] == "unnamed":
        return QualityRating(
            level=POOR,
            name="Model",
            reason=f"The simulated torque misses {missed}, with structure that no known effect"
            " explains.",
        )
    return QualityRating(
        level=FAIR,
        name="Model",
        reason=f"Equation (16) lacks {told}: alone it misses {missed}. The extended model has it.",
    )


def _at_least(value: float, limits: tuple[float, float]) -> str:
    good, fair = limits
    return GOOD if value >= good else FAIR if value >= fair else POOR


def _at_most(value: float, limits: tuple[float, float]) -> str:
    good, fair = limits
    return GOOD if value <= good else FAIR if value <= fair else POOR


def _worst(*levels: str) -> str:
    return max(levels, key=(GOOD, FAIR, POOR).index)
