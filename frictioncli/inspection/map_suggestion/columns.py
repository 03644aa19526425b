"""The columns of a log with what their names say, and the suggestion of a column."""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.inspection.map_suggestion.measured_or_commanded import is_command
from frictioncli.inspection.map_suggestion.telling_names import may_mean
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels

SURE, LIKELY, GUESS = "sure", "likely", "a guess"

COUNT = "count"
"""Unit of a column that counts, whose size the user has to give."""

MAX_ALTERNATIVES = 4
"""Most alternatives that are named for a quantity."""

_TORQUE_LIKE = (names.TORQUE, names.LOAD)
_NAMED_JOINT = re.compile(
    r"(?:^|[_\W])(?:A|J|ax|axis|joint|achse|gelenk)_?(\d{1,2})(?:$|[_\W])", re.I
)
_WITHOUT_NAME = re.compile(r"column \d+$")
_LAST_NUMBER = re.compile(r"^(.*?)(\d{1,2})(\D*)$")


@dataclass(frozen=True, slots=True)
class ColumnGuess:
    """The column suggested for a quantity.

    Attributes
    ----------
    column : int
        Index in the file.
    reason : str
        The evidence for it.
    confidence : str
        ``sure``, ``likely`` or ``a guess``.
    unit : str
        Its unit; "" where it is unknown.
    alternatives : tuple of (int, str)
        Other possible columns with the evidence for them.
    """

    column: int
    reason: str
    confidence: str
    unit: str = ""
    alternatives: tuple[tuple[int, str], ...] = ()


@dataclass(frozen=True, slots=True)
class LogColumns:
    """The columns of a log.

    Attributes
    ----------
    head : LogHead
        Their names and first values.
    recognised : mapping of int to LogChannel
        Columns with known names.
    joints : mapping of int to int
        Joint number from 1, of columns whose names have one.
    """

    head: LogHead
    recognised: Mapping[int, LogChannel]
    joints: Mapping[int, int]

    def is_of(self, column: int, joint: int | None) -> bool:
        """Return whether a column is of a joint by its name; None stands for any joint."""
        return joint is None or self.joints.get(column) == joint

    def is_of_another(self, column: int, joint: int) -> bool:
        """Return whether a column is of another joint by its name."""
        return self.joints.get(column, joint) != joint

    def is_named(self, column: int, quantity: str) -> bool:
        """Return whether a column's name is a known name of a quantity."""
        channel = self.recognised.get(column)
        return channel is not None and channel.quantity == quantity

    def may_be(self, column: int, quantity: str) -> bool:
        """Return whether a column's name does not say that it is another quantity."""
        channel = self.recognised.get(column)
        if channel is None:
            return may_mean(self.head.names[column], quantity)
        return channel.quantity == quantity

    def no_torque(self) -> frozenset[int]:
        """Return the columns that are no torque by name or unit."""
        other = {
            c for c, channel in self.recognised.items() if channel.quantity not in _TORQUE_LIKE
        }
        unlike = {
            c
            for c, name in enumerate(self.head.names)
            if _has_other_unit(name) or not (c in self.recognised or self.may_be(c, names.TORQUE))
        }
        return frozenset(other | unlike)

    def alternatives(self, columns: Sequence[int], reason: str) -> tuple[tuple[int, str], ...]:
        """Return columns with the evidence for them, which mentions commands."""
        return tuple(
            (c, f"{reason}, a command by its name" if is_command(self.head.names[c]) else reason)
            for c in columns[:MAX_ALTERNATIVES]
        )


def log_columns(head: LogHead, time: int) -> LogColumns:
    """Return the columns of a log.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    time : int
        Column of the time.
    """
    recognised = {channel.column: channel for channel in recognise_channels(head.names)}
    by_name = {column: c.joint for column, c in recognised.items() if c.joint is not None}
    return LogColumns(head, recognised, joints_by_number(head.names, time) | by_name)


def joints_by_number(column_names: Sequence[str], time: int) -> dict[int, int]:
    """Return the joint of each column whose name counts joints, also of unknown names.

    Names that differ only in their last number form a family. A family that contains the time, as
    ``c1`` to ``c9`` may, does not count joints. If one family counts from 0, all do.

    Parameters
    ----------
    column_names : sequence of str
        All column names.
    time : int
        Column of the time.

    Returns
    -------
    dict of int to int
        Joint number from 1 by column.

    Examples
    --------
    >>> joints_by_number(["t", "winkel_0", "winkel_1", "strom"], 0)
    {1: 1, 2: 2}
    """
    # columns without names are numbered, and their numbers are no joints
    if all(_WITHOUT_NAME.match(name) for name in column_names if _LAST_NUMBER.match(name.strip())):
        return {}
    families: dict[tuple[str, str], dict[int, int]] = defaultdict(dict)
    for column, name in enumerate(column_names):
        parts = _LAST_NUMBER.match(name.strip())
        if parts:
            families[parts[1], parts[3]][column] = int(parts[2])
    counting = [family for family in families.values() if len(family) > 1 and time not in family]
    named = {
        column: int(found[1])
        for column, name in enumerate(column_names)
        if (found := _NAMED_JOINT.search(name)) and column != time
    }
    counted = {c: number for family in counting for c, number in family.items()} | named
    base = 0 if 0 in counted.values() else 1
    return {c: number + 1 - base for c, number in counted.items()}


def _has_other_unit(name: str) -> bool:
    """Return whether a name has a unit that is not one of torque or current."""
    unit = split_unit(name)[1]
    return bool(unit) and units.canonical(unit, names.TORQUE) is None
