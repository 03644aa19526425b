"""Of two columns that show the same motion: which was commanded, and which was measured."""

from collections.abc import Mapping

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.map_suggestion.guess import is_command, is_derived

_LONGEST_LAG = 20
_SAME = 0.995
_HALF = 0.5


def same_motion(one: Array, other: Array) -> bool:
    """Return whether two columns show one motion in one unit, a short lag aside."""
    reach = float(np.ptp(one))
    return reach > 0 and float(np.sqrt(np.mean((one - other) ** 2))) < (1 - _SAME) * 10 * reach


def lag(one: Array, other: Array) -> float:
    """Return by how many samples ``other`` comes after ``one``; negative where it comes before.

    Parameters
    ----------
    one, other : ndarray, shape (n,)
        Columns that show the same motion.
    """
    longest = min(_LONGEST_LAG, (len(one) - 1) // 4)
    shifts = np.arange(-longest, longest + 1)
    inner = one[longest : len(one) - longest]
    missed = np.array(
        [np.mean((other[longest + s : longest + s + len(inner)] - inner) ** 2) for s in shifts]
    )
    best = int(np.argmin(missed))
    if not 0 < best < len(shifts) - 1:
        return float(shifts[best])
    # the vertex of the parabola through the three lowest points
    left, middle, right = missed[best - 1 : best + 2]
    bend = left - 2 * middle + right
    return float(shifts[best] + (_HALF * (left - right) / bend if bend > 0 else 0.0))


def roughness(values: Array) -> float:
    """Return the size of what is unlike its neighbours: noise, or rounding."""
    return float(np.sqrt(np.mean(np.diff(values, 2) ** 2)))


def measured_first(
    columns: list[int], values: Mapping[int, Array], names: tuple[str, ...]
) -> list[int]:
    """Order columns of one motion: what was measured before what was commanded.

    A name that says so decides; else the one that comes later, as a drive follows its command; else
    the rougher one, as commands are computed.
    """
    first = columns[0]

    def rank(column: int) -> tuple[bool, bool, float, float]:
        name = names[column]
        delay = round(lag(values[first], values[column]), 1)
        return is_command(name), is_derived(name), -delay, -roughness(values[column])

    return sorted(columns, key=rank)
