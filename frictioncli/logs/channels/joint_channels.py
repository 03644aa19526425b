"""Choose the columns that are used for each joint of a log."""

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

from frictioncli.logs.channels.channel_names import (
    HOUSING_TEMPERATURE,
    LOAD,
    MOTOR_SIDE,
    MOTOR_TEMPERATURE,
    PAYLOAD,
    POSITION,
    TIME,
    TORQUE,
    TORQUE_REFERENCES,
    VELOCITY,
)
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.log_source import Refusal
from frictioncli.plain_text import printable

_LIKE_TEMPERATURE = re.compile(r"temp|celsius|kelvin|°c|degc|^t[ _.\-]", re.I)
_SHOWN = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class JointChannels:
    """The columns used for one joint of a file.

    Attributes
    ----------
    joint : int
        Joint number, from 1.
    time, position, torque : LogChannel
        Columns that every joint has.
    velocity : LogChannel or None
        Measured on either side of the gear.
    other_position : LogChannel or None
        Position on the other side of the gear; the two positions determine the gear ratio.
    motor_temperature, housing_temperature, load, payload : LogChannel or None
        Further columns.
    other_torques : tuple of LogChannel
        Further torques and motor currents.
    notes : tuple of str
        Columns and joints that are not used.
    warnings : tuple of str
        What speaks against the columns.
    """

    joint: int
    time: LogChannel
    position: LogChannel
    torque: LogChannel
    velocity: LogChannel | None = None
    other_position: LogChannel | None = None
    motor_temperature: LogChannel | None = None
    housing_temperature: LogChannel | None = None
    load: LogChannel | None = None
    payload: LogChannel | None = None
    other_torques: tuple[LogChannel, ...] = ()
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def assign_channels(
    channels: Sequence[LogChannel],
    columns: Sequence[str],
    *,
    joints: tuple[int, ...] | None,
    file_joint: int,
) -> tuple[JointChannels, ...] | Refusal:
    """Choose the columns for each joint.

    Parameters
    ----------
    channels : sequence of LogChannel
        The recognised columns.
    columns : sequence of str
        All column names, for the text of a refusal.
    joints : tuple of int or None
        The joints wanted; None for every joint with a torque channel.
    file_joint : int
        The joint of columns whose names have no joint number.

    Returns
    -------
    tuple of JointChannels or Refusal
        Refused as ``no_torque_channel``, ``no_position_channel`` or ``no_time_channel``.

    Examples
    --------
    >>> columns = ["Zeit [s]", "q_1 [rad]", "current_1 [A]", "torque_1 [Nm]"]
    >>> from frictioncli.logs.channels.recognition import recognise_channels
    >>> channels = recognise_channels(columns)
    >>> (found,) = assign_channels(channels, columns, joints=None, file_joint=1)
    >>> found.joint, found.position.name, found.torque.name
    (1, 'q_1 [rad]', 'torque_1 [Nm]')
    """
    times = _by_preference(channels, TIME)
    torques = _by_preference(channels, TORQUE)
    with_torque = {file_joint if c.joint is None else c.joint for c in torques}
    wanted = sorted(with_torque if joints is None else with_torque & set(joints))
    if not wanted and joints is not None and with_torque:
        return Refusal(
            "no_torque_channel",
            f"no joint {', '.join(map(str, joints))}; there are torque channels of joint"
            f" {', '.join(map(str, sorted(with_torque)))}",
        )
    if not wanted:
        which = "" if joints is None else f" of joint {', '.join(map(str, joints))}"
        return _missing("torque", which, channels, columns)
    single = len(with_torque | {c.joint for c in channels if c.joint is not None}) == 1
    chosen: list[JointChannels] = []
    for joint in wanted:
        of_joint = [c for c in channels if c.joint == joint]
        of_joint += [c for c in channels if c.joint is None and (single or joint == file_joint)]
        usable = of_joint + [c for c in channels if c.joint is None and c not in of_joint]
        positions = _by_preference(of_joint, POSITION)
        if positions and times:
            chosen.append(_joint_channels(joint, times[0], positions, of_joint, usable))
    if chosen:
        lacking = sorted({*(joints or ()), *wanted} - {found.joint for found in chosen})
        notes = [f"joint {joint}: no position and torque channel" for joint in lacking]
        if not any(one.motor_temperature or one.housing_temperature for one in chosen):
            notes += _unread_temperatures(channels, columns)
        first = replace(
            chosen[0],
            notes=(*chosen[0].notes, *notes),
            warnings=_of_the_same_name(channels, columns),
        )
        return first, *chosen[1:]
    if not times:
        return _missing("time", "", channels, columns)
    return _missing("position", f" of joint {', '.join(map(str, wanted))}", channels, columns)


def _of_the_same_name(channels: Sequence[LogChannel], columns: Sequence[str]) -> tuple[str, ...]:
    """Return a warning of columns that are read while later ones have the same name."""
    again = [c.name for c in channels if c.name in columns[c.column + 1 :]]
    if not again:
        return ()
    shown = ", ".join(map(printable, again[:_SHOWN]))
    return (
        f"several columns are named {shown}: the first is read; rename them, or give numbers"
        " with --map",
    )


def _unread_temperatures(channels: Sequence[LogChannel], columns: Sequence[str]) -> list[str]:
    """Return a note on columns that may be temperatures and whose names are not known."""
    known = {channel.column for channel in channels}
    names = [name for number, name in enumerate(columns) if name and number not in known]
    like = [printable(name) for name in names if _LIKE_TEMPERATURE.search(name)]
    if not like:
        return []
    shown = ", ".join(like[:_SHOWN]) + (f", ... ({len(like)} in all)" if len(like) > _SHOWN else "")
    return [
        f"no temperature is read; not used: {shown}; if one is that of the motor or the housing,"
        " name it with --map (motor_temperature or housing_temperature)"
    ]


def _joint_channels(
    joint: int,
    time: LogChannel,
    positions: list[LogChannel],
    of_joint: Sequence[LogChannel],
    usable: Sequence[LogChannel],
) -> JointChannels:
    """Return the columns of a joint; ``usable`` ones without a joint number may be of all joints.

    They are temperatures, and the payload.
    """
    torques = _by_preference(of_joint, TORQUE)
    position = min(positions, key=lambda c: (c.is_merged, c.meaning.side == MOTOR_SIDE))
    other_position = _first([c for c in positions if c.meaning.side != position.meaning.side])
    velocities = _by_preference(of_joint, VELOCITY)
    same_side = [c for c in velocities if c.meaning.side == position.meaning.side]
    notes = [f"joint {joint} is {position.joint_name}"] if position.joint_name else []
    alike = [c for c in positions if c.meaning.side == position.meaning.side and c != position]
    if alike and not alike[0].is_merged:
        others = ", ".join(printable(c.name) for c in alike)
        notes.append(f"position of joint {joint} is {position.name}; not used: {others}")
    if torques[0].family in TORQUE_REFERENCES:
        notes.append(
            f"{printable(torques[0].name)} is what the drive asks of its motor: taken as its torque"
        )
    if len(torques) > 1:
        others = ", ".join(c.name for c in torques[1:])
        notes.append(f"torque of joint {joint} is {torques[0].name}; not used: {others}")
    return JointChannels(
        joint=joint,
        time=time,
        position=position,
        torque=torques[0],
        velocity=_first(same_side or (velocities if other_position else [])),
        other_position=other_position,
        motor_temperature=_first(_by_preference(usable, MOTOR_TEMPERATURE)),
        housing_temperature=_first(_by_preference(usable, HOUSING_TEMPERATURE)),
        load=_first(_by_preference(of_joint, LOAD)),
        payload=_first(_by_preference(usable, PAYLOAD)),
        other_torques=tuple(torques[1:]),
        notes=tuple(notes),
    )


def _by_preference(channels: Iterable[LogChannel], quantity: str) -> list[LogChannel]:
    """Return the channels of a quantity, preferred ones first."""
    return sorted(
        (c for c in channels if c.quantity == quantity),
        key=lambda c: (c.is_merged, c.meaning.rank, c.column),
    )


def _first(channels: Sequence[LogChannel]) -> LogChannel | None:
    return channels[0] if channels else None


def _missing(
    what: str, which: str, channels: Sequence[LogChannel], columns: Sequence[str]
) -> Refusal:
    quantities: Collection[str] = {c.quantity for c in channels}
    lacking = [name for name in (TIME, POSITION, TORQUE) if name not in quantities] or [what]
    named = [printable(column) for column in columns if column]
    shown = ", ".join(named[:12]) + (f", ... ({len(named)} in all)" if len(named) > 12 else "")
    advice = (
        "; for rows without a time give their period in s in the mapping file: [csv] period = 0.005"
    )
    return Refusal(
        f"no_{what}_channel",
        f"no {' and no '.join(lacking)} channel{which} found; columns found: {shown}; a friction"
        " test needs time, position and torque (or motor current): name them with --map, of which"
        " 'frictioncli inspect LOGS --suggest-map' writes a first one" + advice * (TIME in lacking),
    )
