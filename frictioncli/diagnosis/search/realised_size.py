"""Sizes of random functions and of the drift as they were in the log, with intervals."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.columns import RANK
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.fit.mixed_model import MixedFit
from frictioncli.diagnosis.search.step import Step
from frictioncli.linear_algebra import orthonormal_basis


def realised(inner: Array, mean: Array, covariance: Array) -> tuple[float, tuple[float, float]]:
    """Return the RMS of a function whose coefficients have a normal distribution, with interval.

    From mean and variance of its mean square.

    Parameters
    ----------
    inner : ndarray, shape (columns, columns)
        Mean products of its columns.
    mean, covariance : ndarray, shape (columns,) and (columns, columns)
        Mean and covariance of their coefficients.

    Returns
    -------
    size, (low, high) : float, (float, float)
        The RMS and its 95 % interval.
    """
    product = inner @ covariance
    square = float(mean @ inner @ mean) + float(np.trace(product))
    variance = 2 * float(np.sum(product * product.T)) + 4 * float(mean @ product @ inner @ mean)
    reach = Z95 * np.sqrt(max(variance, 0.0))
    low, high = max(square - reach, 0.0), square + reach
    return float(np.sqrt(square)), (float(np.sqrt(low)), float(np.sqrt(high)))


def realised_drift(step: Step, fit: MixedFit, number: int) -> tuple[float, tuple[float, float]]:
    """Return the RMS of what the base leaves of the drift in one channel, with its interval.

    The variance of the noise model is that of other drifts of its kind too: a model of the grid
    that is slower than the drift itself has a greater one.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    fit : MixedFit
        Their fit, with the noise models of both channels.
    number : int
        0 for friction, 1 for load.

    Returns
    -------
    size, (low, high) : float, (float, float)
        The RMS and its 95 % interval. [N·m]
    """
    noises = step.precomputed.noises
    spectra = noises.spectra[number]
    model = fit.variances.noise[number]
    time, precision = noises.time_and_precision(number, model)
    spectrum = spectra.spectra[time]
    shown = step.columns.places.shown(number)
    residual = step.columns.modes(number, time) @ np.append(-fit.coefficients, 1.0)[shown]
    drift = 1 - precision
    root = np.sqrt(spectra.profile)[:, np.newaxis]
    modes = root * spectra.from_modes(spectrum, np.eye(len(drift)))
    base = orthonormal_basis(step.precomputed.base.channels[number].means, tolerance=RANK)
    left = modes - base @ (base.T @ modes)
    return realised(
        left.T @ left / len(left),
        drift * residual,
        np.diag(fit.variances.between[number] * drift),
    )
