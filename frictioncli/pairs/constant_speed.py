"""Constant-speed segments of a joint's moves.

Only they may enter the separation (8): acceleration adds inertial torque, and so does the
oscillation that follows it. All moves of a chunk of samples are treated together, as a log has
millions of them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import as_strided

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.moves import SMOOTHING, cut_off, half_window
from frictioncli.pairs.ringing import HOLD, ringing_ends
from frictioncli.pairs.settings import SteadySettings
from frictioncli.pairs.slices import (
    fill_slices,
    reduce_slices,
    slice_indices,
    slice_means,
    slice_offsets,
    true_runs,
)
from frictioncli.pairs.speed_steps import flat_parts, is_step, parts_left, window_samples

REASONS = ("standing", "accelerating", "settling", "ringing", "constant speed too short")
"""Reasons why samples are in no constant-speed segment."""

_SMOOTHED_SHARE = 0.02
"""Half width of the moving mean as a share of the move's duration: short moves stay sharp."""

_CORE = 0.15
"""Share of a move's samples, those with the most similar speeds, that defines its plateau."""

_GAUSSIAN_CORE = 0.189
"""Half width of the densest 15 % of a normal distribution, in standard deviations."""

_DIP = 0.1
"""A joint that slows down below this share of its peak speed begins another move."""

_LONG_CORE = 7
"""Candidates with the same core above this differ in length by fewer samples than the core."""


@dataclass(frozen=True, slots=True)
class ConstantSpeedSegments:
    """Constant-speed segments in time order, and the samples of moves that are in none.

    Attributes
    ----------
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of each segment.
    speed : ndarray, shape (segments,)
        Mean velocity, with the direction's sign. [deg/s]
    move_start, move_stop : ndarray of int, shape (segments,)
        First and past-the-end sample of the move that it belongs to, ramps included.
    dropped : dict of str to int
        Samples of the moves that are in no segment, by reason.
    """

    start: Numbers
    stop: Numbers
    speed: Array
    move_start: Numbers
    move_stop: Numbers
    dropped: dict[str, int]


def constant_speed_segments(
    time: Array,
    velocity: Array,
    total: Array,
    move_start: Numbers,
    move_stop: Numbers,
    settings: SteadySettings,
) -> ConstantSpeedSegments:
    """Return the constant-speed segment of every move; of a move that dips, those between dips.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Increasing times of one recording and joint. [s]
    velocity : ndarray, shape (samples,)
        Joint velocity. [deg/s]
    total : ndarray, shape (samples + 1,)
        :func:`~frictioncli.pairs.moves.running_sum` of the velocity. [deg/s]
    move_start, move_stop : ndarray of int, shape (moves,)
        First and past-the-end sample of each move, in time order.
    settings : SteadySettings
        What counts as constant speed.

    Returns
    -------
    ConstantSpeedSegments
        The segments.

    Examples
    --------
    A move with ramps of 0.1 s that holds 50 deg/s:

    >>> from frictioncli.pairs.moves import running_sum
    >>> time = 0.01 * np.arange(220)
    >>> velocity = np.interp(time, [0.0, 0.1, 2.1, 2.2], [0.0, 50.0, 50.0, 0.0])
    >>> total, move = running_sum(velocity), (np.array([0]), np.array([220]))
    >>> found = constant_speed_segments(time, velocity, total, *move, SteadySettings())
    >>> found.speed.round(3)
    array([50.])
    """
    length = move_stop - move_start
    width = np.minimum(SMOOTHING, _SMOOTHED_SHARE * (time[move_stop - 1] - time[move_start]))
    start, stop, move = _between_dips(velocity, move_start, move_stop, settings)
    speed = _smoothed_speed(time, total, move_start, move_stop, width)
    begin, end, candidate = _plateaus(speed, start, stop, settings)
    window = window_samples(time, move_start, move_stop)[move]
    begin, end, candidate = _with_steps(
        speed, start, stop, window, (begin, end, candidate), settings
    )
    # from samples of moves end to end to samples of the recording
    shift = (move_start - slice_offsets(length))[move]
    step = (time[move_stop - 1] - time[move_start]) / np.maximum(length - 1, 1)
    hold = (HOLD / np.maximum(step, 1e-9)).astype(np.int64)[move[candidate]]
    first = slice_offsets(length)
    change = np.abs(np.diff(speed, append=0.0))
    last = first + np.maximum(length - 1, 1)
    ramp = reduce_slices(np.maximum, change, first, last) / np.maximum(step, 1e-9)
    quiet = ringing_ends(speed, begin, end, hold, ramp[move[candidate]]) + shift[candidate]
    low, high = _bounds(start + shift, stop + shift, move, move_start, move_stop)
    begin, end, move = begin + shift[candidate], end + shift[candidate], move[candidate]
    # the steps of a staircase have no ramps from rest and to rest
    several = np.bincount(candidate, minlength=len(start))[candidate] > 1
    low = np.where(several, begin, low[candidate])
    high = np.where(several, end, high[candidate])
    mean = np.abs(total[move_stop] - total[move_start]) / length
    cut = cut_off(time, velocity, move_start, move_stop, _DIP * mean)[move]
    settled, margin = _trimmed(time, begin, end, width[move], cut, settings)
    rung = _after_ringing(time, np.where(several, begin, quiet), settled, (begin, end), settings)
    long_enough = margin - rung >= settings.min_samples
    held = int(np.sum(end - begin))
    too_short = int(np.sum((end - begin)[~long_enough]))
    ringing = int(np.sum((rung - settled)[long_enough]))
    settled, margin, low, high = (x[long_enough] for x in (rung, margin, low, high))
    steady = int(np.sum(margin - settled))
    settling = held - too_short - ringing - steady
    lost = (0, int(length.sum()) - held, settling, ringing, too_short)
    return ConstantSpeedSegments(
        start=settled,
        stop=margin,
        speed=slice_means(velocity, settled, margin),
        move_start=low,
        move_stop=high,
        dropped=dict(zip(REASONS, lost, strict=True)),
    )


def _with_steps(
    speed: Array,
    start: Numbers,
    stop: Numbers,
    window: Numbers,
    plateaus: tuple[Numbers, Numbers, Numbers],
    settings: SteadySettings,
) -> tuple[Numbers, Numbers, Numbers]:
    """Return the plateaus with those that are left in candidates of several speeds, in order."""
    first, last, owner = parts_left(start, stop, *plateaus)
    flat_start, flat_stop, part = flat_parts(speed, first, last, window[owner], settings)
    wide = flat_stop - flat_start >= 2 * window[owner[part]]
    flat_start, flat_stop, part = flat_start[wide], flat_stop[wide], part[wide]
    if not len(flat_start):
        return plateaus
    begin, end, which = _plateaus(speed, flat_start, flat_stop, settings)
    candidate = owner[part[which]]
    kept = end - begin >= 2 * window[candidate]
    kept &= is_step(speed, begin, end, start[candidate], stop[candidate], settings)
    found = (begin[kept], end[kept], candidate[kept])
    together = [np.concatenate(both) for both in zip(plateaus, found, strict=True)]
    order = np.argsort(together[0], kind="stable")
    return together[0][order], together[1][order], together[2][order]


def _smoothed_speed(
    time: Array, total: Array, first: Numbers, last: Numbers, width: Array
) -> Array:
    """Return the moving mean of speed of all moves end to end, each within its own bounds."""
    length = last - first
    half = half_window(time, first, last, width)
    low = slice_indices(first - half, last - half)
    high = low + np.repeat(2 * half + 1, length)
    speed = total.take(high, mode="clip")
    speed -= total.take(low, mode="clip")
    speed /= np.repeat(2.0 * half + 1, length)
    # near the ends of a move the mean is one of fewer neighbours
    begin, end = slice_offsets(length), np.cumsum(length)
    near = np.concatenate([slice_indices(begin, begin + half), slice_indices(end - half, end)])
    move = np.tile(np.repeat(np.arange(len(half)), half), 2)
    low, high = np.maximum(low[near], first[move]), np.minimum(high[near], last[move])
    speed[near] = (total[high] - total[low]) / (high - low)
    return np.abs(speed, out=speed)


def _between_dips(
    velocity: Array, first: Numbers, last: Numbers, settings: SteadySettings
) -> tuple[Numbers, Numbers, Numbers]:
    """Return start, stop and move of the candidates: where a move is not slower than its dips.

    They count in samples of the moves end to end.
    """
    length = last - first
    begin, end = slice_offsets(length), np.cumsum(length)
    speed = velocity[slice_indices(first, last)]
    np.abs(speed, out=speed)
    # the median of three neighbours: one bad sample is no dip
    median = speed.copy()
    before, here, after = speed[:-2], speed[1:-1], speed[2:]
    low, high = np.minimum(before, here), np.maximum(before, here)
    np.maximum(low, np.minimum(high, after, out=high), out=median[1:-1])
    for edge in (begin, end - 1):
        median[edge] = speed[edge]
    peak = reduce_slices(np.maximum, median, begin, end)
    start, stop, move = true_runs(median >= np.repeat(_DIP * peak, length), begin)
    kept = stop - start >= settings.min_samples
    return start[kept], stop[kept], move[kept]


def _bounds(
    start: Numbers, stop: Numbers, move: Numbers, first: Numbers, last: Numbers
) -> tuple[Numbers, Numbers]:
    """Return the bounds of candidates; the outer ones of a move have those of the move."""
    opens = np.diff(move, prepend=-1) != 0
    closes = np.diff(move, append=-1) != 0
    return np.where(opens, first[move], start), np.where(closes, last[move], stop)


def _plateaus(
    speed: Array, start: Numbers, stop: Numbers, settings: SteadySettings
) -> tuple[Numbers, Numbers, Numbers]:
    """Return the longest plateau at the most frequent speed of each candidate that has one."""
    level, spread = _densest(speed, start, stop)
    noise = spread / 2 / _GAUSSIAN_CORE
    tolerance = np.maximum(3 * noise, settings.speed_tolerance * level)
    held = (tolerance <= 4 * settings.speed_tolerance * level) & (level >= settings.min_speed)
    candidate = np.flatnonzero(held)
    start, stop = start[candidate], stop[candidate]
    deviation = speed - fill_slices(level[candidate], start, stop, len(speed), 0.0)
    np.abs(deviation, out=deviation)
    begin, end, owner = true_runs(
        deviation <= fill_slices(tolerance[candidate], start, stop, len(speed), -1.0), start
    )
    # a few noisy samples inside a plateau do not end it
    gap = begin[1:] - end[:-1] > np.maximum(3, (stop - start)[owner[1:]] // 50)
    apart = gap | (owner[1:] != owner[:-1])
    begin = begin[np.append(True, apart)] if len(begin) else begin
    end = end[np.append(apart, True)] if len(end) else end
    owner = np.searchsorted(start, begin, side="right") - 1
    # the first of the longest ones of each candidate
    order = np.lexsort((begin - end, owner))
    chosen = order[np.diff(owner[order], prepend=-1) != 0]
    return begin[chosen], end[chosen], candidate[owner[chosen]]


def _densest(speed: Array, start: Numbers, stop: Numbers) -> tuple[Array, Array]:
    """Return median and width of the narrowest range that holds the core of each candidate."""
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
        core, count = int(cores[rows[0]]), length[rows]
        ordered = following[:, : count.max()][start[rows]]
        ends = ordered[:, count.min() :]
        np.copyto(ends, np.inf, where=np.arange(count.min(), count.max()) >= count[:, None])
        ordered.sort(axis=1)
        width = ordered[:, core:] - ordered[:, :-core]
        row, densest = np.arange(len(rows)), width.argmin(axis=1)
        spread[rows] = width[row, densest]
        middle = ordered[row, densest + core // 2] + ordered[row, densest + (core + 1) // 2]
        level[rows] = middle / 2
    return level, spread


def _trimmed(
    time: Array, begin: Numbers, end: Numbers, width: Array, cut: Flags, settings: SteadySettings
) -> tuple[Numbers, Numbers]:
    """Return plateaus without the settling at their start and the smoothed edge at their end.

    Both are shorter in short moves, but not in short pieces of moves that a gap of the log cuts
    off: these accelerate and ring as long as the whole move.
    """
    most = settings.settling_share * (time[end - 1] - time[begin])
    settling = np.where(cut, settings.settling, np.minimum(settings.settling, most))
    settled = np.minimum(np.searchsorted(time, time[begin] + settling), end)
    margin = np.minimum(half_window(time, begin, end, width), (end - begin) // 4)
    whole = end - np.searchsorted(time, time[end - 1] - SMOOTHING, side="right")
    return settled, np.maximum(end - np.where(cut, whole, margin), settled)


def _after_ringing(
    time: Array,
    quiet: Numbers,
    settled: Numbers,
    plateau: tuple[Numbers, Numbers],
    settings: SteadySettings,
) -> Numbers:
    """Return where plateaus begin that have settled and do not ring any more.

    Where it still rings when it should have settled, the settling is waited for once more: ringing
    that the speed no longer shows still accelerates.
    """
    begin, end = plateau
    most = settings.settling_share * (time[end - 1] - time[begin])
    later = time[np.minimum(quiet, end - 1)] + np.minimum(settings.settling, most)
    after = np.minimum(np.searchsorted(time, later), end)
    return np.where(quiet > settled, np.maximum(after, settled), settled)
