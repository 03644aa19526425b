"""How likely a score is by chance, and which effects it may stand for.

Searching a shape parameter, and the noise that suits a rival best, gives chance more than one try.
What it makes of them is drawn: noise alone goes through the same search.

References
----------
.. [1] J. Wakefield, "Bayes factors for genome-wide association studies: comparison with p-values,"
   Genet. Epidemiol. 33(1), 2009, doi:10.1002/gepi.20359 (approximate Bayes factor).
.. [2] G. Wang, A. Sarkar, P. Carbonetto and M. Stephens, "A simple new approach to variable
   selection in regression, with application to genetic fine mapping," J. R. Stat. Soc. B 82(5),
   2020, doi:10.1111/rssb.12388 (credible sets).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import stats

from frictioncli.arrays import Array

_PRIOR_VARIANCE = 100.0
"""Variance of a coefficient before the data, in units of its sampling variance."""


@dataclass(frozen=True, slots=True)
class Chance:
    """What noise alone gives a hypothesis over all its shapes: a gamma distribution.

    One coefficient without a shape gives a chi-squared score of one degree of freedom, which is a
    gamma distribution; the greatest of many such is nearly one.
    """

    shape: float
    scale: float

    def beyond(self, statistic: float) -> float:
        """Return the probability that noise gives more."""
        if self.scale == 0.0:
            return 1.0
        return float(stats.gamma.sf(statistic, self.shape, scale=self.scale))

    def limit(self, probability: float) -> float:
        """Return what noise exceeds with this probability."""
        if self.scale == 0.0:
            return float("inf")
        return float(stats.gamma.isf(probability, self.shape, scale=self.scale))


def chance_of(drawn: Array) -> Chance:
    """Return the chance that draws of noise show, shape (draws,)."""
    if len(drawn) < 2 or not np.var(drawn) > 0:
        return Chance(1.0, 0.0)
    mean, variance = float(np.mean(drawn)), float(np.var(drawn))
    return Chance(mean**2 / variance, variance / mean)


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
