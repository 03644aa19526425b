"""A temperature register that shows whole degrees, rebuilt to a continuous temperature.

Between two samples of which the second shows another step, the true temperature is known: half way
between the two steps, if the register rounds (a register that truncates gives a constant offset of
half a step). Between such moments the temperature is interpolated in time, also across pauses, and
it never leaves the band of the reading.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers

_MIN_STEP = 0.5  # [°C]
_MAX_LEVELS = 400
_GRID_TOLERANCE = 1e-3
_LONGEST_WAIT = 2.0  # [s]
_LONGEST_WAIT_PERIODS = 3.0


@dataclass(frozen=True, slots=True)
class Changes:
    """Known moments of change.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Middle between the samples before and after. [s]
    before, after : ndarray, shape (n,)
        Readings on both sides. [°C]
    """

    time: Array
    before: Array
    after: Array


@dataclass(frozen=True, slots=True)
class Knots:
    """Moments [s] and the temperature [°C] taken as known there; ``n_changes`` of them were seen.

    ``step`` is the register's. [°C]
    """

    time: Array
    value: Array
    step: float
    n_changes: int


def longest_change_interval(period: float) -> float:
    """Return the longest time [s] between two samples that still tells when a change was."""
    return max(_LONGEST_WAIT, _LONGEST_WAIT_PERIODS * period)


def find_changes(time: Array, reading: Array, *, wait: float) -> Changes:
    """Return the changes of a register between consecutive samples.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Ascending. [s]
    reading : ndarray, shape (n,)
        What it showed. [°C]
    wait : float
        Samples further apart do not tell when the change was. [s]
    """
    at = np.flatnonzero(reading[1:] != reading[:-1])
    at = at[time[at + 1] - time[at] <= wait]
    return Changes((time[at] + time[at + 1]) / 2, reading[at], reading[at + 1])


def find_step(levels: Array) -> float | None:
    """Return the step of a register from the distinct readings it showed.

    None where they lie on no grid of at least 0.5 °C, or there is only one.

    Parameters
    ----------
    levels : ndarray, shape (n,)
        Distinct readings. [°C]
    """
    levels = np.unique(np.round(levels, 6))
    if len(levels) < 2 or is_continuous(levels):
        return None
    step = float(np.min(np.diff(levels)))
    steps = (levels - levels[0]) / step
    on_grid = np.all(np.abs(steps - np.round(steps)) < _GRID_TOLERANCE)
    return step if on_grid else None


def is_continuous(levels: Array) -> bool:
    """Tell whether some readings, whatever others follow, rule a register of steps out.

    Parameters
    ----------
    levels : ndarray, shape (n,)
        Distinct readings, ascending. [°C]
    """
    return len(levels) > _MAX_LEVELS or bool(np.min(np.diff(levels), initial=np.inf) < _MIN_STEP)


def knots(changes: Changes, *, step: float, span: tuple[float, float]) -> Knots | None:
    """Return the moments to interpolate between; None when fewer than two levels were crossed.

    Before the first and after the last change the temperature goes on with the neighbouring slope
    to the middle of the reading's band, or beyond where it is so slow that no change was due.

    Parameters
    ----------
    changes : Changes
        Of a whole run, ascending in time.
    step : float
        Step of the register. [°C]
    span : tuple of float
        First and last time of the run. [s]
    """
    single = np.abs(np.abs(changes.after - changes.before) - step) < _GRID_TOLERANCE * step
    time, before, after = changes.time[single], changes.before[single], changes.after[single]
    value = (before + after) / 2
    edges = np.flatnonzero(np.diff(value)) + 1  # first knot of each stretch of equal values
    if not len(edges):
        return None
    slopes = (value[edges] - value[edges - 1]) / (time[edges] - time[edges - 1])
    turn_time, turn_value = _turns(time, value, after - value, edges, slopes, step)
    whole = step / np.abs(slopes[[0, -1]])  # how long a whole step takes before and after
    rest = np.array([time[0] - span[0], span[1] - time[-1]])
    part = np.where(rest <= whole, 1.0, 0.5)
    ends = 2 * part * (np.array([before[0], after[-1]]) - value[[0, -1]]) + value[[0, -1]]
    head, tail = part * whole
    all_time = np.concatenate(([time[0] - head], time, turn_time, [time[-1] + tail]))
    all_value = np.concatenate(([ends[0]], value, turn_value, [ends[1]]))
    order = np.argsort(all_time, kind="stable")
    return Knots(all_time[order], all_value[order], step, len(time))


def _turns(
    time: Array,
    value: Array,
    towards: Array,
    edges: Numbers,
    slopes: Array,
    step: float,
) -> tuple[Array, Array]:
    """Return points where the temperature turns between two changes at the same value.

    There it leaves the value with the slope from before, comes back with the slope of after, and
    in between goes no further than to the middle of the reading's band.
    """
    stretch = np.searchsorted(edges, np.arange(len(value)), side="right")
    known = np.concatenate(([-slopes[0]], slopes, [-slopes[-1]]))
    at = np.flatnonzero(np.diff(value) == 0)
    direction = np.sign(towards[at])
    leaving = known[stretch[at]] * direction
    returning = -known[stretch[at] + 1] * direction
    turning = (leaving > 0) & (returning > 0)
    at, direction = at[turning], direction[turning]
    leaving, returning = leaving[turning], returning[turning]
    pause = time[at + 1] - time[at]
    height = np.minimum(pause * leaving * returning / (leaving + returning), step / 2)
    high = value[at] + direction * height
    return (
        np.concatenate((time[at] + height / leaving, time[at + 1] - height / returning)),
        np.concatenate((high, high)),
    )


def rebuild(points: Knots, time: Array, reading: Array) -> Array:
    """Return the rebuilt temperature [°C], always within half a step of the reading.

    Outside the known moments it is the reading itself.

    Parameters
    ----------
    points : Knots
        From :func:`knots`.
    time, reading : ndarray, shape (n,)
        Samples; NaN readings stay NaN. [s, °C]
    """
    smooth = np.interp(time, points.time, points.value)
    inside = (time > points.time[0]) & (time < points.time[-1])
    clipped = np.clip(smooth, reading - points.step / 2, reading + points.step / 2)
    return np.where(inside, clipped, reading)
