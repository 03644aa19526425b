"""Where a joint moves: stretches of one direction, without a stop and without a gap.

A moving mean must not depend on where a batch of samples began. The sums here are exact, so that
differences between them are the same wherever they started.
"""

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.settings import SteadySettings

SMOOTHING = 0.05
"""Half width of the velocity's moving mean, at most. [s]"""

LONGEST = 1 << 19
"""A joint that turns on and on is cut here, so that memory stays bounded. [samples]"""

_GAP = 5.0
"""A pause longer than this many sampling periods ends a move."""

_EXACT = 1.5 * 2.0**28
"""Adding and taking away this number rounds to 2**-24 deg/s, of which sums are exact to 2**29."""

_ROUNDING = 1e-9
"""Time stamps are no exact multiples of their period."""


def running_sum(velocity: Array) -> Array:
    """Return the sums of the first 0, 1, 2, ... velocities, exact to 6e-8 deg/s of each.

    Parameters
    ----------
    velocity : ndarray, shape (samples,)
        Joint velocity. [deg/s]

    Returns
    -------
    ndarray, shape (samples + 1,)
        Sums. [deg/s]
    """
    total = np.zeros(len(velocity) + 1)
    rounded = velocity + _EXACT
    rounded -= _EXACT
    np.cumsum(rounded, out=total[1:])
    return total


def half_window(time: Array, start: Numbers, stop: Numbers, half_width: Array) -> Numbers:
    """Return the half width of moving means in samples; 0 where sampled slower than that.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Growing times. [s]
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of the segments in which means are taken.
    half_width : ndarray, shape (segments,)
        Half of the mean's width. [s]
    """
    count = stop - start
    step = (time[stop - 1] - time[start]) / np.maximum(count - 1, 1)
    half = np.floor(half_width / np.maximum(step, 1e-9) + _ROUNDING).astype(np.int64)
    return np.where(count < 3, 0, np.minimum(half, (count - 1) // 2))


def samples_in(duration: float, period: float) -> int:
    """Return how many sampling periods fit into a duration.

    Parameters
    ----------
    duration, period : float
        Duration and time between samples. [s]
    """
    return int(duration / max(period, 1e-9) + _ROUNDING)


def directions(total: Array, half: int, settings: SteadySettings) -> NDArray[np.int8]:
    """Return +1, -1, or 0 where the joint stands, of a centred moving mean of the velocity.

    Parameters
    ----------
    total : ndarray, shape (samples + 1,)
        :func:`running_sum` of the velocity. [deg/s]
    half : int
        Neighbours on either side; fewer at the ends. [samples]
    settings : SteadySettings
        ``min_speed`` decides what is standing.
    """
    n = len(total) - 1
    half = min(half, max(n - 1, 0) // 2)
    window = np.empty(n)
    np.subtract(total[2 * half + 1 :], total[: n - 2 * half], out=window[half : n - half])
    # at the ends means of fewer neighbours, as if there were as many
    fewer = np.arange(half + 1, 2 * half + 1)
    window[:half] = total[fewer] * (2 * half + 1) / fewer
    window[n - half :] = (total[n] - total[n - fewer[::-1]]) * (2 * half + 1) / fewer[::-1]
    least = settings.min_speed * (2 * half + 1)
    return (window >= least).view(np.int8) - (window <= -least).view(np.int8)


def moves(direction: NDArray[np.int8], time: Array, period: float) -> tuple[Numbers, Numbers]:
    """Return first and past-the-end sample of each move: one direction, no stop, no gap.

    Parameters
    ----------
    direction : ndarray of int, shape (samples,)
        +1, -1 or 0, as :func:`directions` gives.
    time : ndarray, shape (samples,)
        Growing times. [s]
    period : float
        Usual time between samples. [s]
    """
    edge = np.ones(len(direction) + 1, dtype=bool)
    edge[1:-1] = (direction[1:] != direction[:-1]) | (np.diff(time) > _GAP * period)
    edges = np.flatnonzero(edge)
    moving = direction[edges[:-1]] != 0
    first, last = edges[:-1][moving], edges[1:][moving]
    pieces = -(-(last - first) // LONGEST)
    if (pieces > 1).any():
        number = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        first = np.repeat(first, pieces) + number * LONGEST
        last = np.minimum(first + LONGEST, np.repeat(last, pieces))
    return first, last
