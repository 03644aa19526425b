"""Velocity from positions: the slope of a short local fit, with real time stamps."""

from math import floor

import numpy as np

from frictioncli.arrays import Array

_HALF_SPAN = 0.03  # [s]
_MAX_HALF_WINDOW = 4
_GAP_PERIODS = 5.0


def half_window(period: float) -> int:
    """Return how many samples to each side the fit takes: at most 0.03 s and at most four.

    Parameters
    ----------
    period : float
        Median time between samples. [s]
    """
    return floor(min(max(_HALF_SPAN / period + 1e-9, 1.0), _MAX_HALF_WINDOW))


def max_gap(period: float) -> float:
    """Return the time [s] beyond which neighbours belong to different stretches."""
    return _GAP_PERIODS * period


def local_slope(
    time: Array,
    values: Array,
    *,
    half: int,
    gap: float,
) -> Array:
    """Return the slope of a straight line fitted around each sample.

    Exact for a ramp, at any spacing. The window shrinks to one side at the ends of a stretch, and
    no window reaches across a gap. Quantised values give noise of zero mean, no bias.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Ascending. [s]
    values : ndarray, shape (n,)
        What to differentiate.
    half : int
        Samples to each side.
    gap : float
        Neighbours further apart than this are not connected. [s]

    Returns
    -------
    ndarray, shape (n,)
        Slope per second; NaN for a sample without neighbours.
    """
    n = len(time)
    stretch = np.concatenate(([0], np.cumsum(np.diff(time) > gap))) if n else np.empty(0)
    count = np.ones(n)
    sum_t, sum_v, sum_tt, sum_tv = (np.zeros(n) for _ in range(4))
    for shift in range(1, min(half, n - 1) + 1):
        near = (stretch[shift:] == stretch[:-shift]).astype(float)
        dt = (time[shift:] - time[:-shift]) * near
        dv = (values[shift:] - values[:-shift]) * near
        # each neighbouring pair serves twice: as the later sample of one, the earlier of the other
        for part, sign in ((slice(None, n - shift), 1.0), (slice(shift, None), -1.0)):
            count[part] += near
            sum_t[part] += sign * dt
            sum_v[part] += sign * dv
            sum_tt[part] += dt * dt
            sum_tv[part] += dt * dv
    spread = sum_tt - sum_t**2 / count
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (sum_tv - sum_t * sum_v / count) / spread
    return np.where(count > 1, slope, np.nan)
