"""Constant speeds of moves that go from one speed to the next without a stop.

A move of one speed has its plateau where speeds are most similar. In a staircase of speeds that
finds one step at best. What is left of a move is therefore searched for parts in which the speed
of one window is that of the next.
"""

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.settings import SteadySettings
from frictioncli.pairs.slices import slice_indices, slice_offsets, true_runs

WINDOW = 0.2
"""Length of the windows whose mean speeds are compared; half of the shortest step found. [s]"""

_LEAST_WINDOW = 4
"""Least length of a window. [samples]"""

_FLAT = 2.0
"""Greatest difference of two windows, in tolerances of constant speed."""

_BEYOND = 0.3
"""At this share of its length outside of a step, speed must have left it."""

_LEFT = 3.0
"""Departure with which speed has left a step, in tolerances of constant speed."""

_BENT = 0.2
"""Greatest difference between the middle of a step and its sides, in tolerances."""


def parts_left(
    start: Numbers, stop: Numbers, begin: Numbers, end: Numbers, candidate: Numbers
) -> tuple[Numbers, Numbers, Numbers]:
    """Return start, stop and candidate of what plateaus leave of candidates, in order.

    Parameters
    ----------
    start, stop : ndarray of int, shape (candidates,)
        First and past-the-end sample of each candidate.
    begin, end, candidate : ndarray of int, shape (plateaus,)
        First and past-the-end sample of each plateau, and its candidate; at most one of each.

    Examples
    --------
    >>> one, two = np.array([0, 50]), np.array([40, 90])
    >>> first, last, owner = parts_left(one, two, np.array([10]), np.array([30]), np.array([0]))
    >>> first.tolist(), last.tolist(), owner.tolist()
    ([0, 30, 50], [10, 40, 90], [0, 0, 1])
    """
    low, high = stop.copy(), stop.copy()
    low[candidate], high[candidate] = begin, end
    first = np.column_stack([start, high]).ravel()
    last = np.column_stack([low, stop]).ravel()
    owner = np.repeat(np.arange(len(start)), 2)
    kept = last > first
    return first[kept], last[kept], owner[kept]


def flat_parts(
    speed: Array, first: Numbers, last: Numbers, window: Numbers, settings: SteadySettings
) -> tuple[Numbers, Numbers, Numbers]:
    """Return start, stop and part of runs of samples about which the speed is the same.

    Parameters
    ----------
    speed : ndarray, shape (samples,)
        Smoothed speed. [deg/s]
    first, last : ndarray of int, shape (parts,)
        First and past-the-end sample of the parts that are searched, in order.
    window : ndarray of int, shape (parts,)
        Length of the windows. [samples]
    settings : SteadySettings
        ``speed_tolerance`` and ``min_speed``.

    Returns
    -------
    start, stop, part : ndarray of int, shape (runs,)
        Runs, with the windows about their ends as far as they do not overlap, and their parts.
    """
    long_enough = np.flatnonzero(last - first >= 3 * window)
    low, high = (first + window)[long_enough], (last - window)[long_enough]
    none = np.empty(0, np.int64)
    if not len(low):
        return none, none, none
    index = slice_indices(low, high)
    width = np.repeat(window[long_enough], high - low)
    total = np.append(0.0, np.cumsum(speed))
    before = (total[index] - total[index - width]) / width
    after = (total[index + width] - total[index]) / width
    level = (before + after) / 2
    flat = np.abs(after - before) <= _FLAT * settings.speed_tolerance * level
    offset = slice_offsets(high - low)
    begin, end, part = true_runs(flat & (level >= settings.min_speed), offset)
    shift = low - offset
    begin, end, part = begin + shift[part], end + shift[part], long_enough[part]
    # the windows at both ends are of the step too, but for its neighbours' share
    margin = window[part]
    space = np.append(begin[1:] - end[:-1], 0)
    same = np.append(part[1:] == part[:-1], False)
    behind = np.where(same, np.minimum(margin, space // 2), margin)
    ahead = np.append(margin[:1], np.where(same, np.minimum(margin, space // 2), 0)[:-1])
    ahead = np.where(np.append(False, same[:-1]), ahead, margin)
    return np.maximum(begin - ahead, first[part]), np.minimum(end + behind, last[part]), part


def is_step(
    speed: Array,
    begin: Numbers,
    end: Numbers,
    first: Numbers,
    last: Numbers,
    settings: SteadySettings,
) -> Flags:
    """Return whether plateaus end abruptly: those of a sine's peak or of a slow ramp do not.

    Parameters
    ----------
    speed : ndarray, shape (samples,)
        Smoothed speed. [deg/s]
    begin, end : ndarray of int, shape (plateaus,)
        First and past-the-end sample of each plateau.
    first, last : ndarray of int, shape (plateaus,)
        Bounds of the candidate that it is in; what lies outside is another speed.
    settings : SteadySettings
        ``speed_tolerance``.
    """
    beyond = np.maximum((_BEYOND * (end - begin)).astype(np.int64), 2)
    eighth = (end - begin) // 8
    total = np.append(0.0, np.cumsum(speed))

    def mean(low: Numbers, high: Numbers) -> Array:
        return np.asarray((total[high] - total[low]) / np.maximum(high - low, 1))

    level = mean(begin + 3 * eighth, end - 3 * eighth)
    sides = mean(begin + eighth, begin + 2 * eighth), mean(end - 2 * eighth, end - eighth)
    bend = np.abs(level - (sides[0] + sides[1]) / 2)
    noise = np.array([_noise_of_means(speed[b:e]) for b, e in zip(begin, end, strict=True)])
    abrupt = bend <= _BENT * settings.speed_tolerance * level + 2 * noise
    for sample, inside in (
        (begin - 1 - beyond, begin - 1 - beyond >= first),
        (end + beyond, end + beyond < last),
    ):
        there = speed[np.clip(sample, 0, max(len(speed) - 1, 0))]
        abrupt &= ~inside | (np.abs(there - level) > _LEFT * settings.speed_tolerance * level)
    return abrupt


def _noise_of_means(speed: Array) -> float:
    """Return the standard deviation of the mean over an eighth of a step, without its trend."""
    apart = max(len(speed) // 32, 1)
    bends = speed[2 * apart :] - 2 * speed[apart:-apart] + speed[: -2 * apart]
    independent = max(len(speed) / 8 / apart, 1.0)
    return float(np.sqrt(np.mean(np.square(bends)) / 6 / independent)) if len(bends) else 0.0


def window_samples(time: Array, first: Numbers, last: Numbers) -> Numbers:
    """Return the length of the windows in the moves of given bounds [samples]."""
    step = (time[last - 1] - time[first]) / np.maximum(last - first - 1, 1)
    return np.maximum((WINDOW / np.maximum(step, 1e-9)).astype(np.int64), _LEAST_WINDOW)
