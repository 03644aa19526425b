"""Signals as a log holds them: behind a delay and a filter of first order."""

import math

import numpy as np

from frictioncli.arrays import Array


def responded(
    values: Array, period: float, *, delay: float, time_constant: float, stride: int = 1
) -> Array:
    """Return signals behind a filter of first order and a delay.

    Parameters
    ----------
    values : ndarray, shape (starts, samples)
        Signals, constant before their first sample. They are linear between the samples of a log,
        and where only some of these are given, at those in between on a cubic spline.
    period : float
        Sampling period of the log. [s]
    delay, time_constant : float
        Delay and time constant of the filter; no filter at 0. [s]
    stride : int, optional
        Sampling periods from one sample of the signals to the next.

    Examples
    --------
    >>> step = np.array([[0.0, 0.0, 1.0, 1.0, 1.0, 1.0]])
    >>> responded(step, 0.01, delay=0.01, time_constant=0.0).round(3) + 0.0
    array([[0., 0., 0., 1., 1., 1.]])
    """
    samples = values.shape[1]
    response = np.eye(samples)
    if time_constant > 1e-3 * period:
        response = _filter_response(samples, period / time_constant, stride)
    if delay != 0.0:
        from scipy.interpolate import CubicSpline  # slow to import, and only needed with ramps

        time = stride * period * np.arange(samples)
        at = np.clip(time - delay, 0.0, time[-1])
        response = CubicSpline(time, response)(at)
    return np.asarray(values @ response.T)


def _filter_response(samples: int, ratio: float, stride: int) -> Array:
    """Return the response of a filter of first order to each sample, shape (samples, samples).

    Parameters
    ----------
    samples : int
        Number of samples.
    ratio : float
        Sampling period of the log over the time constant. [-]
    stride : int
        Sampling periods from one sample to the next.
    """
    memory = math.exp(-ratio)
    past, now = (1 - memory) / ratio - memory, 1 - (1 - memory) / ratio
    # the filter at the end of a stride, from the signal at each sampling period within
    weight = np.zeros(stride + 1)
    for number in range(stride):
        weight *= memory
        weight[number : number + 2] += past, now
    response = np.eye(samples)  # at first in balance with the first sample
    response[1:] = _stride_means(weight, samples)
    memory_of_stride = memory**stride
    for number in range(1, samples):
        response[number] += memory_of_stride * response[number - 1]
    return response


def _stride_means(weight: Array, samples: int) -> Array:
    """Return weighted sums of signals over each stride, shape (samples - 1, samples).

    Parameters
    ----------
    weight : ndarray, shape (stride + 1,)
        Weight at each sampling period from one sample to the next.
    samples : int
        Number of samples.
    """
    stride = len(weight) - 1
    signals = np.eye(samples)
    if stride == 1:
        return np.asarray(weight[0] * signals[:-1] + weight[1] * signals[1:])
    from scipy.interpolate import CubicSpline  # slow to import, and only needed with ramps

    between = CubicSpline(np.arange(samples), signals)
    parts = [
        one * between(np.arange(samples - 1) + number / stride) for number, one in enumerate(weight)
    ]
    return np.asarray(sum(parts))
