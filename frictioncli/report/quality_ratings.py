"""Ratings of data quality: good, fair or poor, each with its reason."""

from dataclasses import dataclass

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.sentences import alternatives_text
from frictioncli.model.document import PARAMETERS
from frictioncli.report.labels import PARAMETER_SYMBOLS
from frictioncli.report.results import JointResults
from frictioncli.report.style import PHASE_WORDS, PHASES
from frictioncli.wording import (
    count_text,
    list_text,
    number_text,
    speed_text,
    thousands_text,
)

GOOD, FAIR, POOR = "good", "fair", "poor"

_REJECTED = (0.001, 0.05)
"""Greatest shares of rejected rows that are rated good, and fair."""

_PAIRS = (100, 30)
"""Least numbers of pairs that are rated good, and fair."""

_SPEEDS = (4, 2)
"""Least numbers of speeds that are rated good, and fair."""

_SPEED_RATIOS = (4.0, 1.5)
"""Least ratios of the highest to the lowest speed that are rated good, and fair."""

_TEMPERATURE_SPANS = (20.0, 10.0)
"""Least ranges of motor temperature that are rated good, and fair. [°C]"""

_IMPRECISE = 0.5
"""Relative half-width of a 95 % interval above which a parameter counts as imprecise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityRating:
    """Rating of one aspect of data quality.

    Attributes
    ----------
    level : {"good", "fair", "poor"}
        The rating, shown green, amber or red.
    name : str
        The aspect that is rated.
    reason : str
        Why it has this rating.
    """

    level: str
    name: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IngestCounts:
    """Numbers of rows and files of the logs that were read and rejected.

    Attributes
    ----------
    rows, rejected : int
        Rows read, and how many of them were rejected.
    files, unusable_files : int
        Files used, and files that could not be used at all.
    time_known : bool or None
        Whether the start time of each recording is known; None if that is not recorded.
    warnings : int
        Number of warnings.
    """

    rows: int
    rejected: int
    files: int
    unusable_files: int
    time_known: bool | None
    warnings: int


def quality_ratings(
    results: JointResults, counts: IngestCounts, diagnosis: DiagnosisDocument | None
) -> list[QualityRating]:
    """Return all ratings for one joint.

    Parameters
    ----------
    results : JointResults
        The joint's results.
    counts : IngestCounts
        Rows and files of the logs that were read and rejected.
    diagnosis : DiagnosisDocument or None
        The joint's part of ``diagnosis.json``, if there is one.
    """
    return [
        *([reading_rating(counts)] if counts.files else []),
        *([time_rating(counts)] if counts.time_known is not None else []),
        runs_rating(results),
        pairs_rating(results),
        speeds_rating(results),
        temperature_rating(results),
        parameters_rating(results),
        model_rating(results, diagnosis),
    ]


def reading_rating(counts: IngestCounts) -> QualityRating:
    """Rate the share of rows that could be read."""
    share = counts.rejected / max(counts.rows, 1)
    level = _at_most(share, _REJECTED)
    if counts.unusable_files and level == GOOD:
        level = FAIR
    unusable = (
        f"; {count_text(counts.unusable_files, 'file')} could not be used at all"
        if counts.unusable_files
        else ""
    )
    return QualityRating(
        level=level,
        name="Reading",
        reason=f"{thousands_text(counts.rejected)} of {count_text(counts.rows, 'row')} in"
        f" {count_text(counts.files, 'file')} rejected{unusable}.",
    )


def time_rating(counts: IngestCounts) -> QualityRating:
    """Rate whether start times are known and units are certain."""
    if not counts.time_known:
        return QualityRating(
            level=POOR,
            name="Time",
            reason="The logs do not say when each recording began, so effects of time and of"
            " temperature history cannot be judged. A manifest.csv can provide this.",
        )
    if counts.warnings:
        return QualityRating(
            level=FAIR,
            name="Time and units",
            reason=f"{count_text(counts.warnings, 'warning')} while reading; see the notes below.",
        )
    return QualityRating(
        level=GOOD, name="Time and units", reason="Start times are known; reading without warnings."
    )


def runs_rating(results: JointResults) -> QualityRating:
    """Rate whether there is more than one run, so that the model can be tested on a new one."""
    count = len(results.runs)
    if count > 1:
        return QualityRating(
            level=GOOD,
            name="Runs",
            reason=f"{count_text(count, 'run')}: a model can be tested on a run not used for"
            " fitting.",
        )
    return QualityRating(
        level=FAIR,
        name="Runs",
        reason="One run only: a slow drift cannot be distinguished from an offset, and there is no"
        " other run to test the model on.",
    )


def pairs_rating(results: JointResults) -> QualityRating:
    """Rate the number of pairs of counter-directed moves, or of groups by regression."""
    count, noun = len(results.pairs), results.row_noun
    meaning = results.rows_meaning.rstrip(",")
    return QualityRating(
        level=_at_least(count, _PAIRS),
        name=f"{noun}s".capitalize(),
        reason=f"{count_text(count, noun)} {meaning}; good from {_PAIRS[0]}.",
    )


def speeds_rating(results: JointResults) -> QualityRating:
    """Rate whether the speeds can separate Coulomb from viscous friction."""
    # as the text of ``pair`` counts them
    speeds = sorted({round(speed, 1) for speed in results.styles})
    level = worst_level(
        _at_least(len(speeds), _SPEEDS), _at_least(speeds[-1] / speeds[0], _SPEED_RATIOS)
    )
    measured = (
        speed_text(speeds[0])
        if len(speeds) == 1
        else f"{len(speeds)} speeds, {speed_text(speeds[0])} to {speed_text(speeds[-1])}"
    )
    return QualityRating(
        level=level,
        name="Speeds",
        reason=f"{measured}; good from {_SPEEDS[0]} speeds over a ratio of {_SPEED_RATIOS[0]:g}.",
    )


def temperature_rating(results: JointResults) -> QualityRating:
    """Rate the range of motor temperature and whether both heating and cooling were measured."""
    warm = results.thermal_pairs["motor_temperature"].dropna()
    if warm.empty:
        fault = (
            "No heating or cooling of the motor was found"
            if results.has("motor_temperature")
            else "The log has no motor temperature"
        )
        return QualityRating(
            level=POOR,
            name="Temperature",
            reason=f"{fault}: the effect of temperature on friction remains unknown.",
        )
    span = float(warm.max() - warm.min())
    found = [phase for phase in PHASES if (results.thermal_pairs["phase"] == phase).any()]
    level = _at_least(span, _TEMPERATURE_SPANS)
    alone = ""
    if len(found) == 1:
        level = worst_level(level, FAIR)
        alone = f" Only {PHASE_WORDS[found[0]]} was measured, so a lag cannot be seen."
    return QualityRating(
        level=level,
        name="Temperature",
        reason=f"Motor from {warm.min():.0f} to {warm.max():.0f} °C in"
        f" {list_text([PHASE_WORDS[phase] for phase in found])}; good from a span of"
        f" {_TEMPERATURE_SPANS[0]:.0f} °C.{alone}",
    )


def parameters_rating(results: JointResults) -> QualityRating:
    """Rate how well the data determine the model's parameters."""
    stated = results.model.parameters
    undetermined = [PARAMETER_SYMBOLS[name] for name in PARAMETERS if not stated[name].determined]
    if undetermined:
        return QualityRating(
            level=POOR,
            name="Parameters",
            reason=f"The data do not determine {list_text(undetermined)}.",
        )
    imprecise = [PARAMETER_SYMBOLS[name] for name in imprecise_parameters(results)]
    if imprecise:
        return QualityRating(
            level=FAIR,
            name="Parameters",
            reason=f"All are determined, but {list_text(imprecise)} to no better than"
            f" ±{100 * _IMPRECISE:.0f} %.",
        )
    return QualityRating(
        level=GOOD,
        name="Parameters",
        reason=f"All are determined to within ±{100 * _IMPRECISE:.0f} % or better.",
    )


def imprecise_parameters(results: JointResults) -> list[str]:
    """Return the parameters whose 95 % interval is wider than ±50 % of the estimate."""
    imprecise = []
    for name in PARAMETERS:
        stated = results.model.parameters[name]
        if stated.determined and stated.ci95 is not None:
            low, high = stated.ci95
            if high - low > 2 * _IMPRECISE * abs(stated.estimate):
                imprecise.append(name)
    return imprecise


def model_rating(results: JointResults, diagnosis: DiagnosisDocument | None) -> QualityRating:
    """Rate whether the friction function describes the joint."""
    if diagnosis is None:
        return QualityRating(
            level=FAIR, name="Model", reason="The errors of the model have not been diagnosed yet."
        )
    missed = f"{number_text(diagnosis.simulation.rmse)} {results.unit} (RMS)"
    left = diagnosis.remainder
    beside = (
        f" {'On a new run its' if left.basis == 'new_run' else 'Its'} error is still"
        f" {number_text(left.rmse)} {results.unit}, where noise alone is"
        f" {number_text(left.noise_floor)} {results.unit}."
        if left
        else ""
    )
    if diagnosis.verdict != "unnamed" and not diagnosis.modelled_causes:
        return QualityRating(
            level=FAIR if left else GOOD,
            name="Model",
            reason=f"No cause was found in the errors of the simulated torque, {missed}.{beside}",
        )
    if diagnosis.verdict == "unnamed":
        return QualityRating(
            level=POOR,
            name="Model",
            reason=f"The simulated torque is wrong by {missed}, with structure that no known effect"
            f" explains.{beside}",
        )
    lacking, measured = (
        list_text(names) if names else ""
        for names in (
            [alternatives_text(one) for one in diagnosis.modelled_causes if not one.is_measurement],
            [alternatives_text(one) for one in diagnosis.modelled_causes if one.is_measurement],
        )
    )
    lacks = f"lacks {lacking}" if lacking else ""
    adds = f"does not account for {measured} in the measurement" if measured else ""
    return QualityRating(
        level=FAIR,
        name="Model",
        reason=f"Equation (16) {' and '.join(filter(None, [lacks, adds]))}: alone it is wrong by"
        f" {missed}. The extended model includes it.{beside}",
    )


def _at_least(value: float, limits: tuple[float, float]) -> str:
    good, fair = limits
    return GOOD if value >= good else FAIR if value >= fair else POOR


def _at_most(value: float, limits: tuple[float, float]) -> str:
    good, fair = limits
    return GOOD if value <= good else FAIR if value <= fair else POOR


def worst_level(*levels: str) -> str:
    """Return the worst of some levels."""
    return max(levels, key=(GOOD, FAIR, POOR).index)
