r"""P-values, Bayes factors, posterior probabilities and credible sets of candidate effects.

The test statistic is twice the log likelihood ratio of a candidate to the null hypothesis. At one
shape, with *k* coefficients and :math:`\nu` degrees of freedom of the noise whose scale is
estimated, :math:`F = \frac{\nu}{k} (e^{\Lambda/\nu} - 1)` has an F distribution under the null
hypothesis. A search over shapes is corrected for their effective number (Bonferroni).

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
.. [3] R. M. Karp, M. Luby and N. Madras, "Monte-Carlo approximation algorithms for enumeration
   problems," J. Algorithms 10(3), 1989, doi:10.1016/0196-6774(89)90038-2 (probability of a union).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import special

from frictioncli.arrays import Array
from frictioncli.distributions import f_exceeded, f_tail
from frictioncli.linear_algebra import orthonormal_basis, unit_columns

_PRIOR_VARIANCE = 100.0
"""Prior variance g of a coefficient, in units of its sampling variance."""

_LEVEL = 1e-4
"""Significance level of a single shape at which shapes are counted: 5 % shared among the effects of
a catalogue and some shapes of each."""

_DRAWS = 2000
"""Draws of white noise by which they are counted."""

_SHORT = 1e-9
"""Share of the longest column's length below which one counts as nothing."""


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
        tail = f_tail(ratio, self.coefficients, self.freedom)
        return min(1.0, self.shapes * tail)

    def critical_value(self, probability: float) -> float:
        """Return the statistic that noise alone exceeds with a probability."""
        if self.coefficients == 0:
            return float("inf")
        ratio = f_exceeded(probability / self.shapes, self.coefficients, self.freedom)
        return float(self.freedom * np.log1p(ratio * self.coefficients / self.freedom))


def effective_shapes(inner: Array, width: int) -> float:
    r"""Return the effective number of independent shapes that a search tries.

    By how much oftener any of all shapes is significant in white noise than a single one, at a
    level such as a search of a whole catalogue needs. In noise in which one shape is significant,
    *n* of all are; that any is has the probability of a single one times :math:`\sum_i
    \operatorname{E} 1/n` over the shapes [3]_. The mean is taken over draws.

    Parameters
    ----------
    inner : ndarray, shape (shapes * width, shapes * width)
        Inner products of what the null hypothesis leaves of the columns, shape after shape.
    width : int
        Columns of each shape.

    Returns
    -------
    float
        From 1, where all shapes are alike, to their number.

    Examples
    --------
    >>> import numpy as np
    >>> effective_shapes(np.ones((3, 3)), 1), round(effective_shapes(np.eye(3), 1), 1)
    (1.0, 3.0)
    """
    size = np.sqrt(np.maximum(np.diagonal(inner), 0.0))
    size = np.where(size > _SHORT * size.max(initial=0.0), size, np.inf)
    values, vectors = np.linalg.eigh(inner / np.outer(size, size))
    kept = values > _SHORT
    columns = np.sqrt(values[kept])[:, np.newaxis] * vectors[:, kept].T
    spans = _spans(columns, width)
    if not spans:
        return 1.0
    generator = np.random.default_rng(0)
    noise = generator.standard_normal((len(spans), max(_DRAWS // len(spans), 2), len(columns)))
    for own, span in zip(noise, spans, strict=True):
        along = own @ span
        # the length along this shape is drawn from the tail beyond its critical value
        tail = special.chdtri(span.shape[1], _LEVEL * generator.random((len(own), 1)))
        wanted = along * np.sqrt(tail / np.sum(np.square(along), axis=1, keepdims=True))
        own += (wanted - along) @ span.T
    ranks = np.array([span.shape[1] for span in spans])
    squares = np.square(noise.reshape(-1, len(columns)) @ np.hstack(spans))
    lengths = np.add.reduceat(squares, np.cumsum(ranks) - ranks, axis=1)
    number = np.sum(lengths > special.chdtri(ranks, _LEVEL) * (1 - 1e-9), axis=1)
    return float(np.sum(np.mean(1 / number.reshape(noise.shape[:2]), axis=1)))


def _spans(columns: Array, width: int) -> list[Array]:
    """Return an orthonormal basis of the columns of each shape, of those that have any."""
    if width == 1:
        unit = unit_columns(columns)
        return np.split(unit, unit.shape[1], axis=1) if unit.size else []
    groups = np.split(columns, columns.shape[1] // width, axis=1)
    spans = [orthonormal_basis(np.asfortranarray(one), tolerance=1e-4) for one in groups]
    return [one for one in spans if one.shape[1]]


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


def statistic_of(log_factor: float, freedom: int, shapes: float = 1.0) -> float:
    """Return the test statistic at one shape that gives an effect a log Bayes factor.

    Parameters
    ----------
    log_factor : float
        Logarithm of the Bayes factor, averaged over the shapes.
    freedom : int
        Number of coefficients that the data determine.
    shapes : float, optional
        Effective number of shapes; the others explain nothing.

    Examples
    --------
    >>> round(statistic_of(log_bayes_factor(np.array([20.0]), 1), 1), 6)
    20.0
    """
    share = _PRIOR_VARIANCE / (1 + _PRIOR_VARIANCE)
    penalty = freedom / 2 * float(np.log1p(_PRIOR_VARIANCE)) + float(np.log(shapes))
    return 2 * (log_factor + penalty) / share


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
