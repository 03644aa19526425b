r"""P-values, Bayes factors, posterior probabilities and credible sets of candidate effects.

The test statistic is twice the log likelihood ratio of a candidate to the null hypothesis. Its
shape parameters, and the noise model that suits it best, are searched, so that it is the greatest
of many statistics; its distribution under the null hypothesis is simulated: noise alone goes
through the same search. A gamma distribution with the simulated mean and variance gives p-values
below one over the number of draws.

With a normal prior on a coefficient of *g* times its sampling variance the Bayes factor of a
statistic :math:`\Lambda` with *k* coefficients is [1]_

.. math:: \ln B = \frac{g}{1 + g} \frac{\Lambda}{2} - \frac{k}{2} \ln(1 + g) .

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
"""Prior variance g of a coefficient, in units of its sampling variance."""


@dataclass(frozen=True, slots=True)
class NullDistribution:
    """Distribution of a test statistic under the null hypothesis: a gamma distribution.

    The statistic of one coefficient without a shape parameter is chi-squared with one degree of
    freedom, which is a gamma distribution; the greatest of many such is nearly one.

    Attributes
    ----------
    shape, scale : float
        Parameters of the gamma distribution; a scale of 0 where the null hypothesis has none, as
        for columns of zeros.

    Examples
    --------
    >>> chi_squared = NullDistribution(shape=0.5, scale=2.0)
    >>> round(chi_squared.p_value(3.841), 3)
    0.05
    >>> round(chi_squared.critical_value(0.05), 3)
    3.841
    """

    shape: float
    scale: float

    def p_value(self, statistic: float) -> float:
        """Return the probability that noise alone gives more than a statistic."""
        if self.scale == 0.0:
            return 1.0
        return float(stats.gamma.sf(statistic, self.shape, scale=self.scale))

    def critical_value(self, probability: float) -> float:
        """Return the statistic that noise alone exceeds with a probability."""
        if self.scale == 0.0:
            return float("inf")
        return float(stats.gamma.isf(probability, self.shape, scale=self.scale))


def fit_null_distribution(drawn: Array) -> NullDistribution:
    """Return the gamma distribution with the mean and variance of simulated statistics.

    Parameters
    ----------
    drawn : ndarray, shape (draws,)
        Statistics of noise alone.

    Examples
    --------
    >>> import numpy as np
    >>> fit_null_distribution(np.array([1.0, 3.0]))
    NullDistribution(shape=4.0, scale=0.5)
    """
    if len(drawn) < 2 or not np.var(drawn) > 0:
        return NullDistribution(1.0, 0.0)
    mean, variance = float(np.mean(drawn)), float(np.var(drawn))
    return NullDistribution(mean**2 / variance, variance / mean)


def log_bayes_factor(grid: Array, freedom: int) -> float:
    """Return the logarithm of an effect's Bayes factor, averaged over its shapes [1]_.

    Parameters
    ----------
    grid : ndarray, shape (shapes,)
        Twice the log likelihood ratio at each shape of the grid.
    freedom : int
        Number of coefficients that the data determine.

    Examples
    --------
    >>> import numpy as np
    >>> round(log_bayes_factor(np.array([20.0]), freedom=1), 2)
    7.59
    """
    share = _PRIOR_VARIANCE / (1 + _PRIOR_VARIANCE)
    logs = share * grid / 2 - freedom / 2 * np.log1p(_PRIOR_VARIANCE)
    return float(np.logaddexp.reduce(logs) - np.log(len(logs)))


def posterior_probabilities(log_bayes_factors: Mapping[str, float]) -> dict[str, float]:
    """Return the probability of each effect if exactly one of them is at work, greatest first.

    Parameters
    ----------
    log_bayes_factors : mapping of str to float
        Logarithm of each effect's Bayes factor; all are equally probable beforehand.

    Examples
    --------
    >>> posterior_probabilities({"drift": 0.0, "run_in": 0.0})
    {'drift': 0.5, 'run_in': 0.5}
    """
    if not log_bayes_factors:
        return {}
    highest = max(log_bayes_factors.values())
    weights = {name: float(np.exp(value - highest)) for name, value in log_bayes_factors.items()}
    total = sum(weights.values())
    ordered = sorted(weights, key=lambda name: -weights[name])
    return {name: weights[name] / total for name in ordered}


def credible_set(probability: Mapping[str, float], level: float = 0.95) -> tuple[str, ...]:
    """Return the fewest effects that together have at least this probability [2]_.

    Parameters
    ----------
    probability : mapping of str to float
        Probability of each effect.
    level : float, optional
        Probability that the set must reach.

    Examples
    --------
    >>> credible_set({"drift": 0.7, "run_in": 0.28, "inertia": 0.02})
    ('drift', 'run_in')
    """
    chosen: list[str] = []
    reached = 0.0
    for name, share in sorted(probability.items(), key=lambda entry: -entry[1]):
        chosen.append(name)
        reached += share
        if reached >= level:
            break
    return tuple(chosen)
