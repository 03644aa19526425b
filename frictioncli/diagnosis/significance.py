"""How likely a score is by chance, and which effects it may stand for.

Searching a shape parameter gives chance more than one try. How many tries it is worth follows from
the columns themselves: scores of pure noise are drawn with the columns' own correlations.

References
----------
.. [1] J. Wakefield, "Bayes factors for genome-wide association studies: comparison with p-values,"
   Genet. Epidemiol. 33(1), 2009, doi:10.1002/gepi.20359 (approximate Bayes factor).
.. [2] G. Wang, A. Sarkar, P. Carbonetto and M. Stephens, "A simple new approach to variable
   selection in regression, with application to genetic fine mapping," J. R. Stat. Soc. B 82(5),
   2020, doi:10.1111/rssb.12388 (credible sets).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Array = NDArray[np.float64]

_DRAWS = 2000
_PRIOR_VARIANCE = 100.0
"""Variance of a coefficient before the data, in units of its sampling variance."""


def tries(columns: Array, generator: np.random.Generator) -> tuple[float, int]:
    """Return how many independent tries a search over shapes is worth, and its freedom.

    Parameters
    ----------
    columns : ndarray, shape (white rows, shapes, coefficients)
        Projected columns of an effect over the grid of its shapes.
    generator : Generator
        Source of the noise.

    Returns
    -------
    float, int
        Number of tries, at least 1; coefficients that the columns can tell.
    """
    rows, shapes, coefficients = columns.shape
    flat = columns.reshape(rows, shapes * coefficients)
    size = np.linalg.norm(flat, axis=0)
    size = np.where(size > 0, size, 1.0)
    gram = (flat / size).T @ (flat / size)
    strength, vectors = np.linalg.eigh(gram)
    kept = strength > 1e-9 * strength[-1]
    if not kept.any():
        return 1.0, 0
    root = vectors[:, kept] * np.sqrt(strength[kept])
    noise = generator.standard_normal((_DRAWS, int(kept.sum()))) @ root.T
    scores = np.zeros(_DRAWS)
    freedom = 0
    for i in range(shapes):
        part = slice(i * coefficients, (i + 1) * coefficients)
        block = gram[part, part]
        inverse = np.linalg.pinv(block, rcond=1e-9, hermitian=True)
        freedom = max(freedom, int(np.linalg.matrix_rank(block, tol=1e-9, hermitian=True)))
        drawn = noise[:, part]
        scores = np.maximum(scores, np.einsum("ij,jk,ik->i", drawn, inverse, drawn))
    if freedom == 0:
        return 1.0, 0
    limit = float(np.quantile(scores, 0.95))
    return max(0.05 / float(stats.chi2.sf(limit, freedom)), 1.0), freedom


def chance(statistic: float, freedom: int, count: float) -> float:
    """Return the probability that noise alone gives such a score in so many tries."""
    if freedom == 0:
        return 1.0
    once = float(stats.chi2.sf(statistic, freedom))
    return float(-np.expm1(count * np.log1p(-min(once, 1 - 1e-16))))


def log_evidence(grid: Array, freedom: int) -> float:
    """Return the logarithm of an effect's Bayes factor, averaged over its shapes [1]_.

    Parameters
    ----------
    grid : ndarray, shape (shapes,)
        Statistics over the grid of shapes.
    freedom : int
        Coefficients that the columns can tell.
    """
    share = _PRIOR_VARIANCE / (1 + _PRIOR_VARIANCE)
    logs = share * grid / 2 - freedom / 2 * np.log1p(_PRIOR_VARIANCE)
    return float(np.logaddexp.reduce(logs) - np.log(len(logs)))


def probabilities(evidence: Mapping[str, float]) -> dict[str, float]:
    """Return the probability of each effect if exactly one of them is at work, greatest first."""
    if not evidence:
        return {}
    highest = max(evidence.values())
    weights = {name: float(np.exp(value - highest)) for name, value in evidence.items()}
    total = sum(weights.values())
    ordered = sorted(weights, key=lambda name: -weights[name])
    return {name: weights[name] / total for name in ordered}


def credible_set(probability: Mapping[str, float], level: float = 0.95) -> tuple[str, ...]:
    """Return the fewest effects that together have at least this probability [2]_."""
    chosen: list[str] = []
    reached = 0.0
    for name, share in sorted(probability.items(), key=lambda entry: -entry[1]):
        chosen.append(name)
        reached += share
        if reached >= level:
            break
    return tuple(chosen)
