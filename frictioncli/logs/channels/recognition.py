"""Recognise the columns of a log by name: quantity, joint, side of the gear and unit."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from frictioncli.logs.channels.channel_names import (
    MEANINGS,
    MOTOR_TEMPERATURE,
    POSITION,
    TIME,
    TORQUE,
    TORQUE_REFERENCES,
    Meaning,
)
from frictioncli.logs.channels.column_name import (
    WORD_ENDS,
    key_of,
    key_with_joint,
    known_name,
    split_unit,
)
from frictioncli.logs.channels.named_joints import named_joints
from frictioncli.logs.channels.translated_names import in_english
from frictioncli.logs.channels.units import canonical

_JOINT_IN_FILE_NAME = re.compile(
    r"NextGenDrive#(\d{1,2})"
    r"|(?:^|[_\s-])(?:A|J|(?:axis|joint|achse|motor)[_\s-]?)(\d{1,2})$",
    re.I,
)
_AMPERE = re.compile(r"^(?P<name>.+?)(?:[_ ]in)?[_ /,]A(?:mps?)?$", re.I)
_NUMBERED_CURRENT = re.compile(r"^[iI][_ ]?(\d{1,2})$")
_CLOCK = re.compile(r"(?:^|[_ .])(?:time|timestamp|stamp|ts|zeit)$", re.I)
_DURATION = re.compile(
    r"cycle|step|delta|diff|delay|dead|settling|exec|comp|solv|process|latency|sampl|period"
    r"|duration|trip|remaining|zyklus",
    re.I,
)
"""Words in front of ``time`` in the name of a duration, not of a clock."""
_CLOCK_WITH_UNIT = re.compile(r"^(?P<name>.+)_(?P<unit>s|secs?|seconds|[mun]s|msec|usec|nsec)$")
_OF_QUATERNION = ({0, 1, 2, 3}, {1, 2, 3, 4})
_BARE_JOINT = re.compile(r"^(?:joint|axis|achse|gelenk)[ _.]?(\d{1,2})$", re.I)
_ID_COLUMN = re.compile(r"^(?:motor|joint|axis|achse|servo)[ _.]?(?:id|no|nr|number|nummer)$", re.I)


@dataclass(frozen=True, slots=True)
class LogChannel:
    """A recognised column.

    Attributes
    ----------
    column : int
        Index in the file, from 0.
    name : str
        Its name as it stands in the file.
    meaning : Meaning
        Quantity, side of the gear and rank.
    joint : int or None
        Joint number from 1; None where the name has none.
    unit : str
        Unit as written; "" where there is none.
    family : str
        The name without joint number and unit; columns of one family share their unit.
    is_merged : bool
        Whether it was merged from another file of the same trace; columns of the file itself are
        preferred.
    joint_name : str
        Name of the joint where it has one instead of a number; "" otherwise.
    """

    column: int
    name: str
    meaning: Meaning
    joint: int | None
    unit: str
    family: str
    is_merged: bool = False
    joint_name: str = ""

    @property
    def quantity(self) -> str:
        """The quantity, one of ``CHANNELS`` or ``TOOL``."""
        return self.meaning.quantity


def recognise_channels(
    columns: Sequence[str], first_merged: int | None = None
) -> tuple[LogChannel, ...]:
    """Return the columns whose names are known, in file order.

    Where a column has joint number 0, the file counts joints from 0 and all of its joint numbers
    are raised by one. Joints that have names and no numbers are numbered in file order. Of several
    columns with the same name, the first is taken.

    Parameters
    ----------
    columns : sequence of str
        Column names.
    first_merged : int, optional
        Index of the first column that was merged from another file.

    Examples
    --------
    >>> columns = ["Zeit [s]", "actual_q_0", "actual_q_1", "comment"]
    >>> [(channel.quantity, channel.joint) for channel in recognise_channels(columns)]
    [('time', None), ('position', 1), ('position', 2)]
    """
    found = _recognised_channels([in_english(column) for column in columns], first_merged)
    return tuple(replace(channel, name=columns[channel.column]) for channel in found)


def _recognised_channels(
    columns: Sequence[str], first_merged: int | None
) -> tuple[LogChannel, ...]:
    found: list[LogChannel] = []
    seen: set[str] = set()
    for index, column in enumerate(columns):
        if column in seen:
            continue
        seen.add(column)
        channel = _recognised(index, column)
        if channel is not None:
            is_merged = first_merged is not None and index >= first_merged
            found.append(replace(channel, is_merged=is_merged))
    found = _without_quaternion(_with_symbol(found))
    if not any(channel.quantity == TORQUE for channel in found):
        found += _currents_in_ampere(columns) or _numbered_currents(columns, found)
    if not any(channel.quantity == TORQUE for channel in found):
        found += _torque_references(columns)
    if not any(channel.quantity == TIME for channel in found):
        found += _clocks(columns)
    if not any(channel.quantity == POSITION for channel in found):
        found += _bare_joints(columns, {channel.column for channel in found})
    unnumbered = [channel for channel in found if channel.joint is None]
    if len(unnumbered) == len(found):
        return _with_named_joints(found, columns)
    if not any(channel.quantity == TORQUE for channel in found):
        named = _with_named_joints(unnumbered, columns)
        if len(named) > len(unnumbered):
            return named
    from_zero = any(channel.joint == 0 for channel in found)
    if not from_zero:
        return tuple(found)
    return tuple(c if c.joint is None else replace(c, joint=c.joint + 1) for c in found)


def _with_symbol(found: Sequence[LogChannel]) -> list[LogChannel]:
    """Return the channels where ``T`` beside another time is none.

    It is the temperature where there is a torque and no other temperature.
    """
    quantities = [channel.quantity for channel in found]
    if quantities.count(TIME) < 2:
        return list(found)
    if TORQUE not in quantities or MOTOR_TEMPERATURE in quantities:
        return [channel for channel in found if channel.name.strip() != "T"]
    meaning = MEANINGS["temperature"]
    return [
        replace(channel, meaning=meaning) if channel.name.strip() == "T" else channel
        for channel in found
    ]


def _without_quaternion(found: Sequence[LogChannel]) -> list[LogChannel]:
    """Return the channels without ``q0`` to ``q3`` that are no joints: an orientation has them.

    They are beside other positions: of more or fewer joints, or not each of them has a torque.
    """
    four = [one for one in found if one.quantity == POSITION and one.family == "q"]
    rest = [one for one in found if one not in four]
    numbers = {channel.joint for channel in four}
    others = {channel.joint for channel in rest if channel.quantity == POSITION}
    if numbers not in _OF_QUATERNION or not others:
        return list(found)
    are_joints = numbers <= {channel.joint for channel in rest}
    return list(found) if are_joints and (len(others) == 1 or others == numbers) else rest


def _currents_in_ampere(columns: Sequence[str]) -> list[LogChannel]:
    """Return columns such as ``current_A`` of a log without other torques; not those of phases."""
    names = {column.strip().lower() for column in columns}
    found = []
    for index, column in enumerate(columns):
        parts = _AMPERE.match(column.strip())
        known = known_name(parts["name"], "A") if parts else None
        if parts is None or known is None or known.meaning.unit != "A":
            continue
        if f"{parts['name']}_b".lower() not in names:
            found.append(LogChannel(index, column, known.meaning, known.joint, "A", known.family))
    return found


def _numbered_currents(columns: Sequence[str], found: Sequence[LogChannel]) -> list[LogChannel]:
    """Return columns such as ``i_2`` where each joint with a position ``q_2`` has one.

    Beside positions with other names they may be the inputs of a controller.
    """
    numbers = {
        index: int(parts[1])
        for index, column in enumerate(columns)
        if (parts := _NUMBERED_CURRENT.match(column.strip()))
    }
    positions = [channel for channel in found if channel.quantity == POSITION]
    joints = {channel.joint for channel in positions if channel.family.startswith("q")}
    if not joints or set(numbers.values()) != joints:
        return []
    meaning = MEANINGS["current"]
    return [LogChannel(index, columns[index], meaning, n, "", "i") for index, n in numbers.items()]


def _torque_references(columns: Sequence[str]) -> list[LogChannel]:
    """Return columns such as ``Torque Reference [%]`` of a log without measured torques."""
    found = []
    for index, column in enumerate(columns):
        name, unit = split_unit(column)
        key, joint = key_with_joint(name)
        if key in TORQUE_REFERENCES:
            found.append(LogChannel(index, column, Meaning(TORQUE, "", 4), joint, unit, key))
    return found


def _clocks(columns: Sequence[str]) -> list[LogChannel]:
    """Return columns such as ``sim_time [s]``, which are times where a log has no others."""
    found = []
    for index, column in enumerate(columns):
        name, unit = split_unit(column)
        if not unit and (parts := _CLOCK_WITH_UNIT.match(name)):
            name, unit = parts["name"], parts["unit"]
        words = WORD_ENDS.sub(" ", name)
        if unit and canonical(unit, TIME) is None:
            continue
        if _CLOCK.search(words) and not _DURATION.search(words):
            found.append(LogChannel(index, column, Meaning(TIME, rank=2), None, unit, "time"))
    return found


def _bare_joints(columns: Sequence[str], known: Collection[int]) -> list[LogChannel]:
    """Return columns such as ``Joint1``, which are positions where a log has no others."""
    found = []
    for index, column in enumerate(columns):
        name, unit = split_unit(column)
        joint = _BARE_JOINT.match(name)
        if joint is not None and index not in known:
            meaning = MEANINGS["jointposition"]
            found.append(LogChannel(index, column, meaning, int(joint[1]), unit, "joint"))
    return found


def _with_named_joints(
    found: Sequence[LogChannel], columns: Sequence[str]
) -> tuple[LogChannel, ...]:
    """Return the channels with those of joints that have names, numbered in file order."""
    parted = [split_unit(column) for column in columns]
    has_position = any(channel.quantity == POSITION for channel in found)
    named = named_joints([name for name, _ in parted], least=2 if has_position else 1)
    numbers: dict[str, int] = {}
    channels = {channel.column: channel for channel in found}
    for column, (joint, quantity) in named.items():
        if columns.index(columns[column]) < column:
            continue
        number = numbers.setdefault(joint, len(numbers) + 1)
        meaning, unit = MEANINGS[key_of(quantity)], parted[column][1]
        channels[column] = LogChannel(
            column, columns[column], meaning, number, unit, key_of(quantity), joint_name=joint
        )
    return tuple(channels[column] for column in sorted(channels))


def _recognised(index: int, column: str) -> LogChannel | None:
    name, unit = split_unit(column)
    known = known_name(name, unit)
    if known is None:
        return None
    return LogChannel(index, column, known.meaning, known.joint, unit, known.family)


def joint_in_name(stem: str) -> int | None:
    """Return the joint number in a file's name, None where it has none.

    Examples
    --------
    >>> joint_in_name("trace_NextGenDrive#3")
    3
    >>> joint_in_name("ur-20_01_22-joint_1")
    1
    """
    found = _JOINT_IN_FILE_NAME.search(stem)
    return int(found[1] or found[2]) or None if found else None


def id_column(columns: Sequence[str]) -> int | None:
    """Return the column that numbers the joint or motor of each row, None where there is none.

    Parameters
    ----------
    columns : sequence of str
        Column names.

    Examples
    --------
    >>> id_column(["time", "motor_id", "position"])
    1
    """
    matches = (i for i, name in enumerate(columns) if _ID_COLUMN.match(split_unit(name)[0]))
    return next(matches, None)
