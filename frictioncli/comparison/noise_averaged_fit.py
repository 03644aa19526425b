"""Least squares under a noise that is not quite known, and what a design can tell at all."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import gram_inverse
from frictioncli.model.noise import Noise, pair_covariance

RANK = 1e-5
"""Share of a design of unit columns below which a direction counts as absent."""

_LIKELY = 1e-3
"""Noises less plausible than this change nothing."""


def averaged_fit(
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
        What they are fitted to. [N·m]
    noises : sequence of (Noise, float)
        Noises and how plausible they are, as of :func:`frictioncli.model.noise.plausible_noise`.
    time, run, bins : ndarray, shape (pairs,)
        Of the pairs, as there.
    count : int
        How many coefficients are wanted.

    Returns
    -------
    ndarray, shape (count,), and ndarray, shape (count, count)
        Generalised least squares under each noise, averaged.
    """
    likely = [(noise, weight) for noise, weight in noises if weight > _LIKELY]
    found, spread = [], []
    for noise, _ in likely:
        truth = pair_covariance(noise, time=time, run=run, bins=bins)
        solved = truth.solve(design)
        inverse = gram_inverse(design.T @ solved, tolerance=RANK**2)
        found.append((inverse @ (solved.T @ residual))[:count])
        spread.append(inverse[:count, :count])
    weights = np.array([weight for _, weight in likely])
    weights /= weights.sum()
    mean = np.asarray(weights @ np.array(found))
    away = np.array(found) - mean
    covariance = np.tensordot(weights, np.array(spread), axes=1) + (away.T * weights) @ away
    return mean, np.asarray(covariance)


def estimable(design: Array, contrasts: Array) -> bool:
    """Tell whether a design can tell contrasts of its coefficients, shape (contrasts, columns).

    Runs that were each at a temperature of their own, say, cannot be compared.
    """
    size = np.linalg.norm(contrasts, axis=1, keepdims=True)
    asked = contrasts / np.maximum(size, 1e-300)
    rank = np.linalg.matrix_rank(design, tol=RANK)
    return bool(np.linalg.matrix_rank(np.vstack([design, asked]), tol=RANK) == rank)
