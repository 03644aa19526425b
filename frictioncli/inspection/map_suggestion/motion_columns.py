"""Which columns are a joint's position and velocity."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData
from frictioncli.inspection.map_suggestion.columns import LogColumns
from frictioncli.inspection.map_suggestion.derivatives import Derivative
from frictioncli.inspection.map_suggestion.guess import GUESS, LIKELY, SURE, Guess
from frictioncli.inspection.map_suggestion.measured_or_commanded import measured_first, same_motion
from frictioncli.inspection.map_suggestion.time_columns import TimeColumn, possible_units
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import unit_evidence, units

_SURE_COSINE = 0.999
_SMOOTH = 0.05
"""Unevenness of a position that is taken for one without a velocity to confirm it."""


@dataclass(frozen=True, slots=True)
class MotionColumns:
    """Guesses of a joint's motion, the unit of time, and the motion [deg], [deg/s]."""

    position: Guess
    velocity: Guess | None
    time_unit: str
    degrees: Array
    degrees_per_second: Array


def find_motion(
    columns: LogColumns,
    pairs: Sequence[Derivative],
    clock: TimeColumn,
    apart: Collection[int],
    joint: int | None,
) -> MotionColumns:
    """Choose position and velocity of the joint wanted, else of the one that moves most.

    Parameters
    ----------
    columns : LogColumns
        The log's columns.
    pairs : sequence of Derivative
        Columns and their derivatives.
    clock : TimeColumn
        The time.
    apart : collection of int
        Columns that are no positions.
    joint : int or None
        The joint wanted.

    Raises
    ------
    NotEnoughData
        If no column is like a position.
    """
    own = [pair for pair in pairs if columns.is_of(pair.position, joint)] or list(pairs)
    if not own:
        return _without_velocity(columns, clock, apart, joint)
    straight = [pair for pair in own if not _crossed(columns, pair)] or own
    most = max(straight, key=lambda pair: pair.travel * _degrees(pair))
    position, *others = _alike(columns, most.position, [pair.position for pair in own])
    mine = [pair for pair in own if pair.position == position]
    best = next((pair for pair in mine if pair.velocity == most.velocity), mine[0])
    velocity, *other_velocities = _alike(columns, best.velocity, [p.velocity for p in mine])
    chosen = next(pair for pair in mine if pair.velocity == velocity)
    sure = SURE if chosen.cosine > _SURE_COSINE else LIKELY
    sign = -1.0 if chosen.units.reversed_velocity else 1.0
    speed_unit = chosen.units.velocity or "deg/s"
    why = f"its change is the integral of {columns.found.names[velocity]}"
    return MotionColumns(
        position=Guess(
            position,
            f"{why} (cosine {chosen.cosine:.4f})",
            sure,
            chosen.units.position,
            columns.told(others, "shows the same motion"),
        ),
        velocity=Guess(
            velocity,
            f"derivative of {columns.found.names[position]} in {speed_unit}",
            sure,
            speed_unit,
            columns.told(other_velocities, "is the same derivative"),
        ),
        time_unit=chosen.units.time,
        degrees=columns.found.values[position] * _degrees(chosen),
        degrees_per_second=sign
        * columns.found.values[velocity]
        * units.FACTORS[names.VELOCITY][speed_unit],
    )


def _without_velocity(
    columns: LogColumns, clock: TimeColumn, apart: Collection[int], joint: int | None
) -> MotionColumns:
    """Choose a position by its name, else the smoothest column that goes there and back."""
    named = [
        column
        for column, channel in columns.known.items()
        if channel.quantity == names.POSITION and column in columns.found.values
    ]
    named = [column for column in named if columns.is_of(column, joint)] or named
    smooth = sorted(
        (column for column in columns.found.values if column not in apart),
        key=lambda column: _unevenness(columns.found.values[column]),
    )
    if not named and not (smooth and _unevenness(columns.found.values[smooth[0]]) < _SMOOTH):
        raise NotEnoughData(
            "no column is like a joint's position: none is another one's integral, none is"
            " named so, and none goes there and back smoothly; a friction test needs positions"
        )
    order = named or smooth
    column = max(named, key=lambda c: float(np.ptp(columns.found.values[c]))) if named else order[0]
    values = columns.found.values[column]
    possible, why = unit_evidence.possible_position_units(
        largest=float(np.max(np.abs(values))),
        span=float(np.ptp(values)),
        on_motor=False,
        path_per_angle=None,
    )
    unit = sorted(possible)[0]
    time_unit = possible_units(clock)[-1]
    degrees = values * units.FACTORS[names.POSITION][unit]
    seconds = columns.found.values[clock.column] * units.FACTORS[names.TIME][time_unit]
    reason = "its name says so" if named else "the smoothest column that goes there and back"
    number = columns.numbers.get(column, 1)
    others = [c for c in order if c != column and not columns.is_of_another(c, number)]
    return MotionColumns(
        position=Guess(
            column,
            f"{reason}; {why}" if why else reason,
            LIKELY if named else GUESS,
            unit,
            columns.told(others, "is the next candidate"),
        ),
        velocity=None,
        time_unit=time_unit,
        degrees=degrees,
        degrees_per_second=np.gradient(degrees, seconds),
    )


def _crossed(columns: LogColumns, pair: Derivative) -> bool:
    """Return whether names say that a pair is of two joints, which may move alike."""
    numbers = {columns.numbers.get(column) for column in (pair.position, pair.velocity)}
    return len(numbers) > 1


def _alike(columns: LogColumns, column: int, among: Sequence[int]) -> list[int]:
    """Return the columns that show the same motion as one, measured ones first."""
    values = columns.found.values
    alike = [c for c in dict.fromkeys(among) if same_motion(values[column], values[c])]
    return measured_first(alike, values, columns.found.names)


def _unevenness(values: Array) -> float:
    """Return how much neighbours differ from a straight line, by how much they differ at all."""
    steps = np.diff(values)
    return float(np.sqrt(np.mean(np.diff(steps) ** 2) / max(float(np.mean(steps**2)), 1e-300)))


def _degrees(pair: Derivative) -> float:
    return units.FACTORS[names.POSITION][pair.units.position]
