"""The constant-velocity parts of a joint's motion.

Only they may enter the separation (8): acceleration adds inertial torque, and so does the
oscillation that follows it. All moves of a stretch of samples are looked at together, as a log has
millions of them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import as_strided

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.array_runs import means, members, offsets, over_samples, reduced, runs
from frictioncli.pairs.moves import SMOOTHING, half_window
from frictioncli.pairs.settings import SteadySettings

REASONS = ("standing", "accelerating", "settling", "constant speed too short")
"""Why samples are in no constant-velocity part."""

_SMOOTHED_SHARE = 0.02
"""Half width of the moving mean as a share of the move's duration: short moves stay sharp."""

_CORE = 0.15
"""Share of a move's samples whose speeds stand closest together: they are its plateau."""

_GAUSSIAN_CORE = 0.189
"""Half width of the densest 15 % of a normal distribution, in standard deviations."""

_DIP = 0.1
"""A joint that slows down below this share of its peak speed begins another move."""

_LONG_CORE = 7
"""Stretches of one core above this differ by fewer samples than it: 1 / 0.15 at most. [samples]"""


@dataclass(frozen=True, slots=True)
class ConstantSpeedParts:
    """Constant-velocity parts in time order, and what became of the samples of moves.

    Attributes
    ----------
    start, stop : ndarray of int, shape (parts,)
        First and past-the-end sample of each part.
    speed : ndarray, shape (parts,)
        Mean velocity, with the direction's sign. [deg/s]
    first, last : ndarray of int, shape (parts,)
        First and past-the-end sample of the move it belongs to, ramps included.
    dropped : dict of str to int
        Samples of the moves that are in no part, by reason.
    """

    start: Numbers
    stop: Numbers
    speed: Array
    first: Numbers
    last: Numbers
    dropped: dict[str, int]


def constant_speed_parts(
    time: Array,
    velocity: Array,
    total: Array,
    first: Numbers,
    last: Numbers,
    settings: SteadySettings,
) -> ConstantSpeedParts:
    """Find the constant-velocity part of every move; of one that dips, those between its dips.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Growing times of one recording and joint. [s]
    velocity : ndarray, shape (samples,)
        Joint velocity. [deg/s]
    total : ndarray, shape (samples + 1,)
        Its :func:`~frictioncli.pairs.moves.running_sum`. [deg/s]
    first, last : ndarray of int, shape (moves,)
        First and past-the-end sample of each move, in time order.
    settings : SteadySettings
        What counts as constant.
    """
    length = last - first
    width = np.minimum(SMOOTHING, _SMOOTHED_SHARE * (time[last - 1] - time[first]))
    start, stop, move = _between_dips(velocity, first, last, settings)
    speed = _smoothed_speed(time, total, first, last, width)
    begin, end, stretch = _plateaus(speed, start, stop, settings)
    # from samples of moves end to end to samples of the recording
    shift = (first - offsets(length))[move]
    low, high = _bounds(start + shift, stop + shift, move, first, last)
    begin, end, move = begin + shift[stretch], end + shift[stretch], move[stretch]
    settled, margin = _trimmed(time, begin, end, width[move], settings)
    long_enough = margin - settled >= settings.min_samples
    held = int(np.sum(end - begin))
    too_short = int(np.sum((end - begin)[~long_enough]))
    settled, margin, stretch = (x[long_enough] for x in (settled, margin, stretch))
    steady = int(np.sum(margin - settled))
    lost = (0, int(length.sum()) - held, held - too_short - steady, too_short)
    return ConstantSpeedParts(
        start=settled,
        stop=margin,
        speed=means(velocity, settled, margin),
        first=low[stretch],
        last=high[stretch],
        dropped=dict(zip(REASONS, lost, strict=True)),
    )


def _smoothed_speed(
    time: Array, total: Array, first: Numbers, last: Numbers, width: Array
) -> Array:
    """Return the moving mean of speed of all moves end to end, each within its own bounds."""
    length = last - first
    half = half_window(time, first, last, width)
    low = members(first - half, last - half)
    high = low + np.repeat(2 * half + 1, length)
    speed = total.take(high, mode="clip")
    speed -= total.take(low, mode="clip")
    speed /= np.repeat(2.0 * half + 1, length)
    # near the ends of a move the mean is one of fewer neighbours
    begin, end = offsets(length), np.cumsum(length)
    near = np.concatenate([members(begin, begin + half), members(end - half, end)])
    move = np.tile(np.repeat(np.arange(len(half)), half), 2)
    low, high = np.maximum(low[near], first[move]), np.minimum(high[near], last[move])
    speed[near] = (total[high] - total[low]) / (high - low)
    return np.abs(speed, out=speed)


def _between_dips(
    velocity: Array, first: Numbers, last: Numbers, settings: SteadySettings
) -> tuple[Numbers, Numbers, Numbers]:
    """Return start, stop and move of the stretches between slow places that can hold a plateau.

    They count in samples of the moves end to end.
    """
    length = last - first
    begin, end = offsets(length), np.cumsum(length)
    speed = velocity[members(first, last)]
    np.abs(speed, out=speed)
    # of three neighbours the median: one bad sample is no dip
    middle = speed.copy()
    before, here, after = speed[:-2], speed[1:-1], speed[2:]
    low, high = np.minimum(before, here), np.maximum(before, here)
    np.maximum(low, np.minimum(high, after, out=high), out=middle[1:-1])
    for edge in (begin, end - 1):
        middle[edge] = speed[edge]
    peak = reduced(np.maximum, middle, begin, end)
    start, stop, move = runs(middle >= np.repeat(_DIP * peak, length), begin)
    kept = stop - start >= settings.min_samples
    return start[kept], stop[kept], move[kept]


def _bounds(
    start: Numbers, stop: Numbers, move: Numbers, first: Numbers, last: Numbers
) -> tuple[Numbers, Numbers]:
    """Return the bounds of stretches; the outer ones of a move have those of the move."""
    opens = np.diff(move, prepend=-1) != 0
    closes = np.diff(move, append=-1) != 0
    return np.where(opens, first[move], start), np.where(closes, last[move], stop)


def _plateaus(
    speed: Array, start: Numbers, stop: Numbers, settings: SteadySettings
) -> tuple[Numbers, Numbers, Numbers]:
    """Return the longest part at the speed that each stretch holds most, where it holds one."""
    level, spread = _densest(speed, start, stop)
    noise = spread / 2 / _GAUSSIAN_CORE
    tolerance = np.maximum(3 * noise, settings.speed_tolerance * level)
    held = (tolerance <= 4 * settings.speed_tolerance * level) & (level >= settings.min_speed)
    stretch = np.flatnonzero(held)
    start, stop = start[stretch], stop[stretch]
    away = speed - over_samples(level[stretch], start, stop, len(speed), 0.0)
    np.abs(away, out=away)
    begin, end, owner = runs(
        away <= over_samples(tolerance[stretch], start, stop, len(speed), -1.0), start
    )
    # a few noisy samples inside a plateau do not end it
    gap = begin[1:] - end[:-1] > np.maximum(3, (stop - start)[owner[1:]] // 50)
    apart = gap | (owner[1:] != owner[:-1])
    begin = begin[np.append(True, apart)] if len(begin) else begin
    end = end[np.append(apart, True)] if len(end) else end
    owner = np.searchsorted(start, begin, side="right") - 1
    # the first of the longest ones of each stretch
    order = np.lexsort((begin - end, owner))
    chosen = order[np.diff(owner[order], prepend=-1) != 0]
    return begin[chosen], end[chosen], stretch[owner[chosen]]


def _densest(speed: Array, start: Numbers, stop: Numbers) -> tuple[Array, Array]:
    """Return median and width of the narrowest range that holds the core of each stretch."""
    length = stop - start
    cores = np.minimum(np.maximum(np.ceil(_CORE * length).astype(np.int64), 2), length - 1)
    level, spread = np.empty(len(start)), np.empty(len(start))
    kind = np.where(cores > _LONG_CORE, cores, -length)
    # a view whose row i holds sample i and those that follow it
    longest = length.max(initial=0)
    padded = np.append(speed, np.full(longest, np.inf))
    following = as_strided(padded, (len(speed), longest), 2 * padded.strides)
    # sorted together: of long ones those with the same core, whose lengths hardly differ
    for one in np.unique(kind):
        rows = np.flatnonzero(kind == one)
        core, own = int(cores[rows[0]]), length[rows]
        ordered = following[:, : own.max()][start[rows]]
        ends = ordered[:, own.min() :]
        np.copyto(ends, np.inf, where=np.arange(own.min(), own.max()) >= own[:, None])
        ordered.sort(axis=1)
        width = ordered[:, core:] - ordered[:, :-core]
        row, densest = np.arange(len(rows)), width.argmin(axis=1)
        spread[rows] = width[row, densest]
        middle = ordered[row, densest + core // 2] + ordered[row, densest + (core + 1) // 2]
        level[rows] = middle / 2
    return level, spread


def _trimmed(
    time: Array, begin: Numbers, end: Numbers, width: Array, settings: SteadySettings
) -> tuple[Numbers, Numbers]:
    """Return plateaus without the settling at their start and the smeared edge at their end."""
    quarter = (time[end - 1] - time[begin]) / 4
    settled = np.searchsorted(time, time[begin] + np.minimum(settings.settling, quarter))
    margin = np.minimum(half_window(time, begin, end, width), (end - begin) // 4)
    return np.minimum(settled, end), end - margin
