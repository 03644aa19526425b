"""Choose the columns of a joint's position and velocity."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData
from frictioncli.inspection.map_suggestion.columns import (
    COUNT,
    GUESS,
    LIKELY,
    SURE,
    ColumnGuess,
    LogColumns,
)
from frictioncli.inspection.map_suggestion.derivatives import Derivative
from frictioncli.inspection.map_suggestion.measured_or_commanded import (
    is_command,
    measured_first,
    same_motion,
)
from frictioncli.inspection.map_suggestion.time_columns import TimeColumn, possible_time_units
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import position_units, units
from frictioncli.logs.channels.column_name import unit_in_name

_ACCELERATION = re.compile(r"acc|beschl", re.I)
_TWO_TURNS = 720.0  # [deg]
_SURE_COSINE = 0.999
_MAX_UNEVENNESS = 0.05
"""Largest unevenness of a position that no velocity confirms."""


@dataclass(frozen=True, slots=True)
class MotionColumns:
    """Columns of a joint's motion.

    Attributes
    ----------
    position : ColumnGuess
        Column of the position.
    velocity : ColumnGuess or None
        Column of the velocity.
    time_unit : str
        Unit of the time.
    degrees : ndarray, shape (n,)
        Position. [deg]
    degrees_per_second : ndarray, shape (n,)
        Velocity. [deg/s]
    """

    position: ColumnGuess
    velocity: ColumnGuess | None
    time_unit: str
    degrees: Array
    degrees_per_second: Array


def find_motion(
    columns: LogColumns,
    derivatives: Sequence[Derivative],
    time: TimeColumn,
    excluded: Collection[int],
    joint: int | None,
) -> MotionColumns:
    """Choose position and velocity of one joint.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    derivatives : sequence of Derivative
        Columns and their derivatives.
    time : TimeColumn
        The time.
    excluded : collection of int
        Columns that are no positions.
    joint : int or None
        The joint wanted; None for the one that moves most.

    Raises
    ------
    NotEnoughData
        If no column resembles a position.
    """
    plausible = [pair for pair in derivatives if _may_be_motion(columns, pair)]
    of_joint = [pair for pair in plausible if columns.is_of(pair.position, joint)]
    of_joint = of_joint or plausible
    measured = [pair for pair in of_joint if not is_command(columns.head.names[pair.position])]
    if not measured and (not of_joint or _named_motion(columns, names.POSITION, joint)):
        return _by_position(columns, time, excluded, joint)
    consistent = [pair for pair in of_joint if not _has_two_joints(columns, pair)] or of_joint
    largest = max(consistent, key=lambda pair: pair.travel * _degrees_per_unit(pair))
    position, *other_positions = _same_motion(
        columns, largest.position, [pair.position for pair in of_joint]
    )
    pairs = [pair for pair in of_joint if pair.position == position]
    best = next((pair for pair in pairs if pair.velocity == largest.velocity), pairs[0])
    velocity, *other_velocities = _same_motion(
        columns, best.velocity, [pair.velocity for pair in pairs]
    )
    chosen = next(pair for pair in pairs if pair.velocity == velocity)
    confidence = SURE if chosen.cosine > _SURE_COSINE else LIKELY
    sign = -1.0 if chosen.units.reversed_velocity else 1.0
    velocity_unit = chosen.units.velocity or "deg/s"
    reason = f"its change is the integral of {columns.head.names[velocity]}"
    return MotionColumns(
        position=ColumnGuess(
            position,
            f"{reason} (cosine {chosen.cosine:.4f})",
            confidence,
            chosen.units.position,
            columns.alternatives(other_positions, "shows the same motion"),
        ),
        velocity=ColumnGuess(
            velocity,
            f"derivative of {columns.head.names[position]} in {velocity_unit}",
            confidence,
            velocity_unit,
            columns.alternatives(other_velocities, "is the same derivative"),
        ),
        time_unit=chosen.units.time,
        degrees=columns.head.values[position] * _degrees_per_unit(chosen),
        degrees_per_second=sign
        * columns.head.values[velocity]
        * units.FACTORS[names.VELOCITY][velocity_unit],
    )


def _may_be_motion(columns: LogColumns, pair: Derivative) -> bool:
    """Return whether the names of a pair allow it to be a position and its velocity."""
    name = columns.head.names[pair.velocity]
    return (
        columns.may_be(pair.position, names.POSITION)
        and columns.may_be(pair.velocity, names.VELOCITY)
        and not _ACCELERATION.search(name)
    )


def _named_motion(columns: LogColumns, quantity: str, joint: int | None) -> list[int]:
    """Return the changing columns whose names are known names of a quantity, of a joint if any."""
    named = [
        column
        for column, channel in columns.recognised.items()
        if channel.quantity == quantity and column in columns.head.values
    ]
    return [column for column in named if columns.is_of(column, joint)] or named


def _by_position(
    columns: LogColumns, time: TimeColumn, excluded: Collection[int], joint: int | None
) -> MotionColumns:
    """Choose a position by its name, else the smoothest column; and a velocity by its name."""
    named = _named_motion(columns, names.POSITION, joint)
    smooth = sorted(
        (
            column
            for column in columns.head.values
            if column not in excluded and columns.may_be(column, names.POSITION)
        ),
        key=lambda column: _unevenness(columns.head.values[column]),
    )
    if not named and not (smooth and _unevenness(columns.head.values[smooth[0]]) < _MAX_UNEVENNESS):
        raise NotEnoughData(
            "no column looks like a joint's position: none is the integral of another, none"
            " has such a name, and none moves smoothly in both directions; a friction test needs"
            " positions"
        )
    candidates = named or smooth
    column = max(named, key=lambda c: _travel(columns.head.values[c])) if named else candidates[0]
    values = columns.head.values[column]
    largest, span = float(np.max(np.abs(values))), float(np.ptp(values))
    possible, unit_reason = position_units.possible_position_units(
        largest=largest, span=span, on_motor=False, paths_per_angle=()
    )
    usual = position_units.usual_position_unit(largest=largest, span=span, on_motor=False)
    unit = usual if usual in possible else min(possible)
    written = unit_in_name(columns.head.names[column], names.POSITION)
    if written is not None:
        unit, unit_reason = written, ""
    elif position_units.wraps_as_of_mit_protocol([values]):
        unit, unit_reason = "rad", "wraps at ±12.5, as motors of the MIT protocol log rad"
    counts = (
        written is None
        and unit == "deg"
        and largest > _TWO_TURNS
        and position_units.are_whole([values])
    )
    if counts:
        unit_reason = f"holds whole numbers up to {largest:.4g}, as counts are"
    time_unit = possible_time_units(time)[-1]
    degrees = values * units.FACTORS[names.POSITION][unit]
    seconds = columns.head.values[time.column] * units.FACTORS[names.TIME][time_unit]
    reason = "its name says so" if named else "the smoothest column that moves in both directions"
    number = columns.joints.get(column, 1)
    others = [c for c in candidates if c != column and not columns.is_of_another(c, number)]
    with np.errstate(all="ignore"):  # times that are no clock's
        velocity, rate = None, np.gradient(degrees, seconds)
    rates = [
        c
        for c in _named_motion(columns, names.VELOCITY, joint)
        if named and columns.joints.get(c) == columns.joints.get(column)
    ]
    if rates:
        rate_unit = unit_in_name(columns.head.names[rates[0]], names.VELOCITY)
        # no velocity is logged in microdegrees per second
        rate_unit = rate_unit or ("rad/s" if unit == "rad" else "deg/s")
        rate = columns.head.values[rates[0]] * units.FACTORS[names.VELOCITY][rate_unit]
        doubt = "its name says so, though its integral is not the position's change"
        velocity = ColumnGuess(rates[0], doubt, GUESS, rate_unit)
    return MotionColumns(
        position=ColumnGuess(
            column,
            f"{reason}; {unit_reason}" if unit_reason else reason,
            LIKELY if named else GUESS,
            COUNT if counts else unit,
            columns.alternatives(others, "is the next candidate"),
        ),
        velocity=velocity,
        time_unit=time_unit,
        degrees=degrees,
        degrees_per_second=rate,
    )


def _travel(values: Array) -> float:
    """Return the travel of a position, but for jumps from one end of its range to the other."""
    steps = np.abs(np.diff(values))
    return float(np.sum(steps[steps < 0.8 * np.ptp(values)]))


def _has_two_joints(columns: LogColumns, pair: Derivative) -> bool:
    """Return whether the names of a pair have different joints, which may move alike."""
    joints = {columns.joints.get(column) for column in (pair.position, pair.velocity)}
    return len(joints) > 1


def _same_motion(columns: LogColumns, column: int, among: Sequence[int]) -> list[int]:
    """Return the columns that show the same motion as one, measured ones first."""
    values = columns.head.values
    same = [c for c in dict.fromkeys(among) if same_motion(values[column], values[c])]
    return measured_first(same, values, columns.head.names)


def _unevenness(values: Array) -> float:
    """Return the RMS of the second difference relative to that of the first difference."""
    steps = np.diff(values)
    return float(np.sqrt(np.mean(np.diff(steps) ** 2) / max(float(np.mean(steps**2)), 1e-300)))


def _degrees_per_unit(pair: Derivative) -> float:
    return units.FACTORS[names.POSITION][pair.units.position]
