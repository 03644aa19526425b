"""Velocity from positions: slope of a local least-squares line, at the actual time stamps."""

from math import floor

import numpy as np

from frictioncli.arrays import Array

_HALF_SPAN = 0.03  # [s]
_MAX_HALF_WINDOW = 4
_GAP_PERIODS = 5.0


def half_window(period: float) -> int:
    """Return the samples to each side of a local fit: 1 to 4, within 0.03 s where possible.

    Parameters
    ----------
    period : float
        Median time between samples. [s]

    Examples
    --------
    >>> half_window(0.004), half_window(0.012), half_window(0.1)
    (4, 2, 1)
    """
    return floor(min(max(_HALF_SPAN / period + 1e-9, 1.0), _MAX_HALF_WINDOW))


def max_gap(period: float) -> float:
    """Return the time between neighbours above which they are not connected [s].

    Parameters
    ----------
    period : float
        Median time between samples. [s]
    """
    return _GAP_PERIODS * period


def local_slope(
    time: Array,
    values: Array,
    *,
    half: int,
    gap: float,
) -> Array:
    """Return the slope of a least-squares line fitted around each sample.

    The slope of a ramp is exact at any spacing of the samples. The window is one-sided at the
    ends, and it never reaches across a gap. Quantization adds noise of zero mean, no bias.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Ascending time. [s]
    values : ndarray, shape (n,)
        Values to differentiate.
    half : int
        Samples to each side.
    gap : float
        Neighbours further apart than this are not connected. [s]

    Returns
    -------
    ndarray, shape (n,)
        Slope per second; NaN for a sample without neighbours.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.array([0.0, 0.1, 0.3, 9.0])
    >>> local_slope(time, 2 * time, half=1, gap=0.5)
    array([ 2.,  2.,  2., nan])
    """
    n = len(time)
    group = np.concatenate(([0], np.cumsum(np.diff(time) > gap))) if n else np.empty(0)
    count = np.ones(n)
    sum_t, sum_v, sum_tt, sum_tv = (np.zeros(n) for _ in range(4))
    for shift in range(1, min(half, n - 1) + 1):
        connected = (group[shift:] == group[:-shift]).astype(float)
        dt = (time[shift:] - time[:-shift]) * connected
        dv = (values[shift:] - values[:-shift]) * connected
        # each pair of neighbours counts for both of its samples
        for samples, sign in ((slice(None, n - shift), 1.0), (slice(shift, None), -1.0)):
            count[samples] += connected
            sum_t[samples] += sign * dt
            sum_v[samples] += sign * dv
            sum_tt[samples] += dt * dt
            sum_tv[samples] += dt * dv
    spread = sum_tt - sum_t**2 / count
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (sum_tv - sum_t * sum_v / count) / spread
    return np.where(count > 1, slope, np.nan)
