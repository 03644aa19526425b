"""Find the column of torque or current: it depends on the direction of motion."""

from collections.abc import Sequence

import numpy as np

from frictioncli.inspection.map_suggestion.columns import (
    GUESS,
    LIKELY,
    MAX_ALTERNATIVES,
    SURE,
    ColumnGuess,
    LogColumns,
)
from frictioncli.inspection.map_suggestion.direction_dependence import DirectionDependence
from frictioncli.inspection.map_suggestion.measured_or_commanded import (
    is_command,
    is_computed,
    is_derived,
    roughness,
)
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import unit_in_name
from frictioncli.logs.channels.joint_plan import JointPlan

_LEAST_GRAVITY = 0.5
"""Least share of variance that the angle explains in a load beside a current."""
_NEARLY = 0.9
"""Columns that agree so well show the same quantity."""
_SURE_SHARE = 0.5
_CURRENT_WORDS = ("curr", "strom", "amp", "i_")


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
    if confidence == GUESS:
        others += [
            one.column
            for one in dependences
            if one.explained > _SURE_SHARE
            and one.column not in (torque.column, *others)
            and not columns.is_of_another(one.column, plan.channels.joint)
            and not _not_measured(columns.head.names[one.column])
        ]
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


def _not_measured(name: str) -> str:
    """Return what a torque is by its name where it was not measured; "" otherwise."""
    if is_command(name):
        return "a command by its name"
    if is_derived(name):
        return "a difference by its name"
    return "that of a model by its name" if is_computed(name) else ""


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
            bool(_not_measured(columns.head.names[one.column])),
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
    unlike = _not_measured(columns.head.names[best.column])
    if unlike:
        reason += f"; {unlike}: name the measured one if there is one"
    elif ranked:
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
    unlike = _not_measured(columns.head.names[first.column])
    if columns.is_named(first.column, names.TORQUE):
        return first
    same = [
        one
        for one in ranked
        if not columns.is_named(one.column, names.TORQUE)
        and one.explained > _NEARLY * first.explained
        and _not_measured(columns.head.names[one.column]) == unlike
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
