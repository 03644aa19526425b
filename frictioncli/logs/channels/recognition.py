"""Recognise the columns of a log by name: quantity, joint, side of the gear and unit."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import (
    MEANINGS,
    MOTOR_TEMPERATURE,
    POSITION,
    TIME,
    TOOL,
    Meaning,
)
from frictioncli.logs.channels.named_joints import named_joints

_UNIT = re.compile(r"^(?P<name>.*?)[\[(](?P<unit>[^\[\]()]*)[\])]\s*$")
_UNIT_LAST = re.compile(
    r"^(?P<name>.+)[_ ](?P<unit>mNm|Nm|mA|degC|deg|rad|(?:deg|rad)[_/]?s|dps|rpm|ms|us|ns)$"
)
_JOINT_LAST = re.compile(
    r"^(?P<name>.*?)(?:(?<=[a-z])[AJ]|(?<![ _.\-(\[])[ _.\-(\[]+[AaJj]?[ _]?|)"
    r"(?P<joint>\d{1,2})[)\]]?$"
)
_JOINT_FIRST = re.compile(
    r"^(?:joint|axis|axle|achse|gelenk|motor|[aj])[ _.]?(?P<joint>\d{1,2})[ _.\-]+(?P<name>.+)$",
    re.I,
)
_MEASURED = re.compile(
    r"(?:^|(?<=[ _.\-]))(?:feedback|fbk|fb|actual|act|measured|meas|ist|value|averaged|average|avg)"
    r"(?=$|[ _.\-])",
    re.I,
)
_NO_KEY = re.compile(r"[^a-z0-9]")
_JOINT_IN_BRACKETS = re.compile(r"^[AaJj]?\d{1,2}$")
_JOINT_IN_FILE_NAME = re.compile(
    r"NextGenDrive#(\d{1,2})"
    r"|(?:^|[_\s-])(?:A|J|(?:axis|joint|achse|motor)[_\s-]?)(\d{1,2})$",
    re.I,
)
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


def split_unit(column: str) -> tuple[str, str]:
    """Return a column's name without its unit, and the unit as written ("" where there is none).

    Units stand in brackets, or are the last word of the name.

    Examples
    --------
    >>> split_unit("AxisPos_Act1 [deg]")
    ('AxisPos_Act1', 'deg')
    >>> split_unit("tau_mNm")
    ('tau', 'mNm')
    >>> split_unit("q(2)")
    ('q(2)', '')
    """
    bare = column.strip().strip('"')
    found = _UNIT.match(bare) or _UNIT_LAST.match(bare)
    if found is None or _JOINT_IN_BRACKETS.match(found["unit"].strip()):
        return bare, ""
    name, unit = found["name"].rstrip(), found["unit"].strip()
    if unit in ("x", "y", "z", "rx", "ry", "rz"):  # an axis of a coordinate frame, not a unit
        return f"{name} {unit}", ""
    return name, unit


def unit_in_name(column: str, quantity: str) -> str | None:
    """Return the unit of a quantity that a column's name has in brackets, None where it has none.

    Examples
    --------
    >>> unit_in_name("pos_estimate [turns]", "position")
    'turn'
    """
    return units.canonical(split_unit(column)[1], quantity)


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
    if not any(channel.quantity == POSITION for channel in found):
        found += _bare_joints(columns, {channel.column for channel in found})
    if all(channel.joint is None for channel in found):
        return _with_named_joints(found, columns)
    from_zero = any(channel.joint == 0 for channel in found)
    if not from_zero:
        return tuple(found)
    return tuple(c if c.joint is None else replace(c, joint=c.joint + 1) for c in found)


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
    named = named_joints([name for name, _ in parted])
    numbers: dict[str, int] = {}
    channels = {channel.column: channel for channel in found}
    for column, (joint, quantity) in named.items():
        number = numbers.setdefault(joint, len(numbers) + 1)
        meaning, unit = MEANINGS[_key(quantity)], parted[column][1]
        channels[column] = LogChannel(
            column, columns[column], meaning, number, unit, _key(quantity), joint_name=joint
        )
    return tuple(channels[column] for column in sorted(channels))


def _recognised(index: int, column: str) -> LogChannel | None:
    name, unit = split_unit(column)
    texts = _candidate_names(name)
    # words that only say that a value was measured, where the name is not known with them
    plain = [" ".join(_MEASURED.sub("", text).replace("_", " ").split()) for text in texts]
    known = _of_names(index, column, texts, unit)
    known = known or _of_names(index, column, [text for text in plain if text], unit)
    if known is not None and known.quantity == TIME and _is_temperature(unit):
        return replace(known, meaning=MEANINGS["temperature"])
    return known


def _is_temperature(unit: str) -> bool:
    """Return whether a unit is one of temperature: ``T [°C]`` is no time."""
    return bool(unit) and units.canonical(unit, MOTOR_TEMPERATURE) is not None


def _of_names(index: int, column: str, texts: Sequence[str], unit: str) -> LogChannel | None:
    """Return the channel that the first known one of several spellings of a name stands for."""
    for text in texts:
        meaning = MEANINGS.get(_key(text))
        if meaning is not None:
            return LogChannel(index, column, meaning, None, unit, _key(text))
        for pattern in (_JOINT_FIRST, _JOINT_LAST):
            parts = pattern.match(text)
            meaning = MEANINGS.get(_key(parts["name"])) if parts else None
            if parts and meaning and meaning.quantity not in (TIME, TOOL):
                joint = int(parts["joint"])
                return LogChannel(index, column, meaning, joint, unit, _key(parts["name"]))
    return None


def _candidate_names(name: str) -> tuple[str, ...]:
    """Return a name, or of a ROS topic such as ``/joints/joint_2/position`` its last parts."""
    if not name.startswith("/"):
        return (name,)
    parts = name.split("/")
    return "_".join(parts[-2:]), parts[-1]


def _key(name: str) -> str:
    """Return a name as a key of :data:`MEANINGS`."""
    lower = name.lower().replace("ä", "ae").replace("ö", "oe").replace("ü", "ue")
    return _NO_KEY.sub("", lower.replace("ß", "ss"))


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
