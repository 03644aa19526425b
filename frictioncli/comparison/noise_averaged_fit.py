"""Generalised least squares averaged over plausible noises, and what a design can estimate."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import gram_inverse
from frictioncli.model.noise import Noise, pair_covariance

RANK = 1e-5
"""Singular values of a design with unit columns below this count as zero."""

_LEAST_PLAUSIBILITY = 1e-3
"""Noises less plausible than this are left out."""


def noise_averaged_fit(
    design: Array,
    residual: Array,
    noises: Sequence[tuple[Noise, float]],
    *,
    time: Array,
    run: Indices,
    bins: Array,
    count: int,
) -> tuple[Array, Array]:
    """Return the first coefficients of a design and their covariance, averaged over noises.

    Parameters
    ----------
    design : ndarray, shape (pairs, columns)
        Columns of length 1.
    residual : ndarray, shape (pairs,)
        Values to fit. [N·m]
    noises : sequence of (Noise, float)
        Noises and their plausibility, from :func:`frictioncli.model.noise.plausible_noise`.
    time : ndarray, shape (pairs,)
        Time of each pair. [s]
    run : ndarray of int, shape (pairs,)
        Number of its run.
    bins : ndarray, shape (pairs,)
        Number of its angle bins.
    count : int
        Number of coefficients to return.

    Returns
    -------
    coefficients : ndarray, shape (count,)
        Mean of the estimates under each noise, weighted by plausibility.
    covariance : ndarray, shape (count, count)
        Mean of their covariances, plus the covariance of the estimates over the noises.
    """
    likely = [(noise, weight) for noise, weight in noises if weight > _LEAST_PLAUSIBILITY]
    estimates, covariances = [], []
    for noise, _ in likely:
        noise_covariance = pair_covariance(noise, time=time, run=run, bins=bins)
        solved = noise_covariance.solve(design)
        inverse = gram_inverse(design.T @ solved, tolerance=RANK**2)
        estimates.append((inverse @ (solved.T @ residual))[:count])
        covariances.append(inverse[:count, :count])
    weights = np.array([weight for _, weight in likely])
    weights /= weights.sum()
    mean = np.asarray(weights @ np.array(estimates))
    deviation = np.array(estimates) - mean
    covariance = (
        np.tensordot(weights, np.array(covariances), axes=1) + (deviation.T * weights) @ deviation
    )
    return mean, np.asarray(covariance)


def is_estimable(design: Array, contrasts: Array) -> bool:
    """Return whether contrasts of the coefficients lie in the row space of a design.

    Runs at different temperatures, for example, cannot be compared.

    Parameters
    ----------
    design : ndarray, shape (rows, columns)
        Columns of length 1.
    contrasts : ndarray, shape (contrasts, columns)
        Linear combinations of the coefficients.

    Examples
    --------
    >>> design = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5]])
    >>> is_estimable(design, np.array([[1.0, -1.0, 0.0]]))
    True
    >>> is_estimable(design, np.array([[0.0, 0.0, 1.0]]))
    False
    """
    length = np.linalg.norm(contrasts, axis=1, keepdims=True)
    unit = contrasts / np.maximum(length, 1e-300)
    rank = np.linalg.matrix_rank(design, tol=RANK)
    return bool(np.linalg.matrix_rank(np.vstack([design, unit]), tol=RANK) == rank)
