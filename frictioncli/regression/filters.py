r"""One zero-phase filter for both sides of the equation of motion.

Differentiating a measured position twice amplifies its noise. But if all terms of

.. math:: u = J \ddot\varphi + L(\varphi) + \operatorname{sign}(\dot\varphi)\, \tau

are averaged with the same weights :math:`h`, the acceleration need not be known: the average of
:math:`\ddot\varphi` is a weighted sum of positions [1]_, for weights made of two triangles of width
*W* the second difference of positions with the step *W*, averaged once.

References
----------
.. [1] M. Shinbrot, "On the analysis of linear and nonlinear systems," Trans. ASME 79(3), 1957,
   doi:10.1115/1.4013092 (method of modulating functions).
"""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from frictioncli.arrays import Array, Indices

STEP_TIMES = (0.025, 0.05, 0.1)
"""Widths of the triangles, from which the noise of the log chooses. [s]"""

_NUMEROV = np.array([1.0, 10.0, 1.0]) / 12.0
"""Makes a sampled triangle as wide as the continuous one, to the fourth order."""

_SLOPE = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""First derivative, exact for polynomials up to the fourth degree."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchedFilters:
    """Weights of the average of a signal, of its derivatives, and of those of the position.

    Attributes
    ----------
    step : int
        Width of the triangles; rows twice that far apart are nearly independent. [samples]
    half : int
        Samples to either side that the weights reach.
    mean : ndarray, shape (2 half + 1,)
        Weights of the average.
    slope, curvature : ndarray, shape (2 half + 1,)
        Weights of the same average of the first and second derivative. [1/s], [1/s²]
    jerk : ndarray, shape (2 half + 1,)
        The same of the third derivative. [1/s³]
    """

    step: int
    half: int
    mean: Array
    slope: Array
    curvature: Array
    jerk: Array


def filter_step(period: float, step_time: float = STEP_TIMES[0]) -> int:
    """Return the width of the filter's triangles, in samples.

    Parameters
    ----------
    period : float
        Sampling period. [s]
    step_time : float
        Wanted width; the weights reach twice as far to either side. [s]

    Examples
    --------
    >>> filter_step(0.004), filter_step(0.012), filter_step(0.5)
    (6, 2, 1)
    """
    # just below a half, so that the rounding of time stamps decides nothing
    return max(int(step_time / max(period, 1e-6) + 0.49), 1)


def matched_filters(step: int, period: float) -> MatchedFilters:
    r"""Return the weights of one zero-phase average and of its derivatives.

    Parameters
    ----------
    step : int
        Width *n* of the triangles. [samples]
    period : float
        Sampling period. [s]

    Returns
    -------
    MatchedFilters
        Weights at offsets from ``-half`` to ``half``.

    Notes
    -----
    With :math:`T` the triangle of width :math:`W = n \Delta t`,

    .. math:: \frac{\varphi(t + W) - 2 \varphi(t) + \varphi(t - W)}{W^2}
        = \int T(s)\, \ddot\varphi(t + s)\, \mathrm{d}s .

    Averaging that with :math:`T` again gives the curvature; the average that matches it is
    :math:`T * T`.

    Examples
    --------
    The average of a parabola's second derivative is exact:

    >>> import numpy as np
    >>> filters = matched_filters(2, 0.01)
    >>> time = 0.01 * np.arange(-filters.half, filters.half + 1)
    >>> round(float(filters.curvature @ (3 * time**2)), 6)
    6.0
    """
    half = 2 * step + 1
    box = np.full(step, 1.0 / step)
    triangle = np.convolve(box, box)
    second = np.zeros(2 * step + 1)
    second[[0, step, 2 * step]] = np.array([1.0, -2.0, 1.0]) / (step * period) ** 2
    mean = np.convolve(np.convolve(triangle, triangle), _NUMEROV)
    curvature = np.convolve(triangle, second)
    derivative = _SLOPE / period
    return MatchedFilters(
        step=step,
        half=half,
        mean=_padded(mean, half),
        slope=_padded(np.convolve(mean, derivative), half),
        curvature=_padded(curvature, half),
        jerk=_padded(np.convolve(curvature, derivative), half),
    )


def _padded(weights: Array, half: int) -> Array:
    return np.pad(weights, half - len(weights) // 2)


def filtered(values: Array, centre: Indices, *weights: Array) -> Array:
    """Return weighted sums of the neighbours of some samples.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        Evenly sampled signal.
    centre : ndarray of int, shape (rows,)
        The samples; their neighbours must exist.
    *weights : ndarray, shape (2 half + 1,)
        Weights at offsets from ``-half`` to ``half``, those of :func:`matched_filters`.

    Returns
    -------
    ndarray, shape (weights, rows)
        One row per weights.

    Examples
    --------
    >>> import numpy as np
    >>> filtered(np.arange(9.0), np.array([4, 5]), np.full(3, 1 / 3)).round(6)
    array([[4., 5.]])
    """
    if not len(centre):  # the signal may be shorter than the weights
        return np.empty((len(weights), 0))
    width = len(weights[0])
    windows = sliding_window_view(values, width)[centre - width // 2]
    return np.asarray((windows @ np.stack(weights, axis=1)).T)
