"""The columns of a log, and what their names say of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from frictioncli.inspection.map_suggestion.guess import is_command
from frictioncli.inspection.map_suggestion.numbering import joint_numbers
from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels, split_unit

OTHERS = 4
"""Alternatives that are told."""

_TORQUE_LIKE = (names.TORQUE, names.LOAD)


@dataclass(frozen=True, slots=True)
class LogColumns:
    """The columns of a log.

    Attributes
    ----------
    found : Probe
        Their names and first values.
    known : mapping of int to LogChannel
        Those whose names are known.
    numbers : mapping of int to int
        Joint, from 1, of those whose names count joints.
    """

    found: Probe
    known: Mapping[int, LogChannel]
    numbers: Mapping[int, int]

    def is_of(self, column: int, joint: int | None) -> bool:
        """Return whether a name says that a column is of a joint; None is any joint."""
        return joint is None or self.numbers.get(column) == joint

    def is_of_another(self, column: int, joint: int) -> bool:
        """Return whether a name says that a column is of another joint."""
        return self.numbers.get(column, joint) != joint

    def says(self, column: int, quantity: str) -> bool:
        """Return whether a name is known for a quantity."""
        channel = self.known.get(column)
        return channel is not None and channel.quantity == quantity

    def no_torque(self) -> frozenset[int]:
        """Return the columns that are no torque by name or unit."""
        other = {c for c, channel in self.known.items() if channel.quantity not in _TORQUE_LIKE}
        return frozenset(other | {c for c, n in enumerate(self.found.names) if _other_unit(n)})

    def told(self, columns: Sequence[int], why: str) -> tuple[tuple[int, str], ...]:
        """Return columns as alternatives, those that are commands by their names marked."""
        return tuple(
            (c, f"{why}, a command by its name" if is_command(self.found.names[c]) else why)
            for c in columns[:OTHERS]
        )


def columns_of(found: Probe, time: int) -> LogColumns:
    """Return the columns of a log whose time is in a column."""
    known = {channel.column: channel for channel in recognise_channels(found.names)}
    said = {column: c.joint for column, c in known.items() if c.joint is not None}
    return LogColumns(found, known, joint_numbers(found.names, time) | said)


def _other_unit(name: str) -> bool:
    """Return whether a header gives a unit that is none of torque or current."""
    unit = split_unit(name)[1]
    return bool(unit) and units.canonical(unit, names.TORQUE) is None
