"""Suggest the columns of time, motion, torque, load and temperature from the head of a log."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.errors import NotEnoughData
from frictioncli.inspection.map_suggestion.columns import (
    LIKELY,
    MAX_ALTERNATIVES,
    SURE,
    ColumnGuess,
    log_columns,
)
from frictioncli.inspection.map_suggestion.derivatives import Derivative, find_derivatives
from frictioncli.inspection.map_suggestion.direction_dependence import direction_dependences
from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.inspection.map_suggestion.motion_columns import MotionColumns, find_motion
from frictioncli.inspection.map_suggestion.speed_columns import columns_as_read, columns_of_speed
from frictioncli.inspection.map_suggestion.temperature_columns import guess_temperature
from frictioncli.inspection.map_suggestion.time_columns import (
    TimeColumn,
    find_time_columns,
    possible_time_units,
)
from frictioncli.inspection.map_suggestion.torque_columns import (
    guess_load,
    guess_torque,
    load_as_read,
    torque_as_read,
)
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_plan import JointPlan


@dataclass(frozen=True, slots=True)
class Suggestion:
    """Suggested columns of a joint.

    Attributes
    ----------
    guesses : mapping of str to ColumnGuess
        Column by quantity.
    joint : int
        Number of the joint, from 1.
    travel : float
        Travel of the joint in both directions. [deg]
    torque_side : str
        Side of the gear of the torque, ``joint`` or ``motor``.
    gear_ratio : float or None
        Motor turns per joint turn, by which a motor's torque is brought to the joint. [-]
    """

    guesses: Mapping[str, ColumnGuess]
    joint: int
    travel: float = 0.0
    torque_side: str = names.JOINT_SIDE
    gear_ratio: float | None = None

    @property
    def worth(self) -> tuple[int, float]:
        """What a log tells: how certain its torque and velocity are, then how far it moves."""
        certain = {SURE: 2, LIKELY: 1}
        known = [self.guesses.get(name) for name in (names.TORQUE, names.VELOCITY)]
        return sum(1 + certain.get(g.confidence, 0) for g in known if g is not None), self.travel

    def doubted(self) -> "Suggestion":
        """Return the suggestion with nothing in it that is called sure."""
        guesses = {
            name: replace(guess, confidence=LIKELY) if guess.confidence == SURE else guess
            for name, guess in self.guesses.items()
        }
        return replace(self, guesses=guesses)


def suggest_columns(
    head: LogHead,
    joint: int | None,
    *,
    file_joint: int | None = None,
    plans: Sequence[JointPlan] = (),
) -> Suggestion:
    """Suggest the columns of one joint.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    joint : int or None
        The joint wanted, from 1; None for the one that moves most.
    file_joint : int, optional
        The joint that the file tells, of columns whose names have none.
    plans : sequence of JointPlan
        How the log is read without a map, by joint; its torque and load are then suggested too.

    Raises
    ------
    NotEnoughData
        If no column resembles a time, or none a joint's position.
    """
    times = find_time_columns(head)
    if not times:
        raise NotEnoughData(
            f"none of {len(head.values)} columns of numbers grows from row to row in even steps,"
            " as a time does; without a time column, give the period of the rows in a mapping file"
            " ([csv] period = 0.005, in s), from which a map is suggested with --map"
        )
    time, derivatives = _time_with_derivatives(head, times)
    columns = log_columns(head, time.column)
    time_columns = frozenset(one.column for one in times)
    integrated = next((plan for plan in plans if _is_integrated(plan, head)), None)
    if integrated is not None:
        return _at_side(Suggestion(*columns_as_read(columns, times, integrated)), integrated)
    try:
        motion = find_motion(columns, derivatives, time, time_columns, joint)
    except NotEnoughData:
        alone = columns_of_speed(columns, times)
        if alone is None:
            raise
        return Suggestion(*alone)
    number = joint or columns.joints.get(motion.position.column) or file_joint or 1
    moving = {column for pair in derivatives for column in (pair.position, pair.velocity)}
    excluded = time_columns | moving | {motion.position.column}
    plan = next((one for one in plans if one.channels.joint == number), None)
    dependences = direction_dependences(
        head, motion.degrees, motion.degrees_per_second, excluded | columns.no_torque()
    )
    guesses = {
        names.TIME: _guess_time(time, times, motion),
        names.POSITION: motion.position,
        names.VELOCITY: motion.velocity,
        names.PAYLOAD: None if plan is None else _payload_as_read(plan),
    }
    torque = torque_as_read(columns, dependences, plan) if plan is not None else None
    if torque is not None and plan is not None:
        guesses |= {names.TORQUE: torque, names.LOAD: load_as_read(columns, plan)}
    else:
        plan, torque = None, guess_torque(columns, dependences, number)
        guesses[names.TORQUE] = torque
        if torque is not None:
            guesses[names.LOAD] = guess_load(columns, dependences, number, torque.column)
    chosen = {guess.column for guess in guesses.values() if guess is not None}
    guesses[names.MOTOR_TEMPERATURE] = guess_temperature(columns, number, excluded | chosen)
    travel = float(np.abs(np.diff(motion.degrees)).sum())
    found = {name: guess for name, guess in guesses.items() if guess is not None}
    return _at_side(Suggestion(found, number, travel), plan)


def _payload_as_read(plan: JointPlan) -> ColumnGuess | None:
    """Return the payload that is read without a map; None where the log has none."""
    channel, conversion = plan.channels.payload, plan.conversions.get(names.PAYLOAD)
    if channel is None or conversion is None:
        return None
    return ColumnGuess(channel.column, "its name says so", LIKELY, conversion.unit)


def _is_integrated(plan: JointPlan, head: LogHead) -> bool:
    """Return whether a position is made from the velocity, over a time that changes."""
    channels = plan.channels
    return channels.position.name == names.INTEGRATED and channels.time.column in head.values


def _at_side(suggestion: Suggestion, plan: JointPlan | None) -> Suggestion:
    """Return a suggestion with the side of the torque, as it is read without a map."""
    if plan is None or plan.torque_unit != "N·m":
        return suggestion
    conversion = plan.conversions[names.TORQUE]
    if plan.torque_side == names.MOTOR_SIDE:
        return replace(suggestion, torque_side=names.MOTOR_SIDE)
    if plan.channels.torque.meaning.side == names.JOINT_SIDE:
        return suggestion
    ratio = conversion.factor / units.FACTORS[names.TORQUE][conversion.unit]
    # of no side by its name, and taken as that of the joint
    if ratio == 1.0:
        return suggestion
    return replace(suggestion, torque_side=names.MOTOR_SIDE, gear_ratio=ratio)


def _time_with_derivatives(
    head: LogHead, times: Sequence[TimeColumn]
) -> tuple[TimeColumn, list[Derivative]]:
    """Return the first time column with which derivatives are found, and these."""
    for time in times:
        derivatives = find_derivatives(head, time.column, possible_time_units(time))
        if derivatives:
            return time, derivatives
    return times[0], []


def _guess_time(
    time: TimeColumn, times: Sequence[TimeColumn], motion: MotionColumns
) -> ColumnGuess:
    alternatives = tuple((one.column, one.reason) for one in times if one.column != time.column)
    is_sure = motion.velocity is not None and motion.velocity.confidence == SURE
    return ColumnGuess(
        time.column,
        time.reason,
        SURE if is_sure else LIKELY,
        motion.time_unit,
        alternatives[:MAX_ALTERNATIVES],
    )
