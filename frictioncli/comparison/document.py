"""The records of ``comparison.json``."""

from collections.abc import Mapping

import msgspec


class MeanFrictionRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Mean friction torque over all runs, which percentages refer to.

    Attributes
    ----------
    estimate : float
        The mean. [unit]
    unit : str
        Unit of torque.
    """

    estimate: float
    unit: str


class EstimateRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An estimate with its interval.

    Attributes
    ----------
    estimate : float
        The estimate. [unit]
    ci95 : (float, float)
        95 % confidence interval. [unit]
    unit : str
        Its unit.
    """

    estimate: float
    ci95: tuple[float, float]
    unit: str


class PercentRecord(EstimateRecord, frozen=True, kw_only=True):
    """A change in percent.

    Attributes
    ----------
    p_value : float
        Probability of a change as far from zero by chance. [1]
    """

    p_value: float


class ChangeRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A change of friction in both units.

    Attributes
    ----------
    change : float
        The change. [unit]
    ci95 : (float, float)
        95 % confidence interval. [unit]
    unit : str
        Unit of torque.
    percent : PercentRecord
        The same in percent of the mean friction.
    """

    change: float
    ci95: tuple[float, float]
    unit: str
    percent: PercentRecord


class TrendRecord(ChangeRecord, frozen=True, kw_only=True):
    """The change from the first run to the last, by a straight line through all runs.

    Attributes
    ----------
    per_run : EstimateRecord
        Change per run.
    per_1000_h : EstimateRecord or None
        Change per 1000 h; none where the dates of the runs are not known.
    """

    per_run: EstimateRecord
    per_1000_h: EstimateRecord | None


class CauseOfChangeRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A cause of the change.

    Attributes
    ----------
    effects : tuple of str
        The credible set: effects that these data cannot tell apart.
    probabilities : mapping of str to float
        Probability of each effect. [1]
    channel : str
        The part of the torque in which it shows.
    claim : str
        The cause in words.
    change : PercentRecord
        Its size.
    since : str or None
        The run at which it begins; none where it has no beginning.
    experiment : str
        What to measure next.
    """

    effects: tuple[str, ...]
    probabilities: Mapping[str, float]
    channel: str
    claim: str
    change: PercentRecord
    since: str | None
    experiment: str


class ConditionRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The change of friction at a reference condition, first run to last.

    Attributes
    ----------
    temperature : float
        Temperature. [°C]
    speed : float
        Absolute joint velocity. [deg/s]
    load : float
        Load torque. [load unit]
    friction : float
        Friction torque of the model. [unit]
    change : float
        Its change. [unit]
    ci95 : (float, float)
        95 % confidence interval of the change. [unit]
    unit : str
        Unit of torque.
    percent : PercentRecord
        The same in percent of the friction there.
    extrapolated : bool
        Whether a run has not measured this temperature.
    """

    temperature: float
    speed: float
    load: float
    friction: float
    change: float
    ci95: tuple[float, float]
    unit: str
    percent: PercentRecord
    extrapolated: bool


class ParameterChangeRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A parameter of the first and of the last work folder's model.

    Attributes
    ----------
    first, last : float
        Its values. [unit]
    change : float or None
        Their difference; none where a model does not determine the parameter. [unit]
    ci95 : (float, float) or None
        95 % confidence interval of the difference. [unit]
    unit : str
        Its unit.
    """

    first: float
    last: float
    change: float | None
    ci95: tuple[float, float] | None
    unit: str


class RunRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Friction of one run.

    Attributes
    ----------
    folder, run : str
        Its work folder and its name.
    started_at : str or None
        Begin of the run, ISO 8601; none where not known.
    days : float or None
        Time since the first run; none where the dates of the runs are not known. [d]
    surroundings : float or None
        Temperature of the surroundings; none where not known. [°C]
    measured : float
        Friction against the mean of all runs, as measured. [%]
    level : float
        The same without what the surroundings explain. [%]
    ci95 : (float, float)
        95 % confidence interval of the level. [%]
    unit : str
        ``%``.
    """

    folder: str
    run: str
    started_at: str | None
    days: float | None
    surroundings: float | None
    measured: float
    level: float
    ci95: tuple[float, float]
    unit: str


class ScatterRecord(msgspec.Struct, frozen=True, kw_only=True):
    """How much friction differs from day to day.

    Attributes
    ----------
    day_to_day : float
        Standard deviation that the intervals are computed with. [%]
    assumed : float
        Standard deviation that is assumed before any run is seen. [%]
    unit : str
        ``%``.
    surroundings_from : str
        Where the temperature of the surroundings is taken from.
    """

    day_to_day: float
    assumed: float
    unit: str
    surroundings_from: str


class MarginRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The change that is asked for.

    Attributes
    ----------
    value : float
        The change. [unit]
    unit : str
        Its unit.
    """

    value: float
    unit: str


class ThresholdRecord(MarginRecord, frozen=True, kw_only=True):
    """The threshold of ``--fail-above``, in % or in the unit of torque.

    Attributes
    ----------
    exceeded : bool or None
        Whether a change above it was found.
    """

    exceeded: bool | None


class ComparisonDocument(msgspec.Struct, frozen=True, kw_only=True):
    """``comparison.json``: what changed between the runs of one joint.

    Attributes
    ----------
    verdict : {"no_evidence", "changed", "undetermined"}
        Whether friction has changed.
    weak : bool
        Whether the intervals rest on an assumed scatter from day to day.
    joint : int
        Joint number, from 1.
    torque_unit, load_unit : str
        Units of friction torque and of load torque.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    folders : tuple of str
        Names of the work folders, in order of time.
    mean_friction : MeanFrictionRecord
        Mean friction torque.
    trend : TrendRecord
        Change from the first run to the last.
    last_run : ChangeRecord or None
        Last run against the mean of the earlier ones; none with two runs.
    load : PercentRecord or None
        Change of the load torque, first run to last; none where the joint carries next to nothing.
    causes : tuple of CauseOfChangeRecord
        Causes of the change.
    friction : tuple of ConditionRecord
        Change at reference conditions.
    parameters : mapping of str to ParameterChangeRecord
        Models of the first and the last work folder; empty if there is one work folder.
    runs : tuple of RunRecord
        The runs, in order of time.
    scatter : ScatterRecord
        Scatter from day to day.
    margin : MarginRecord
        The change that is asked for.
    threshold : ThresholdRecord or None
        The threshold, if there is one.
    """

    verdict: str
    weak: bool
    joint: int
    torque_unit: str
    load_unit: str
    temperature: str
    folders: tuple[str, ...]
    mean_friction: MeanFrictionRecord
    trend: TrendRecord
    last_run: ChangeRecord | None
    load: PercentRecord | None
    causes: tuple[CauseOfChangeRecord, ...]
    friction: tuple[ConditionRecord, ...]
    parameters: Mapping[str, ParameterChangeRecord]
    runs: tuple[RunRecord, ...]
    scatter: ScatterRecord
    margin: MarginRecord
    threshold: ThresholdRecord | None
