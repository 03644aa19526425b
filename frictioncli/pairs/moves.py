"""Moves of a joint: motion in one direction, without a stop and without a gap in time.

A moving mean must not depend on where a batch of samples began. The running sums here are exact,
so that their differences are the same wherever they started.
"""

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.settings import SteadySettings

SMOOTHING = 0.05
"""Greatest half width of the velocity's moving mean. [s]"""

LONGEST_MOVE = 1 << 19
"""A longer move is cut, so that memory stays bounded where a joint never stops. [samples]"""

_GAP = 5.0
"""A pause longer than this many sampling periods ends a move."""

_ROUNDING_OFFSET = 1.5 * 2.0**28
"""Adding and subtracting this rounds to 2**-24 deg/s, of which sums are exact up to 2**29."""

_TIME_ROUNDING = 1e-9
"""Tolerance for time stamps that are no exact multiples of their period."""


def running_sum(velocity: Array) -> Array:
    """Return the sums of the first 0, 1, 2, ... velocities, each rounded to 6e-8 deg/s.

    Parameters
    ----------
    velocity : ndarray, shape (samples,)
        Joint velocity. [deg/s]

    Returns
    -------
    ndarray, shape (samples + 1,)
        Sums. [deg/s]

    Examples
    --------
    >>> running_sum(np.array([1.0, 2.0, -1.0]))
    array([0., 1., 3., 2.])
    """
    total = np.zeros(len(velocity) + 1)
    rounded = velocity + _ROUNDING_OFFSET
    rounded -= _ROUNDING_OFFSET
    np.cumsum(rounded, out=total[1:])
    return total


def half_window(time: Array, start: Numbers, stop: Numbers, half_width: Array) -> Numbers:
    """Return the half width of moving means in samples; 0 where sampled slower than that.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Increasing times. [s]
    start, stop : ndarray of int, shape (slices,)
        First and past-the-end sample of the slices in which means are taken.
    half_width : ndarray, shape (slices,)
        Half width of the moving means. [s]

    Returns
    -------
    ndarray of int, shape (slices,)
        Neighbours on either side. [samples]
    """
    count = stop - start
    step = (time[stop - 1] - time[start]) / np.maximum(count - 1, 1)
    half = np.floor(half_width / np.maximum(step, 1e-9) + _TIME_ROUNDING).astype(np.int64)
    return np.where(count < 3, 0, np.minimum(half, (count - 1) // 2))


def samples_in(duration: float, period: float) -> int:
    """Return how many sampling periods fit into a duration.

    Parameters
    ----------
    duration, period : float
        Duration and sampling period. [s]

    Examples
    --------
    >>> samples_in(0.05, 0.012)
    4
    """
    return int(duration / max(period, 1e-9) + _TIME_ROUNDING)


def directions(total: Array, half: int, settings: SteadySettings) -> NDArray[np.int8]:
    """Return the direction of motion from a centred moving mean of the velocity.

    Parameters
    ----------
    total : ndarray, shape (samples + 1,)
        :func:`running_sum` of the velocity. [deg/s]
    half : int
        Neighbours on either side; fewer at the ends. [samples]
    settings : SteadySettings
        ``min_speed`` decides what is standing.

    Returns
    -------
    ndarray of int8, shape (samples,)
        +1 forward, -1 in reverse, 0 where the joint stands.

    Examples
    --------
    >>> total = running_sum(np.array([0.0, 0.0, 5.0, 5.0, -5.0]))
    >>> directions(total, 0, SteadySettings())
    array([ 0,  0,  1,  1, -1], dtype=int8)
    """
    n = len(total) - 1
    half = min(half, max(n - 1, 0) // 2)
    window = np.empty(n)
    np.subtract(total[2 * half + 1 :], total[: n - 2 * half], out=window[half : n - half])
    # at the ends means of fewer neighbours, scaled to the full number
    fewer = np.arange(half + 1, 2 * half + 1)
    window[:half] = total[fewer] * (2 * half + 1) / fewer
    window[n - half :] = (total[n] - total[n - fewer[::-1]]) * (2 * half + 1) / fewer[::-1]
    least = settings.min_speed * (2 * half + 1)
    return (window >= least).view(np.int8) - (window <= -least).view(np.int8)


def moves(direction: NDArray[np.int8], time: Array, period: float) -> tuple[Numbers, Numbers]:
    """Return first and past-the-end sample of each move.

    Parameters
    ----------
    direction : ndarray of int8, shape (samples,)
        +1, -1 or 0, as :func:`directions` returns it.
    time : ndarray, shape (samples,)
        Increasing times. [s]
    period : float
        Usual sampling period. [s]

    Returns
    -------
    start, stop : ndarray of int, shape (moves,)
        First and past-the-end sample of each move, in time order.

    Examples
    --------
    >>> direction = np.array([0, 1, 1, 0, -1], dtype=np.int8)
    >>> start, stop = moves(direction, np.arange(5.0), 1.0)
    >>> start.tolist(), stop.tolist()
    ([1, 4], [3, 5])
    """
    edge = np.ones(len(direction) + 1, dtype=bool)
    edge[1:-1] = (direction[1:] != direction[:-1]) | (np.diff(time) > _GAP * period)
    edges = np.flatnonzero(edge)
    moving = direction[edges[:-1]] != 0
    start, stop = edges[:-1][moving], edges[1:][moving]
    cuts = -(-(stop - start) // LONGEST_MOVE)
    if (cuts > 1).any():
        number = np.arange(cuts.sum()) - np.repeat(np.cumsum(cuts) - cuts, cuts)
        start = np.repeat(start, cuts) + number * LONGEST_MOVE
        stop = np.minimum(start + LONGEST_MOVE, np.repeat(stop, cuts))
    return start, stop


def cut_off(
    time: Array, velocity: Array, start: Numbers, stop: Numbers, least: Array
) -> NDArray[np.bool_]:
    """Return which moves are cut off by a gap in the log: beside it the joint does not stand.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Increasing times of one recording. [s]
    velocity : ndarray, shape (samples,)
        Joint velocity. [deg/s]
    start, stop : ndarray of int, shape (moves,)
        First and past-the-end sample of each move.
    least : ndarray, shape (moves,)
        Speed below which the joint stands or begins to move. [deg/s]

    Returns
    -------
    ndarray of bool, shape (moves,)
        Whether a part of the move is missing.

    Examples
    --------
    >>> time = np.array([0.0, 0.1, 0.2, 0.3, 1.3, 1.4, 1.5])
    >>> velocity = np.array([1.0, 20.0, 50.0, 50.0, 50.0, 20.0, 1.0])
    >>> cut_off(time, velocity, np.array([0, 4]), np.array([4, 7]), np.full(2, 5.0)).tolist()
    [True, True]
    >>> cut_off(time, velocity, np.array([0, 4]), np.array([4, 7]), np.full(2, 60.0)).tolist()
    [False, False]
    """
    first, last = start, stop - 1
    longest = _GAP * (time[last] - time[first]) / np.maximum(last - first, 1)
    before = time[first] - time[np.maximum(first - 1, 0)] > longest
    after = time[np.minimum(stop, len(time) - 1)] - time[last] > longest
    begun, goes_on = np.abs(velocity[first]) > least, np.abs(velocity[last]) > least
    return np.asarray((before & begun) | (after & goes_on))
