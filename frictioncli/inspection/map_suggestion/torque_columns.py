"""Find the column of torque or current: it depends on the direction of motion."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.map_suggestion.columns import (
    GUESS,
    LIKELY,
    MAX_ALTERNATIVES,
    SURE,
    ColumnGuess,
    LogColumns,
)
from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.inspection.map_suggestion.measured_or_commanded import (
    is_command,
    is_derived,
    roughness,
)
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import unit_in_name
from frictioncli.logs.channels.joint_plan import JointPlan

_LEAST_SPEED = 0.1
"""Least speed of a moving joint, as a share of the highest speed."""
_LEAST_SAMPLES = 20
_LEAST_EXPLAINED = 0.05
"""Least share of variance that the direction explains in a torque."""
_LEAST_GRAVITY = 0.5
"""Least share of variance that the angle explains in a load."""
_NEARLY = 0.9
"""Columns that agree so well show the same quantity."""
_SURE_SHARE = 0.5
_CURRENT_WORDS = ("curr", "strom", "amp", "i_")


@dataclass(frozen=True, slots=True)
class DirectionDependence:
    """Dependence of a column on the direction of motion.

    Attributes
    ----------
    column : int
        Index in the file.
    explained : float
        Share of the variance left by gravity that direction and velocity explain. [-]
    jump : float
        Half the difference between the two directions. [raw]
    by_angle : float
        Share of the total variance that gravity explains. [-]
    """

    column: int
    explained: float
    jump: float
    by_angle: float

    @property
    def is_significant(self) -> bool:
        """Whether the column depends on the direction."""
        return self.explained > _LEAST_EXPLAINED

    @property
    def is_load(self) -> bool:
        """Whether the column depends on the angle and not on the direction, as a load does."""
        return not self.is_significant and self.by_angle > _LEAST_GRAVITY


def direction_dependences(
    head: LogHead, position: Array, velocity: Array, excluded: Collection[int]
) -> list[DirectionDependence]:
    """Return how much each column depends on the direction of motion, in descending order.

    Two linear regressions are compared: on gravity (a constant, sine and cosine of the angle), and
    on gravity, the sign of velocity and velocity.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    position : ndarray, shape (n,)
        The joint's position. [deg]
    velocity : ndarray, shape (n,)
        The joint's velocity. [deg/s]
    excluded : collection of int
        Columns that are no torque: times, positions, velocities.
    """
    speed = np.abs(velocity)
    moving = speed > _LEAST_SPEED * float(np.max(speed, initial=0.0))
    if np.count_nonzero(moving) < _LEAST_SAMPLES:
        return []
    angle = np.radians(position[moving])
    ones = np.ones(len(angle))
    gravity = np.stack([ones, np.sin(angle), np.cos(angle)], axis=1)
    direction = np.stack([np.sign(velocity[moving]), velocity[moving]], axis=1)
    both = np.concatenate([gravity, direction], axis=1)
    found = []
    for column, all_values in head.values.items():
        if column in excluded:
            continue
        values = all_values[moving]
        without_direction = _mean_squared_residual(gravity, values)
        with_direction = _mean_squared_residual(both, values)
        variance = float(np.var(values))
        if variance <= 0 or without_direction <= 0:
            continue
        signed = np.column_stack([gravity, direction[:, 0]])
        jump = float(np.linalg.lstsq(signed, values, rcond=None)[0][-1])
        explained = 1 - with_direction / without_direction
        by_angle = max(1 - without_direction / variance, 0.0)
        found.append(DirectionDependence(column, explained, jump, by_angle))
    return sorted(found, key=lambda one: -one.explained)


def _mean_squared_residual(regressors: Array, values: Array) -> float:
    """Return the mean squared residual of a linear regression."""
    coefficients = np.linalg.lstsq(regressors, values, rcond=None)[0]
    return float(np.mean((values - regressors @ coefficients) ** 2))


def torque_as_read(
    columns: LogColumns, dependences: Sequence[DirectionDependence], plan: JointPlan
) -> ColumnGuess | None:
    """Return the torque that is read without a map: one decision for both.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    dependences : sequence of DirectionDependence
        Result of :func:`direction_dependences`.
    plan : JointPlan
        How the log is read without a map.

    Returns
    -------
    ColumnGuess or None
        None where that torque stands in another file.
    """
    torque = plan.channels.torque
    if torque.is_merged or torque.column not in columns.head.values:
        return None
    by_column = {one.column: one for one in dependences}
    own = by_column.get(torque.column)
    reason, confidence = "its name says so", LIKELY
    if own is not None and own.is_significant:
        reason = _reason(own)
        confidence = SURE if own.explained > _SURE_SHARE else LIKELY
    elif own is not None:
        reason, confidence = f"{reason}, but it does not change with the direction of motion", GUESS
    others = [channel.column for channel in plan.channels.other_torques if not channel.is_merged]
    alternatives = tuple(
        (column, _opposes(by_column[column]) if column in by_column else "by its name")
        for column in others[:MAX_ALTERNATIVES]
        if column in columns.head.values
    )
    return ColumnGuess(
        torque.column,
        f"{reason}; it is also read without a map",
        confidence,
        plan.conversions[names.TORQUE].unit,
        alternatives,
    )


def load_as_read(columns: LogColumns, plan: JointPlan) -> ColumnGuess | None:
    """Return the load that is read without a map, None where there is none.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    plan : JointPlan
        How the log is read without a map.
    """
    load = plan.channels.load
    if load is None or load.is_merged or load.column not in columns.head.values:
        return None
    reason = "the load read with that torque when there is no map"
    return ColumnGuess(load.column, reason, LIKELY, plan.conversions[names.LOAD].unit)


def _reason(one: DirectionDependence) -> str:
    return (
        f"differs by twice {one.jump:.3g} between the directions, which explains"
        f" {100 * one.explained:.0f} % of what the angle does not"
    )


def _opposes(one: DirectionDependence) -> str:
    return f"opposes motion too, by {one.jump:.3g}"


def guess_torque(
    columns: LogColumns, dependences: Sequence[DirectionDependence], joint: int
) -> ColumnGuess | None:
    """Choose the column of a joint that depends most on the direction of motion.

    Measured values and columns named as a torque are preferred.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    dependences : sequence of DirectionDependence
        Result of :func:`direction_dependences`.
    joint : int
        The joint, from 1.
    """
    usable = [one for one in dependences if not columns.is_of_another(one.column, joint)]
    named = [one for one in usable if columns.is_named(one.column, names.TORQUE)]
    ranked = sorted(
        (one for one in usable if one.is_significant),
        key=lambda one: (
            is_command(columns.head.names[one.column])
            or is_derived(columns.head.names[one.column]),
            not columns.is_named(one.column, names.TORQUE),
            -one.explained,
        ),
    )
    if not ranked and not named:
        return None
    best = _measured(columns, ranked) if ranked else named[0]
    reason = (
        _reason(best)
        if ranked
        else "its name says so, but it does not change with the direction of motion"
    )
    confidence = GUESS
    if ranked:
        confidence = SURE if best.explained > _SURE_SHARE else LIKELY
    others = [one for one in (ranked or named) if one.column != best.column]
    alternatives = tuple((one.column, _opposes(one)) for one in others[:MAX_ALTERNATIVES])
    unit = _torque_unit(columns, best.column)
    return ColumnGuess(best.column, reason, confidence, unit, alternatives)


def _measured(columns: LogColumns, ranked: Sequence[DirectionDependence]) -> DirectionDependence:
    """Return the first column, or of unnamed ones that say the same the roughest.

    A measured value is rougher than the one that was computed for it.
    """
    first = ranked[0]
    values = columns.head.values[first.column]
    if columns.is_named(first.column, names.TORQUE):
        return first
    same = [
        one
        for one in ranked
        if not columns.is_named(one.column, names.TORQUE)
        and one.explained > _NEARLY * first.explained
        and np.corrcoef(values, columns.head.values[one.column])[0, 1] > _NEARLY
    ]

    def relative_roughness(one: DirectionDependence) -> float:
        column = columns.head.values[one.column]
        return roughness(column) / float(np.std(column))

    return max([first, *same], key=relative_roughness)


def guess_load(
    columns: LogColumns, dependences: Sequence[DirectionDependence], joint: int, torque: int
) -> ColumnGuess | None:
    """Choose a column named as a torque that depends on the angle and not on the direction.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    dependences : sequence of DirectionDependence
        Result of :func:`direction_dependences`.
    joint : int
        The joint, from 1.
    torque : int
        The column chosen as torque.
    """
    chosen = next((one for one in dependences if one.column == torque), None)
    beside_current = _torque_unit(columns, torque) in ("A", "mA")
    for one in dependences:
        # beside a current, a torque that the controller has freed of most friction
        freed = (
            beside_current
            and chosen is not None
            and (one.by_angle > _LEAST_GRAVITY and one.explained < chosen.explained)
        )
        is_named = any(columns.is_named(one.column, name) for name in (names.TORQUE, names.LOAD))
        commanded = is_command(columns.head.names[one.column])
        if one.column == torque or not is_named or commanded or not (one.is_load or freed):
            continue
        if (
            not columns.is_of_another(one.column, joint)
            and _torque_unit(columns, one.column) == "N·m"
        ):
            reason = (
                f"depends on the angle ({100 * one.by_angle:.0f} %), hardly on the direction: a"
                " load without friction"
            )
            return ColumnGuess(one.column, reason, LIKELY, "N·m")
    return None


def _torque_unit(columns: LogColumns, column: int) -> str:
    """Return the unit of a torque column by its header, else A or N·m by its name."""
    channel = columns.recognised.get(column)
    name = columns.head.names[column].lower()
    known = "" if channel is None else channel.meaning.unit
    unit = unit_in_name(columns.head.names[column], names.TORQUE)
    unit = unit or units.canonical(known, names.TORQUE)
    if unit is not None:
        return unit
    return "A" if any(word in name for word in _CURRENT_WORDS) else "N·m"
