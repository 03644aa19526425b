"""The constant-velocity parts of a joint's motion.

Only they may enter the separation (8): acceleration adds inertial torque, and so does the
oscillation that follows it.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from frictioncli.motion.settings import SteadySettings

Array = NDArray[np.float64]

STANDING, ACCELERATING, SETTLING, TOO_SHORT, STEADY = range(5)
"""What each sample is; the first four are dropped."""

REASONS = ("standing", "accelerating", "settling", "constant speed too short")
"""Names of the classes that are dropped, in their order."""

_SMOOTHING = 0.05
"""Half width of the velocity's moving mean, at most. [s]"""

_SMOOTHED_SHARE = 0.02
"""The same as a share of the move's duration: short moves must not be smeared."""

_CORE = 0.15
"""Share of a move's samples whose speeds stand closest together: they are its plateau."""

_GAUSSIAN_CORE = 0.189
"""Half width of the densest 15 % of a normal distribution, in standard deviations."""

_DIP = 0.1
"""A joint that slows down below this share of its peak speed begins another move."""

_GAP = 5.0
"""A pause longer than this many sampling periods ends a move."""


@dataclass(frozen=True, slots=True)
class SteadyPart:
    """One constant-velocity part: samples ``start`` to ``stop`` (excluded) and their speed.

    ``speed`` carries the direction's sign [deg/s]. The move it belongs to, ramps included, has the
    samples ``first`` to ``last`` (excluded).
    """

    start: int
    stop: int
    speed: float
    first: int
    last: int


def moves(time: Array, velocity: Array, settings: SteadySettings) -> list[tuple[int, int]]:
    """Return first and past-the-end sample of each move: one direction, no stop, no gap.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Growing times. [s]
    velocity : ndarray, shape (samples,)
        Smoothed joint velocity. [deg/s]
    settings : SteadySettings
        ``min_speed`` decides what is standing.
    """
    if len(time) < 2:
        return []
    direction = np.where(np.abs(velocity) < settings.min_speed, 0, np.sign(velocity))
    step = np.diff(time)
    breaks = (np.diff(direction) != 0) | (step > _GAP * np.median(step))
    edges = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(time)]])
    return [(int(start), int(stop)) for start, stop in pairwise(edges) if direction[start] != 0]


def smoothed(time: Array, velocity: Array, half_width: float = _SMOOTHING) -> Array:
    """Return the centred moving mean of velocity; as it is where sampled slower than that.

    Parameters
    ----------
    time, velocity : ndarray, shape (samples,)
        Times and joint velocity. [s], [deg/s]
    half_width : float
        Half of the mean's width. [s]
    """
    half = _half_window(time, half_width)
    if half == 0:
        return velocity
    total = np.concatenate([[0.0], np.cumsum(velocity)])
    low = np.maximum(np.arange(len(velocity)) - half, 0)
    high = np.minimum(np.arange(len(velocity)) + half + 1, len(velocity))
    return (total[high] - total[low]) / (high - low)


def steady_parts(
    time: Array, velocity: Array, settings: SteadySettings
) -> tuple[list[SteadyPart], NDArray[np.int8]]:
    """Find the constant-velocity part of every move.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Growing times of one recording and joint. [s]
    velocity : ndarray, shape (samples,)
        Joint velocity. [deg/s]
    settings : SteadySettings
        What counts as constant.

    Returns
    -------
    list of SteadyPart
        At most one per move, in time order.
    ndarray of int8, shape (samples,)
        Class of every sample, from :data:`STANDING` to :data:`STEADY`.
    """
    classes = np.full(len(time), STANDING, dtype=np.int8)
    parts = []
    for first, last in moves(time, smoothed(time, velocity), settings):
        classes[first:last] = ACCELERATING
        width = min(_SMOOTHING, _SMOOTHED_SHARE * (time[last - 1] - time[first]))
        speed = np.abs(smoothed(time[first:last], velocity[first:last], width))
        stretches = _between_dips(velocity[first:last], settings)
        for number, (start, stop) in enumerate(stretches):
            plateau = _plateau(speed[start:stop], settings)
            if plateau is None:
                continue
            begin, end = first + start + plateau[0], first + start + plateau[1]
            settled, margin = _trimmed(time[begin:end], width, settings)
            if margin - settled < settings.min_samples:
                classes[begin:end] = TOO_SHORT
                continue
            classes[begin:end] = SETTLING
            classes[begin + settled : begin + margin] = STEADY
            mean = float(np.mean(velocity[begin + settled : begin + margin]))
            low = first if number == 0 else first + start
            high = last if number == len(stretches) - 1 else first + stop
            parts.append(SteadyPart(begin + settled, begin + margin, mean, low, high))
    return parts, classes


def _half_window(time: Array, half_width: float) -> int:
    if len(time) < 3:
        return 0
    half = int(half_width / max(float(np.median(np.diff(time))), 1e-9))
    return min(half, (len(time) - 1) // 2)


def _between_dips(velocity: Array, settings: SteadySettings) -> list[tuple[int, int]]:
    """Return the stretches of a move between its slow places, long enough to hold a plateau."""
    # of three neighbours the median: one bad sample is no dip
    padded = np.pad(np.abs(velocity), 1, mode="edge")
    speed = np.median(np.stack([padded[:-2], padded[1:-1], padded[2:]]), axis=0)
    fast = speed >= _DIP * float(np.max(speed))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], fast, [False]]).astype(np.int8)))
    return [
        (int(start), int(stop))
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
        if stop - start >= settings.min_samples
    ]


def _plateau(speed: Array, settings: SteadySettings) -> tuple[int, int] | None:
    """Return the longest stretch at the speed that the move holds most; none if it holds none."""
    core = min(max(int(np.ceil(_CORE * len(speed))), 2), len(speed) - 1)
    ordered = np.sort(speed)
    widths = ordered[core:] - ordered[: len(ordered) - core]
    densest = int(np.argmin(widths))
    level = float(np.median(ordered[densest : densest + core + 1]))
    noise = float(widths[densest]) / 2 / _GAUSSIAN_CORE
    tolerance = max(3 * noise, settings.speed_tolerance * level)
    if tolerance > 4 * settings.speed_tolerance * level:
        return None
    within = np.abs(speed - level) <= tolerance
    edges = np.flatnonzero(np.diff(np.concatenate([[False], within, [False]]).astype(np.int8)))
    starts, stops = edges[::2], edges[1::2]
    # a few noisy samples inside a plateau do not end it
    apart = starts[1:] - stops[:-1] > max(3, len(speed) // 50)
    starts = starts[np.concatenate([[True], apart])]
    stops = stops[np.concatenate([apart, [True]])]
    longest = int(np.argmax(stops - starts))
    return int(starts[longest]), int(stops[longest])


def _trimmed(time: Array, half_width: float, settings: SteadySettings) -> tuple[int, int]:
    """Return the part of a plateau behind the settling and before the smeared edge at its end."""
    quarter = (time[-1] - time[0]) / 4
    settled = int(np.searchsorted(time, time[0] + min(settings.settling, quarter)))
    margin = min(_half_window(time, half_width), len(time) // 4)
    return settled, len(time) - margin
