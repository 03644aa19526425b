"""Temperatures that a sensor no longer updated."""

import numpy as np

from frictioncli.arrays import Array, Flags

_PAIRS = 5
"""Least number of pairs in which the reading stands still."""

_SECONDS = 900.0
"""Least time over which it does. [s]"""

_ROUNDING = 1e-6
"""Difference of two means of the same reading. [°C]"""

_SPAN = 300.0
"""Time over which the rate of change of the temperature is taken. [s]"""

_JUMP = 2.0
"""Least jump beyond what the greatest rate of change elsewhere in the run makes possible. [°C]"""


def is_stuck(time: Array, reading: Array) -> Flags:
    """Return in which pairs of a run the reading stood still and then jumped.

    A reading that is not updated keeps its last value exactly, and takes the right one suddenly. A
    coarse one that is steady goes on in small steps, and in a pause a joint warms or cools about as
    fast as at other times. One that is not updated until the end of the run cannot be recognised.

    Parameters
    ----------
    time : ndarray, shape (pairs,)
        Times of the pairs, in order. [s]
    reading : ndarray, shape (pairs,)
        Temperatures; not a number where there is none. [°C]

    Returns
    -------
    ndarray of bool, shape (pairs,)
        The pairs of such stretches.

    Examples
    --------
    >>> import numpy as np
    >>> reading = np.array([30.0, 31.0, 32.0, 32.0, 32.0, 32.0, 32.0, 41.0, 41.5])
    >>> is_stuck(300.0 * np.arange(9), reading).astype(int)
    array([0, 0, 1, 1, 1, 1, 1, 0, 0])
    """
    stuck = np.zeros(len(time), bool)
    known = np.flatnonzero(np.isfinite(reading))
    changes = np.flatnonzero(np.abs(np.diff(reading[known])) > _ROUNDING)
    begins, ends = np.append(0, changes + 1)[:-1], changes
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        own, after = known[begin : end + 1], known[end + 1]
        if len(own) < _PAIRS or time[own[-1]] - time[own[0]] < _SECONDS:
            continue
        # no rate is taken across the stretch
        sides = known[:begin], known[end + 1 :]
        rate = max(_greatest_rate(time[side], reading[side]) for side in sides)
        possible = rate * (time[after] - time[own[-1]]) + _JUMP
        stuck[own] = abs(reading[after] - reading[own[0]]) > possible
    return stuck


def _greatest_rate(time: Array, reading: Array) -> float:
    """Return the greatest rate of change over a few minutes [°C/s]."""
    later = np.searchsorted(time, time + _SPAN)
    first = np.flatnonzero(later < len(time))
    later = later[first]
    change = np.abs(reading[later] - reading[first])
    return float(np.max(change / (time[later] - time[first]), initial=0.0))
