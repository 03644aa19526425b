r"""P-values, Bayes factors, posterior probabilities and credible sets of candidate effects.

The test statistic is twice the log likelihood ratio of a candidate to the null hypothesis. At one
shape, with *k* coefficients and :math:`\nu` degrees of freedom of the noise whose scale is
estimated, :math:`F = \frac{\nu}{k} (e^{\Lambda/\nu} - 1)` has an F distribution under the null
hypothesis. A search over shapes tries as many as there are independent directions among their
columns; the p-value is corrected for their number (Bonferroni).

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
.. [3] J. Li and L. Ji, "Adjusting multiple testing in multilocus analyses using the eigenvalues of
   a correlation matrix," Heredity 95, 2005, doi:10.1038/sj.hdy.6800717 (there the fractions of
   greater eigenvalues count too, which makes the number jump where one is whole).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import stats

from frictioncli.arrays import Array

_PRIOR_VARIANCE = 100.0
"""Prior variance g of a coefficient, in units of its sampling variance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NullDistribution:
    """Distribution of a test statistic, the greatest over shapes, under the null hypothesis.

    Attributes
    ----------
    coefficients : int
        Number of coefficients at one shape; 0 where the data determine none.
    freedom : float
        Degrees of freedom of the noise whose scale is estimated.
    shapes : float
        Effective number of independent shapes tried.

    Examples
    --------
    >>> one = NullDistribution(coefficients=1, freedom=1e9)
    >>> round(one.p_value(3.841), 3)
    0.05
    >>> round(one.critical_value(0.05), 2)
    3.84
    """

    coefficients: int
    freedom: float
    shapes: float = 1.0

    def p_value(self, statistic: float) -> float:
        """Return the probability that noise alone gives more than a statistic."""
        if self.coefficients == 0 or statistic <= 0:
            return 1.0
        ratio = self.freedom / self.coefficients * np.expm1(min(statistic / self.freedom, 500.0))
        tail = float(stats.f.sf(ratio, self.coefficients, self.freedom))
        return min(1.0, self.shapes * tail)

    def critical_value(self, probability: float) -> float:
        """Return the statistic that noise alone exceeds with a probability."""
        if self.coefficients == 0:
            return float("inf")
        ratio = stats.f.isf(probability / self.shapes, self.coefficients, self.freedom)
        return float(self.freedom * np.log1p(ratio * self.coefficients / self.freedom))


def independent_directions(inner: Array, width: int) -> float:
    """Return the effective number of independent shapes among columns.

    Parameters
    ----------
    inner : ndarray, shape (shapes * width, shapes * width)
        Inner products of what the null hypothesis leaves of the columns, shape after shape.
    width : int
        Columns of each shape.

    Returns
    -------
    float
        From 1, where all shapes are alike, to their number, where they are orthogonal: the sum of
        the eigenvalues of the columns' correlation, of which each counts as one at most [3]_.

    Examples
    --------
    >>> import numpy as np
    >>> independent_directions(np.ones((3, 3)), 1), independent_directions(np.eye(3), 1)
    (1.0, 3.0)
    """
    size = np.sqrt(np.maximum(np.diagonal(inner), 0.0))
    present = size > 1e-9 * size.max(initial=0.0)
    if not present.any():
        return 1.0
    unit = inner[np.ix_(present, present)] / np.outer(size[present], size[present])
    count = float(np.sum(np.clip(np.linalg.eigvalsh(unit), 0.0, 1.0)))
    return max(count / width, 1.0)


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
