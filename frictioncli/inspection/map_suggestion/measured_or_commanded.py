"""Which of several columns with the same motion was measured, and which was commanded."""

import re
from collections.abc import Mapping

import numpy as np

from frictioncli.arrays import Array

_COMMAND = re.compile(
    r"cmd|command|soll|target|desired|setpoint|_set\b|_d\b|nominal|goal"
    r"|(?<![a-z])(?:ref|des|reference)(?![a-z])",
    re.I,
)
_COMMAND_LAST = re.compile(r"[a-z](?:Ref|Reference|Des|Set)(?![a-z])")
_DERIVED = re.compile(r"err|diff|dev|schlepp|residual|delta", re.I)
_COMPUTED = re.compile(
    r"(?<![a-z])(?:ext|external|grav|gravity|model|dyn|dynamics|fric|friction|comp|ff|feedforward"
    r"|coriolis|inertia)(?![a-z])|(?<=[a-z])(?:Ext|External|Grav|Gravity|Model|Fric|Friction|FF)"
    r"(?![a-z])|(?<![a-zA-Z])(?:Ext|External|Gravity|Model|Friction)(?=[A-Z])"
)
_MAX_LAG = 20
"""Longest lag between two columns. [samples]"""
_SAME = 0.995
_HALF = 0.5


def is_command(name: str) -> bool:
    """Return whether a column is a commanded value by its name.

    Examples
    --------
    >>> is_command("AxisPos_Soll_A1"), is_command("AxisPos_Ist_A1")
    (True, False)
    """
    return bool(_COMMAND.search(name) or _COMMAND_LAST.search(name))


def is_derived(name: str) -> bool:
    """Return whether a column is a difference of other columns by its name."""
    return bool(_DERIVED.search(name))


def is_computed(name: str) -> bool:
    """Return whether a torque is one that a model gives, or what it leaves, by its name.

    Examples
    --------
    >>> is_computed("tau_ext_1"), is_computed("ExtTorque_A1"), is_computed("torque_1")
    (True, True, False)
    """
    return bool(_COMPUTED.search(name))


def same_motion(one: Array, other: Array) -> bool:
    """Return whether two columns show the same motion in the same unit, except for a short lag.

    Parameters
    ----------
    one, other : ndarray, shape (n,)
        The columns.
    """
    span = float(np.ptp(one))
    return span > 0 and float(np.sqrt(np.mean((one - other) ** 2))) < (1 - _SAME) * 10 * span


def lag(one: Array, other: Array) -> float:
    """Return the lag of one column behind another with the same motion.

    It is the shift with the least mean square difference, interpolated by a parabola.

    Parameters
    ----------
    one, other : ndarray, shape (n,)
        The columns.

    Returns
    -------
    float
        Lag of ``other`` behind ``one``, at most 20; negative where it leads. [samples]

    Examples
    --------
    >>> wave = np.sin(np.arange(500) / 20)
    >>> round(lag(wave[3:], wave[:-3]), 2)
    3.0
    """
    longest = min(_MAX_LAG, (len(one) - 1) // 4)
    shifts = np.arange(-longest, longest + 1)
    inner = one[longest : len(one) - longest]
    difference = np.array(
        [np.mean((other[longest + s : longest + s + len(inner)] - inner) ** 2) for s in shifts]
    )
    best = int(np.argmin(difference))
    if not 0 < best < len(shifts) - 1:
        return float(shifts[best])
    # vertex of the parabola through the three lowest points
    left, middle, right = difference[best - 1 : best + 2]
    curvature = left - 2 * middle + right
    return float(shifts[best] + (_HALF * (left - right) / curvature if curvature > 0 else 0.0))


def roughness(values: Array) -> float:
    """Return the root mean square of the second difference: the size of noise or rounding.

    Parameters
    ----------
    values : ndarray, shape (n,)
        A column.
    """
    return float(np.sqrt(np.mean(np.diff(values, 2) ** 2)))


def measured_first(
    columns: list[int], values: Mapping[int, Array], names: tuple[str, ...]
) -> list[int]:
    """Order columns of the same motion, measured ones before commanded ones.

    The name decides first. Then the column with the greater lag counts as measured, as a drive
    follows its command; then the rougher one, as commands are computed.

    Parameters
    ----------
    columns : list of int
        Columns with the same motion.
    values : mapping of int to ndarray, shape (n,)
        Values by column.
    names : tuple of str
        All column names.
    """
    first = columns[0]

    def rank(column: int) -> tuple[bool, bool, float, float]:
        name = names[column]
        delay = round(lag(values[first], values[column]), 1)
        return is_command(name), is_derived(name), -delay, -roughness(values[column])

    return sorted(columns, key=rank)
