"""Continuous temperature from a register that shows whole degrees.

At the moment the register changes, the true temperature lies half-way between the two readings, if
the register rounds. (A register that truncates gives a constant offset of half a step.) Between
such moments the temperature is interpolated in time, also across pauses, and it always stays within
half a step of the reading. Where it crosses several readings in a pause, the joint was heated or
stood there, and the straight line across the pause says nothing of the recordings about it: in
these the temperature stays at the reading, or changes from a moment at which the register does, at
the rate of the recording, or at the mean rate of all.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers

_MIN_STEP = 0.5  # [°C]
_MAX_LEVELS = 400
_GRID_TOLERANCE = 1e-3
_CHANGE_INTERVAL = 2.0  # [s]
_CHANGE_INTERVAL_PERIODS = 3.0


@dataclass(frozen=True, slots=True)
class RegisterChanges:
    """Changes of a temperature register.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Midpoint between the samples before and after. [s]
    before, after : ndarray, shape (n,)
        Readings before and after. [°C]
    """

    time: Array
    before: Array
    after: Array


@dataclass(frozen=True, slots=True)
class Recordings:
    """Recordings of a temperature register in a run.

    Attributes
    ----------
    begin, end : ndarray, shape (recordings,)
        Times of their first and last reading, ascending. [s]
    reading : ndarray, shape (recordings,)
        Their last readings. [°C]
    """

    begin: Array
    end: Array
    reading: Array


@dataclass(frozen=True, slots=True)
class Knots:
    """Points between which the temperature is interpolated.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Ascending time. [s]
    value : ndarray, shape (n,)
        Temperature. [°C]
    step : float
        Step of the register. [°C]
    n_changes : int
        Changes of the register from which the knots come.
    """

    time: Array
    value: Array
    step: float
    n_changes: int


def longest_change_interval(period: float) -> float:
    """Return the longest time between two samples that still dates a change [s].

    Parameters
    ----------
    period : float
        Median time between samples. [s]
    """
    return max(_CHANGE_INTERVAL, _CHANGE_INTERVAL_PERIODS * period)


def find_changes(time: Array, reading: Array, *, longest: float) -> RegisterChanges:
    """Return the changes of a register between consecutive samples.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Ascending time. [s]
    reading : ndarray, shape (n,)
        Readings. [°C]
    longest : float
        Longest time between two samples that still dates a change. [s]

    Examples
    --------
    >>> import numpy as np
    >>> reading = np.array([20.0, 20.0, 21.0])
    >>> find_changes(np.array([0.0, 1.0, 2.0]), reading, longest=2.0).time
    array([1.5])
    """
    at = np.flatnonzero(reading[1:] != reading[:-1])
    at = at[time[at + 1] - time[at] <= longest]
    return RegisterChanges((time[at] + time[at + 1]) / 2, reading[at], reading[at + 1])


def find_step(levels: Array) -> float | None:
    """Return the step of a register, found from its distinct readings.

    Parameters
    ----------
    levels : ndarray, shape (n,)
        Distinct readings. [°C]

    Returns
    -------
    float or None
        The step; None where the readings lie on no grid of at least 0.5 °C, or there is only one.
        [°C]

    Examples
    --------
    >>> import numpy as np
    >>> find_step(np.array([20.0, 21.0, 25.0]))
    1.0
    """
    levels = np.unique(np.round(levels, 6))
    if len(levels) < 2 or is_continuous(levels):
        return None
    step = float(np.min(np.diff(levels)))
    steps = (levels - levels[0]) / step
    on_grid = np.all(np.abs(steps - np.round(steps)) < _GRID_TOLERANCE)
    return step if on_grid else None


def is_continuous(levels: Array) -> bool:
    """Return whether readings lie too close together, or are too many, for a quantized register.

    More readings cannot change the answer from true to false.

    Parameters
    ----------
    levels : ndarray, shape (n,)
        Distinct readings, ascending. [°C]
    """
    return len(levels) > _MAX_LEVELS or bool(np.min(np.diff(levels), initial=np.inf) < _MIN_STEP)


def interpolation_knots(
    changes: RegisterChanges, *, step: float, recordings: Recordings
) -> Knots | None:
    """Return the points between which the temperature is interpolated.

    Before the first and after the last change the temperature continues with the neighbouring slope
    to the middle of the reading's band; where the next change would be due only outside the run,
    it continues to the edge of the band.

    Parameters
    ----------
    changes : RegisterChanges
        All changes of a run, ascending in time.
    step : float
        Step of the register. [°C]
    recordings : Recordings
        The recordings of the run.

    Returns
    -------
    Knots or None
        None where fewer than two levels were crossed.
    """
    single = np.abs(np.abs(changes.after - changes.before) - step) < _GRID_TOLERANCE * step
    time, before, after = changes.time[single], changes.before[single], changes.after[single]
    value = (before + after) / 2
    edges = np.flatnonzero(np.diff(value)) + 1  # first of each group of equal values
    if not len(edges):
        return None
    slopes = (value[edges] - value[edges - 1]) / (time[edges] - time[edges - 1])
    turn_time, turn_value = _turns(time, value, after - value, edges, slopes, step)
    step_duration = step / np.abs(slopes[[0, -1]])  # before the first and after the last change
    remaining = np.array([time[0] - recordings.begin[0], recordings.end[-1] - time[-1]])
    fraction = np.where(remaining <= step_duration, 1.0, 0.5)
    ends = 2 * fraction * (np.array([before[0], after[-1]]) - value[[0, -1]]) + value[[0, -1]]
    head, tail = fraction * step_duration
    by_pauses = _beside_pauses(time, value, after - value, step, recordings)
    all_time = np.concatenate(([time[0] - head], time, turn_time, by_pauses[0], [time[-1] + tail]))
    all_value = np.concatenate(([ends[0]], value, turn_value, by_pauses[1], [ends[1]]))
    order = np.argsort(all_time, kind="stable")
    return Knots(all_time[order], all_value[order], step, len(time))


def _beside_pauses(
    time: Array, value: Array, towards: Array, step: float, recordings: Recordings
) -> tuple[Array, Array]:
    """Return time and value of knots at the ends of recordings before and after long changes.

    That is where the changes of the register next to an end are more than a step apart.
    """
    begin, end = recordings.begin, recordings.end
    first, beyond = np.searchsorted(time, begin), np.searchsorted(time, end, side="right")
    steady, several = first == beyond, beyond - first > 1
    mean_rate = len(time) * step / max(float(np.sum(end - begin)), 1e-9)
    rate = np.abs(np.diff(value)) / np.maximum(np.diff(time), 1e-9)

    def knots(at: Array, before: Numbers, own: Numbers, way: int) -> tuple[Array, Array]:
        """Return knots at ends, each after the change ``before``, with an own change or none."""
        there = (before >= 0) & (before < len(rate))
        low = np.clip(before, 0, len(rate) - 1)
        far = there & (np.abs(value[low + 1] - value[low]) > (1 + _GRID_TOLERANCE) * step)
        own = np.clip(own, 0, len(time) - 1)
        own_rate = rate[np.clip(own - (way > 0), 0, len(rate) - 1)]
        speed = np.where(several & (own_rate > 0), own_rate, mean_rate)
        moved = np.minimum(speed * np.abs(time[own] - at), step)
        changed = value[own] + way * np.sign(towards[own]) * moved
        return at[far], np.where(steady, recordings.reading, changed)[far]

    head, tail = knots(begin, first - 1, first, -1), knots(end, beyond - 1, beyond - 1, 1)
    return np.concatenate((head[0], tail[0])), np.concatenate((head[1], tail[1]))


def _turns(
    time: Array,
    value: Array,
    towards: Array,
    edges: Numbers,
    slopes: Array,
    step: float,
) -> tuple[Array, Array]:
    """Return time and value of knots where the temperature turns between two equal changes.

    The temperature leaves the value with the slope before it and returns with the slope after it.
    In between it goes no further than to the middle of the reading's band.
    """
    group = np.searchsorted(edges, np.arange(len(value)), side="right")
    all_slopes = np.concatenate(([-slopes[0]], slopes, [-slopes[-1]]))
    at = np.flatnonzero(np.diff(value) == 0)
    direction = np.sign(towards[at])
    leaving = all_slopes[group[at]] * direction
    returning = -all_slopes[group[at] + 1] * direction
    turning = (leaving > 0) & (returning > 0)
    at, direction = at[turning], direction[turning]
    leaving, returning = leaving[turning], returning[turning]
    pause = time[at + 1] - time[at]
    height = np.minimum(pause * leaving * returning / (leaving + returning), step / 2)
    turn = value[at] + direction * height
    return (
        np.concatenate((time[at] + height / leaving, time[at + 1] - height / returning)),
        np.concatenate((turn, turn)),
    )


def interpolate_temperature(knots: Knots, time: Array, reading: Array) -> Array:
    """Return the temperature interpolated between knots, within half a step of the reading.

    Parameters
    ----------
    knots : Knots
        Result of :func:`interpolation_knots`.
    time : ndarray, shape (n,)
        Time of the samples. [s]
    reading : ndarray, shape (n,)
        Readings of the register; NaN stays NaN. [°C]

    Returns
    -------
    ndarray, shape (n,)
        Temperature; the reading itself before the first and after the last knot. [°C]

    Examples
    --------
    >>> import numpy as np
    >>> knots = Knots(np.array([0.0, 10.0]), np.array([19.5, 20.5]), step=1.0, n_changes=2)
    >>> interpolate_temperature(knots, np.array([2.0, 5.0, 12.0]), np.array([20.0, 20.0, 21.0]))
    array([19.7, 20. , 21. ])
    """
    interpolated = np.interp(time, knots.time, knots.value)
    inside = (time > knots.time[0]) & (time < knots.time[-1])
    clipped = np.clip(interpolated, reading - knots.step / 2, reading + knots.step / 2)
    return np.where(inside, clipped, reading)
