"""Signals as a log holds them: behind a delay and a filter of first order."""

import math

import numpy as np

from frictioncli.arrays import Array


def responded(values: Array, period: float, *, delay: float, time_constant: float) -> Array:
    """Return signals behind a filter of first order and a delay.

    Parameters
    ----------
    values : ndarray, shape (starts, samples)
        Signals, constant before their first sample and linear between samples.
    period : float
        Sampling period. [s]
    delay, time_constant : float
        Delay and time constant of the filter; no filter at 0. [s]

    Examples
    --------
    >>> step = np.array([[0.0, 0.0, 1.0, 1.0, 1.0, 1.0]])
    >>> responded(step, 0.01, delay=0.01, time_constant=0.0).round(3) + 0.0
    array([[0., 0., 0., 1., 1., 1.]])
    """
    samples = values.shape[1]
    response = np.eye(samples)
    if time_constant > 1e-3 * period:
        response = _filter_response(samples, period / time_constant)
    if delay != 0.0:
        from scipy.interpolate import CubicSpline  # slow to import, and only needed with ramps

        time = period * np.arange(samples)
        at = np.clip(time - delay, 0.0, time[-1])
        response = CubicSpline(time, response)(at)
    return np.asarray(values @ response.T)


def _filter_response(samples: int, ratio: float) -> Array:
    """Return the response of a filter of first order to each sample, shape (samples, samples).

    Parameters
    ----------
    samples : int
        Number of samples.
    ratio : float
        Sampling period over the time constant. [-]
    """
    memory = math.exp(-ratio)
    past, now = (1 - memory) / ratio - memory, 1 - (1 - memory) / ratio
    response = np.eye(samples)  # at first in balance with the first sample
    for number in range(1, samples):
        response[number] *= now
        response[number] += memory * response[number - 1]
        response[number, number - 1] += past
    return response
