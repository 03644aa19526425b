r"""By how much the coefficients of friction differ from run to run.

On another day a joint has another friction at the same speed, load and temperature, and all pairs
of that run share the difference. In run *r* each coefficient :math:`\kappa` of equation (16) is
therefore :math:`\kappa (1 + u_r)`, with independent normal shares *u* (random coefficients [1]_).
Their standard deviations have the restricted likelihood of the residuals [2]_ under the noise
within the runs. A few runs hardly tell them, and their prior then counts: a half-Cauchy
distribution [3]_. A single run tells nothing of other runs, and its differences count as none.

References
----------
.. [1] P. A. V. B. Swamy, "Efficient inference in a random coefficient regression model,"
   Econometrica 38(2), 1970, doi:10.2307/1913012.
.. [2] H. D. Patterson and R. Thompson, "Recovery of inter-block information when block sizes are
   unequal," Biometrika 58(3), 1971, doi:10.1093/biomet/58.3.545.
.. [3] A. Gelman, "Prior distributions for variance parameters in hierarchical models," Bayesian
   Analysis 1(3), 2006, doi:10.1214/06-BA117A.
"""

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.model.drift import run_starts
from frictioncli.model.noise import (
    Noise,
    orthonormal_basis,
    pair_covariance,
    plausible_noise,
)

_SHARES = np.geomspace(0.001, 0.1, 6)
"""Standard deviations that are weighted, as shares of the coefficients."""

_MEDIAN_SHARE = 0.005
"""Median of their prior: friction differs by half a per cent from day to day, or far more. [-]"""

FIRST_SHARE = 0.01
"""What coefficients are assumed to differ by until the runs tell. [-]"""

_LEAST_WEIGHT = 1e-4
"""Noises less plausible than this are left out."""


def noise_and_differences(
    contributions: Array,
    shares: Array,
    *,
    residual: Array,
    design: Array,
    time: Array,
    run: Indices,
    bins: Array,
    point: float,
) -> tuple[list[tuple[Noise, float]], Array]:
    """Return noises within the runs, and by how much coefficients differ between them.

    Parameters
    ----------
    contributions : ndarray, shape (coefficients, pairs)
        What each coefficient contributes to the friction of each pair. [N·m]
    shares : ndarray, shape (coefficients,)
        By how much they are assumed to differ while the noise is found. [-]
    residual : ndarray, shape (pairs,)
        Mean residual of each pair. [N·m]
    design : ndarray, shape (pairs, parameters)
        Derivatives of the model by the fitted parameters.
    time : ndarray, shape (pairs,)
        Times, growing within each run. [s]
    run : ndarray of int, shape (pairs,)
        Run of each pair; pairs of a run stand together.
    bins : ndarray, shape (pairs,)
        Angle bins of each pair.
    point : float
        Standard deviation of an angle bin, known from within the pairs. [N·m]

    Returns
    -------
    noises : list of (Noise, float)
        Noises with their probabilities, the most probable first.
    shares : ndarray, shape (coefficients,)
        Root mean squares of the standard deviations, as shares of the coefficients; 0 for a single
        run. [-]
    """
    starts, count = run_starts(run), len(contributions)
    shared = (contributions.T * shares).T if len(starts) > 1 else None
    noises = plausible_noise(
        residual=residual,
        design=design,
        time=time,
        run=run,
        bins=bins,
        point=point,
        shared=shared,
    )
    if shared is None:
        return noises, np.zeros(count)
    likely = [noise for noise, weight in noises if weight > _LEAST_WEIGHT]
    grid = np.stack(np.meshgrid(*[_SHARES] * count), axis=-1).reshape(-1, count)
    every = np.column_stack([contributions.T, orthonormal_basis(design), residual])
    logs = []
    for noise in likely:
        covariance = pair_covariance(noise, time=time, run=run, bins=bins)
        solved = covariance.solve(every)
        products = np.add.reduceat(every[:, :, np.newaxis] * solved[:, np.newaxis], starts)
        logs.append(_log_likelihoods(products, grid) - covariance.log_determinant / 2)
    weights = _weights(np.array(logs) + np.sum(_log_prior(grid), axis=1))
    again = list(zip(likely, np.sum(weights, axis=1).tolist(), strict=True))
    found = np.sqrt(np.sum(weights, axis=0) @ np.square(grid))
    return sorted(again, key=lambda entry: -entry[1]), np.asarray(found)


def difference_of_estimates(values: Array, variances: Array) -> float:
    """Return by how much a coefficient differs between runs that estimate it each on its own.

    Parameters
    ----------
    values : ndarray, shape (runs,)
        The estimates, relative to their mean. [-]
    variances : ndarray, shape (runs,)
        Their variances by noise within the runs. [-]

    Returns
    -------
    float
        Root mean square of the standard deviation. [-]
    """
    if len(values) < 2:
        return 0.0
    variance = variances + np.square(_SHARES)[:, np.newaxis]
    information = np.sum(1 / variance, axis=1, keepdims=True)
    mean = np.sum(values / variance, axis=1, keepdims=True) / information
    quadratic = np.sum(np.log(variance) + np.square(values - mean) / variance, axis=1)
    weights = _weights(_log_prior(_SHARES) - (quadratic + np.log(information[:, 0])) / 2)
    return float(np.sqrt(weights @ np.square(_SHARES)))


def _log_prior(share: Array) -> Array:
    """Return the logarithm of the prior density by the logarithm of the share."""
    return np.asarray(np.log(share) - np.log(np.square(share) + _MEDIAN_SHARE**2))


def _weights(logs: Array) -> Array:
    """Return probabilities that add up to 1."""
    weights = np.exp(logs - np.max(logs))
    return np.asarray(weights / np.sum(weights))


def _log_likelihoods(products: Array, grid: Array) -> Array:
    """Return restricted log likelihoods but for the determinant of the noise, shape (points,).

    Parameters
    ----------
    products : ndarray, shape (runs, columns, columns)
        Products of the columns by the inverse noise covariance: contributions of the coefficients,
        the fit and, last, the residuals.
    grid : ndarray, shape (points, coefficients)
        Standard deviations of the coefficients.
    """
    count = grid.shape[1]
    scaled = grid[:, np.newaxis, :, np.newaxis] * products[:, :count]
    inner = np.eye(count) + scaled[..., :count] * grid[:, np.newaxis, np.newaxis]
    across = scaled[..., count:]
    taken = np.sum(across.swapaxes(2, 3) @ np.linalg.solve(inner, across), axis=1)
    left = np.sum(products[:, count:, count:], axis=0) - taken
    information, right = left[:, :-1, :-1], left[:, :-1, -1:]
    explained = np.sum(right * np.linalg.solve(information, right), axis=(1, 2))
    determinant = np.sum(np.linalg.slogdet(inner)[1], axis=1) + np.linalg.slogdet(information)[1]
    return np.asarray(-0.5 * (determinant + left[:, -1, -1] - explained))
