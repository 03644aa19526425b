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
from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.inspection.map_suggestion.motion_columns import MotionColumns, find_motion
from frictioncli.inspection.map_suggestion.temperature_columns import guess_temperature
from frictioncli.inspection.map_suggestion.time_columns import (
    TimeColumn,
    find_time_columns,
    possible_time_units,
)
from frictioncli.inspection.map_suggestion.torque_columns import (
    direction_dependences,
    guess_load,
    guess_torque,
)
from frictioncli.logs.channels import channel_names as names


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
    """

    guesses: Mapping[str, ColumnGuess]
    joint: int
    travel: float = 0.0

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


def suggest_columns(head: LogHead, joint: int | None) -> Suggestion:
    """Suggest the columns of one joint.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    joint : int or None
        The joint wanted, from 1; None for the one that moves most.

    Raises
    ------
    NotEnoughData
        If no column resembles a time, or none a joint's position.
    """
    times = find_time_columns(head)
    if not times:
        raise NotEnoughData(
            f"none of {len(head.values)} columns of numbers grows from row to row in even steps,"
            " as a time does; a log needs a time column"
        )
    time, derivatives = _time_with_derivatives(head, times)
    columns = log_columns(head, time.column)
    time_columns = frozenset(one.column for one in times)
    motion = find_motion(columns, derivatives, time, time_columns, joint)
    number = joint or columns.joints.get(motion.position.column) or 1
    moving = {column for pair in derivatives for column in (pair.position, pair.velocity)}
    excluded = time_columns | moving | {motion.position.column}
    dependences = direction_dependences(
        head, motion.degrees, motion.degrees_per_second, excluded | columns.no_torque()
    )
    guesses = {
        names.TIME: _guess_time(time, times, motion),
        names.POSITION: motion.position,
        names.VELOCITY: motion.velocity,
        names.TORQUE: guess_torque(columns, dependences, number),
    }
    torque = guesses[names.TORQUE]
    if torque is not None:
        guesses[names.LOAD] = guess_load(columns, dependences, number, torque.column)
    chosen = {guess.column for guess in guesses.values() if guess is not None}
    guesses[names.MOTOR_TEMPERATURE] = guess_temperature(columns, number, excluded | chosen)
    travel = float(np.abs(np.diff(motion.degrees)).sum())
    return Suggestion({name: g for name, g in guesses.items() if g is not None}, number, travel)


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
