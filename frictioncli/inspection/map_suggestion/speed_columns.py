"""Choose the columns of a log of one axis without position, whose velocity is integrated."""

from collections.abc import Sequence

import numpy as np

from frictioncli.inspection.map_suggestion.columns import GUESS, LIKELY, ColumnGuess, LogColumns
from frictioncli.inspection.map_suggestion.direction_dependence import direction_dependences
from frictioncli.inspection.map_suggestion.measured_or_commanded import is_command
from frictioncli.inspection.map_suggestion.telling_names import said_quantity
from frictioncli.inspection.map_suggestion.temperature_columns import guess_temperature
from frictioncli.inspection.map_suggestion.time_columns import TimeColumn, possible_time_units
from frictioncli.inspection.map_suggestion.torque_columns import guess_torque, torque_as_read
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import unit_in_name
from frictioncli.logs.channels.joint_plan import JointPlan


def columns_as_read(
    columns: LogColumns, times: Sequence[TimeColumn], plan: JointPlan
) -> tuple[dict[str, ColumnGuess], int, float]:
    """Return the columns by quantity, all known by their names, the joint, and its travel in deg.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    times : sequence of TimeColumn
        Possible times.
    plan : JointPlan
        How the log is read without a map.
    """
    rate, time = plan.channels.velocity, plan.channels.time
    guesses: dict[str, ColumnGuess | None] = {
        names.TIME: ColumnGuess(time.column, "its name says so", LIKELY, times[0].unit or "s"),
    }
    travel = 0.0
    if rate is not None:
        conversion = plan.conversions[names.VELOCITY]
        why = "its name says so; position is its integral, as the log has none"
        guesses[names.VELOCITY] = ColumnGuess(rate.column, why, LIKELY, conversion.unit)
        clock = plan.conversions[names.TIME].factor * columns.head.values[time.column]
        speed = np.abs(conversion.factor * columns.head.values.get(rate.column, 0.0 * clock))
        travel = float(np.sum(speed[1:] * np.diff(clock)))
    guesses[names.TORQUE] = torque_as_read(columns, (), plan)
    chosen = {guess.column for guess in guesses.values() if guess is not None}
    number = plan.channels.joint
    guesses[names.MOTOR_TEMPERATURE] = guess_temperature(columns, number, chosen)
    return {name: guess for name, guess in guesses.items() if guess is not None}, number, travel


def columns_of_speed(
    columns: LogColumns, times: Sequence[TimeColumn]
) -> tuple[dict[str, ColumnGuess], int, float] | None:
    """Return the columns by quantity, the joint and its travel; None where not one speed is known.

    The speed is known by its unit or a word of its name, the torque by its dependence on the
    direction of motion. With several speeds the log is that of an arm, whose load depends on its
    angles.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    times : sequence of TimeColumn
        Possible times, best first.
    """
    head, time = columns.head, times[0]
    speeds = [c for c in head.values if _is_speed(columns, c)]
    if len(speeds) != 1:
        return None
    (speed,) = speeds
    written = unit_in_name(head.names[speed], names.VELOCITY)
    time_unit = possible_time_units(time)[-1]
    rate = head.values[speed] * units.FACTORS[names.VELOCITY][written or "deg/s"]
    seconds = head.values[time.column] * units.FACTORS[names.TIME][time_unit]
    steps = np.maximum(np.diff(seconds), 0.0)
    angle = np.concatenate(([0.0], np.cumsum(steps * (rate[1:] + rate[:-1]) / 2)))
    known = frozenset({speed, *(one.column for one in times)})
    dependences = direction_dependences(head, angle, rate, known | columns.no_torque())
    torque = guess_torque(columns, dependences, 1)
    if torque is None:
        return None
    why = "its name says so; position is its integral, as the log has none"
    unsure = "" if written else "; nothing shows its unit: deg/s, rad/s or rpm"
    found = {
        names.TIME: ColumnGuess(time.column, time.reason, LIKELY, time_unit),
        names.VELOCITY: ColumnGuess(
            speed, why + unsure, LIKELY if written else GUESS, written or "deg/s"
        ),
        names.TORQUE: torque,
    }
    temperature = guess_temperature(columns, 1, known | {torque.column})
    if temperature is not None:
        found[names.MOTOR_TEMPERATURE] = temperature
    return found, 1, float(np.sum(np.abs(np.diff(angle))))


def _is_speed(columns: LogColumns, column: int) -> bool:
    name = columns.head.names[column]
    if is_command(name):
        return False
    if column in columns.recognised:
        return columns.is_named(column, names.VELOCITY)
    written = unit_in_name(name, names.VELOCITY) is not None
    return written or said_quantity(name) == names.VELOCITY
