"""From the beginning of a log to guesses of its time, motion, torque, load and temperature."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from frictioncli.errors import NotEnoughData
from frictioncli.inspection.map_suggestion.columns import OTHERS, columns_of
from frictioncli.inspection.map_suggestion.derivatives import Derivative, derivatives
from frictioncli.inspection.map_suggestion.guess import LIKELY, SURE, Guess
from frictioncli.inspection.map_suggestion.motion_columns import MotionColumns, find_motion
from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.inspection.map_suggestion.temperature_columns import temperature_guess
from frictioncli.inspection.map_suggestion.time_columns import TimeColumn, clocks, possible_units
from frictioncli.inspection.map_suggestion.torque_columns import (
    load_guess,
    oppositions,
    torque_guess,
)
from frictioncli.logs.channels import aliases as names


@dataclass(frozen=True, slots=True)
class Suggestion:
    """Canonical name to guess, and the joint's number."""

    guesses: Mapping[str, Guess]
    joint: int


def suggest(found: Probe, joint: int | None) -> Suggestion:
    """Find out which columns of a log are which.

    Parameters
    ----------
    found : Probe
        The beginning of the log.
    joint : int or None
        The joint wanted, from 1; None for the one that moves most.

    Raises
    ------
    NotEnoughData
        If no column is like a time, or none like a joint's position.
    """
    candidates = clocks(found)
    if not candidates:
        raise NotEnoughData(
            f"none of {len(found.values)} columns of numbers grows from row to row in even steps,"
            " as a time does; a log needs a time column"
        )
    clock, pairs = _clock_and_pairs(found, candidates)
    columns = columns_of(found, clock.column)
    times = frozenset(one.column for one in candidates)
    motion = find_motion(columns, pairs, clock, times, joint)
    number = joint or columns.numbers.get(motion.position.column) or 1
    moving = {column for pair in pairs for column in (pair.position, pair.velocity)}
    apart = times | moving | {motion.position.column}
    judged = oppositions(
        found, motion.degrees, motion.degrees_per_second, apart | columns.no_torque()
    )
    guesses = {
        names.TIME: _time(clock, candidates, motion),
        names.POSITION: motion.position,
        names.VELOCITY: motion.velocity,
        names.TORQUE: torque_guess(columns, judged, number),
    }
    torque = guesses[names.TORQUE]
    if torque is not None:
        guesses[names.LOAD] = load_guess(columns, judged, number, torque.column)
    chosen = {guess.column for guess in guesses.values() if guess is not None}
    guesses[names.MOTOR_TEMPERATURE] = temperature_guess(columns, number, apart | chosen)
    return Suggestion({name: g for name, g in guesses.items() if g is not None}, number)


def _clock_and_pairs(
    found: Probe, candidates: Sequence[TimeColumn]
) -> tuple[TimeColumn, list[Derivative]]:
    """Return the first clock by which some column is another one's derivative, and those pairs."""
    for clock in candidates:
        pairs = derivatives(found, clock.column, possible_units(clock))
        if pairs:
            return clock, pairs
    return candidates[0], []


def _time(clock: TimeColumn, candidates: Sequence[TimeColumn], motion: MotionColumns) -> Guess:
    others = tuple((one.column, one.why) for one in candidates if one.column != clock.column)
    sure = SURE if motion.velocity is not None and motion.velocity.sure == SURE else LIKELY
    return Guess(clock.column, clock.why, sure, motion.time_unit, others[:OTHERS])
