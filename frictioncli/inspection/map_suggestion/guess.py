"""A guess: which column, why, how sure, and what else it may be."""

import re
from dataclasses import dataclass

SURE, LIKELY, GUESS = "sure", "likely", "a guess"

_COMMAND = re.compile(r"cmd|command|soll|target|desired|setpoint|_set\b|_ref\b|_d\b|nominal", re.I)
_DERIVED = re.compile(r"err|diff|dev|schlepp|residual|delta", re.I)


@dataclass(frozen=True, slots=True)
class Guess:
    """A column for a quantity.

    Attributes
    ----------
    column : int
        Index in the file.
    why : str
        What speaks for it.
    sure : str
        ``sure``, ``likely`` or ``a guess``.
    unit : str
        Its unit; "" where nothing tells it.
    others : tuple of (int, str)
        Other columns that it may be, with what speaks for them.
    """

    column: int
    why: str
    sure: str
    unit: str = ""
    others: tuple[tuple[int, str], ...] = ()


def is_command(name: str) -> bool:
    """Return whether a name speaks of what was asked for, not of what was measured."""
    return bool(_COMMAND.search(name))


def is_derived(name: str) -> bool:
    """Return whether a name speaks of a difference of other columns."""
    return bool(_DERIVED.search(name))
