"""The columns of a log, and what their names say of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from frictioncli.inspecting.suggesting.guess import is_command
from frictioncli.inspecting.suggesting.numbering import joint_numbers
from frictioncli.inspecting.suggesting.probe import Probe
from frictioncli.reading import aliases as names
from frictioncli.reading import units
from frictioncli.reading.channels import Channel, recognise, split_unit

OTHERS = 4
"""Alternatives that are told."""

_TORQUE_LIKE = (names.TORQUE, names.LOAD)


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a log.

    Attributes
    ----------
    found : Probe
        Their names and first values.
    known : mapping of int to Channel
        Those whose names are known.
    numbers : mapping of int to int
        Joint, from 1, of those whose names count joints.
    """

    found: Probe
    known: Mapping[int, Channel]
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


def columns_of(found: Probe, time: int) -> Columns:
    """Return the columns of a log whose time is in a column."""
    known = {channel.column: channel for channel in recognise(found.names)}
    said = {column: c.joint for column, c in known.items() if c.joint is not None}
    return Columns(found, known, joint_numbers(found.names, time) | said)


def _other_unit(name: str) -> bool:
    """Return whether a header gives a unit that is none of torque or current."""
    unit = split_unit(name)[1]
    return bool(unit) and units.canonical(unit, names.TORQUE) is None
