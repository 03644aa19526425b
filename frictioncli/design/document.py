"""The records of ``plan.json``."""

from collections.abc import Mapping
from typing import Annotated

import msgspec
from msgspec import UNSET, UnsetType, field


class SeriesRecord(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="series"):
    """Recorded moves there and back, one pair per speed.

    Attributes
    ----------
    speeds_deg_s : tuple of float
        Speeds in their order. [deg/s]
    low_deg, high_deg : float
        Ends of the moves. [deg]
    payload_kg : float or None
        Payload to mount; none: the mounted one stays. [kg]
    """

    speeds_deg_s: tuple[float, ...]
    low_deg: float
    high_deg: float
    payload_kg: float | None


class HeatRecord(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="heat"):
    """Unrecorded moves there and back that heat the joint.

    Attributes
    ----------
    speed_deg_s : float
        Speed. [deg/s]
    low_deg, high_deg : float
        Ends of the moves. [deg]
    duration_s : float
        Longest duration. [s]
    until_degC : float or None
        Motor temperature at which the moves end earlier. [°C]
    """

    speed_deg_s: float
    low_deg: float
    high_deg: float
    duration_s: float
    until_degC: float | None


class RestRecord(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="rest"):
    """Static hold.

    Attributes
    ----------
    duration_s : float
        Longest duration. [s]
    until_degC : float or None
        Motor temperature at which the hold ends earlier. [°C]
    """

    duration_s: float
    until_degC: float | None


class RaisedChanceRecord(msgspec.Struct, frozen=True, kw_only=True):
    """How a block raises the probability that a rival is ruled out.

    Attributes
    ----------
    rival, truth : str
        The rival, and the effect that is at work then; ``truth`` is the key ``if``.
    chance_before, chance_after : float
        Probability without and with the block. [1]
    """

    rival: str
    truth: str = field(name="if")
    chance_before: float
    chance_after: float


class ChanceRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Probability that a rival is ruled out by the whole programme.

    Attributes
    ----------
    truth, rival : str
        The effect that is at work, and the rival; ``truth`` is the key ``if``.
    chance : float
        The probability. [1]
    """

    truth: str = field(name="if")
    rival: str
    chance: float


class BlockExpectationRecord(msgspec.Struct, frozen=True, kw_only=True):
    """What is expected after a block.

    Attributes
    ----------
    right_name_alone : tuple of float
        For each question, probability that only the right effect is left. [1]
    rules_out : tuple of RaisedChanceRecord
        Rivals that the block helps to rule out.
    """

    right_name_alone: tuple[float, ...]
    rules_out: tuple[RaisedChanceRecord, ...]


class BlockRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A block of the programme. What is predicted is absent for a joint without data.

    Attributes
    ----------
    name, reason : str
        Its name, and why it is there.
    start_s, duration_s : float
        Predicted start and duration. [s]
    motor_temperature_degC : tuple of (float or None)
        Predicted motor temperature at start and end; none where not known. [°C]
    steps : tuple of records
        Its steps.
    expected : BlockExpectationRecord
        What is expected after it; absent in the check.
    """

    name: str
    reason: str
    start_s: float | UnsetType = UNSET
    duration_s: float | UnsetType = UNSET
    motor_temperature_degC: tuple[float | None, ...] | UnsetType = UNSET
    steps: tuple[SeriesRecord | HeatRecord | RestRecord, ...]
    expected: BlockExpectationRecord | UnsetType = UNSET


class ProgrammeRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A programme.

    Attributes
    ----------
    files : tuple of str
        Names of the robot program's files.
    duration_s : float
        Its duration. [s]
    blocks : tuple of BlockRecord
        Its blocks.
    """

    files: tuple[str, ...]
    duration_s: float
    blocks: Annotated[tuple[BlockRecord, ...], msgspec.Meta(min_length=1)]


class CheckRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The programme of the next day, fields as of :class:`ProgrammeRecord`.

    Attributes
    ----------
    when : str
        When to run it.
    """

    when: str
    files: tuple[str, ...]
    duration_s: float
    blocks: tuple[BlockRecord, ...]


class LimitsRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Limits of the joint's motion, as of :class:`frictioncli.design.limits.Limits`."""

    low_deg: float
    high_deg: float
    slowest_deg_s: float
    fastest_deg_s: float
    hottest_degC: float
    payloads_kg: tuple[float, ...]
    speed_step_deg_s: float | None
    beyond_measured: tuple[str, ...]


class DecisionRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Probability that only the right effect is left.

    Attributes
    ----------
    now, after, after_check : float
        With the observed rows, after the programme, and after the check. [1]
    """

    now: float
    after: float
    after_check: float


class QuestionRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An open question of the diagnosis.

    Attributes
    ----------
    effects : tuple of str
        The rivals.
    probabilities : mapping of str to float
        Their probabilities. [1]
    right_name_alone : DecisionRecord
        Probability that only the right effect is left.
    rules_out : tuple of ChanceRecord
        Probability that each rival is ruled out.
    """

    effects: tuple[str, ...]
    probabilities: Mapping[str, float]
    right_name_alone: DecisionRecord
    rules_out: tuple[ChanceRecord, ...]


class IntervalRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The 95 % interval of a parameter.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    estimate, half_width_now : float or None
        Its value, and half the width of its interval; None where the data do not determine it.
        [unit]
    half_width_after : float or None
        Half the width after the programme; None where that does not determine it either. [unit]
    unit : str
        Its unit.
    wide : bool
        Whether the programme is chosen to make the interval narrower.
    """

    parameter: str
    estimate: float | None
    half_width_now: float | None
    half_width_after: float | None
    unit: str
    wide: bool


class ThermalRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The thermal model of the motor.

    Attributes
    ----------
    ambient_degC : float
        Ambient temperature. [°C]
    time_constant_s : float
        Time constant. [s]
    """

    ambient_degC: float
    time_constant_s: float


class UnnamedRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Structure that no effect explains, and what would show its nature.

    Attributes
    ----------
    description : str
        Where it shows, and which form describes it, if one does.
    experiment : str
        What to measure around it.
    """

    description: str
    experiment: str


class PlanDocument(msgspec.Struct, frozen=True, kw_only=True):
    """``plan.json``: the next experiment of one joint.

    Attributes
    ----------
    joint : int
        Joint number, from 1.
    verdict : str or None
        Verdict of the diagnosis; none for a joint without data, for which torque_unit, check,
        questions, intervals and thermal are absent.
    torque_unit : str
        Unit of torque.
    limits : LimitsRecord
        Limits of the motion.
    programme : ProgrammeRecord
        The programme.
    check : CheckRecord
        The programme of the next day.
    questions : tuple of QuestionRecord
        Open questions of the diagnosis.
    unnamed : UnnamedRecord
        Structure that no effect explains; absent where there is none.
    intervals : tuple of IntervalRecord
        Intervals of the parameters.
    thermal : ThermalRecord or None
        Thermal model; none where the log has no motor temperature.
    budget_min : float
        Time that was given. [min]
    """

    joint: int
    verdict: str | None
    torque_unit: str | UnsetType = UNSET
    limits: LimitsRecord
    programme: ProgrammeRecord
    check: CheckRecord | UnsetType = UNSET
    questions: tuple[QuestionRecord, ...] | UnsetType = UNSET
    unnamed: UnnamedRecord | UnsetType = UNSET
    intervals: tuple[IntervalRecord, ...] | UnsetType = UNSET
    thermal: ThermalRecord | UnsetType | None = UNSET
    budget_min: float
