r"""How a level may differ from day to day without any change, and what that makes of a difference.

Levels *z* of runs, in percent of the mean friction, are what changes and what does not:

.. math:: z = X \beta + u, \quad u \sim N(0, \varphi V), \quad
    V = C + \sigma_0^2 I + \kappa_1^2 a a^T + \kappa_2^2 q q^T

*C* is the noise within the runs, :math:`\sigma_0` the scatter from day to day, *a* the surroundings
of each run against their mean in tens of °C and :math:`q = a^2`: a joint in the cold is not the
same at the same motor temperature, as its gear and housing are colder. :math:`\varphi` is how much
more or less than that the runs differ, with a scaled inverse chi-squared prior of
:math:`\nu_0` degrees of freedom about 1. So the interval of a difference is Student's with
:math:`\nu_0 + n - p` degrees of freedom: with two runs it rests on what is assumed, with many on
what they show [1]_, [2]_.

References
----------
.. [1] A. Gelman et al., Bayesian Data Analysis, 3rd ed., 2013, chapter 14 (normal regression with
   a conjugate prior).
.. [2] G. K. Smyth, "Linear models and empirical Bayes methods for assessing differential expression
   in microarray experiments," Stat. Appl. Genet. Mol. Biol. 3(1), 2004, doi:10.2202/1544-6115.1027
   (the moderated t-statistic).
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from frictioncli.arrays import Array

PRIOR_FREEDOM = 3.0
"""Runs' worth of trust in the assumed scatter."""

_LINEAR = 4.0
"""Assumed standard deviation of the effect of surroundings. [% per 10 °C]"""

_CURVED = 2.0
"""And of its curvature. [% per (10 °C)²]"""

_UNKNOWN = 10.0
"""Assumed standard deviation from day to day where no temperature is known. [%]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scatter:
    """The covariance of levels that do not change, but for a factor that the runs tell.

    Attributes
    ----------
    covariance : ndarray, shape (runs, runs)
        V. [%²]
    surroundings : ndarray, shape (runs, runs)
        The part of it that the surroundings make. [%²]
    """

    covariance: Array
    surroundings: Array

    @classmethod
    def of(cls, within: Array, surroundings: Array, day_to_day: float) -> "Scatter":
        """Return the scatter of runs.

        Parameters
        ----------
        within : ndarray, shape (runs, runs)
            Covariance by noise within the runs. [%²]
        surroundings : ndarray, shape (runs,)
            Temperature of the surroundings of each run; NaN where unknown. [°C]
        day_to_day : float
            Assumed standard deviation from day to day. [%]
        """
        away = (surroundings - surroundings.mean()) / 10.0
        warmth = _LINEAR**2 * np.outer(away, away) + _CURVED**2 * np.outer(away**2, away**2)
        if not np.isfinite(surroundings).all():
            warmth = _UNKNOWN**2 * np.eye(len(within))
        own = within + day_to_day**2 * np.eye(len(within))
        return cls(covariance=own + warmth, surroundings=warmth)

    def fitted(self, levels: Array, design: Array) -> "ScatterFit":
        """Return levels as a sum of a design's columns, by generalised least squares.

        Parameters
        ----------
        levels : ndarray, shape (runs,)
            Levels. [%]
        design : ndarray, shape (runs, columns)
            What the levels may follow; linearly independent columns.
        """
        root = np.asarray(np.linalg.cholesky(self.covariance), dtype=float)
        columns, right = np.linalg.solve(root, design), np.linalg.solve(root, levels)
        coefficients = np.linalg.lstsq(columns, right, rcond=None)[0]
        left = right - columns @ coefficients
        freedom = PRIOR_FREEDOM + len(levels) - design.shape[1]
        factor = (PRIOR_FREEDOM + float(left @ left)) / freedom
        return ScatterFit(
            coefficients=coefficients,
            covariance=factor * np.linalg.inv(columns.T @ columns),
            freedom=freedom,
            factor=factor,
            likelihood=_marginal(left, columns, root),
        )

    def by_surroundings(self, levels: Array, design: Array) -> Array:
        """Return what of the levels the surroundings make, by best linear prediction. [%].

        Parameters
        ----------
        levels, design : ndarray
            As in :meth:`fitted`.
        """
        left = levels - design @ self.fitted(levels, design).coefficients
        return np.asarray(self.surroundings @ np.linalg.solve(self.covariance, left))


@dataclass(frozen=True, slots=True, kw_only=True)
class ScatterFit:
    """Coefficients of a design and how well they are known.

    Attributes
    ----------
    coefficients : ndarray, shape (columns,)
        Of the design's columns. [%]
    covariance : ndarray, shape (columns, columns)
        Theirs. [%²]
    freedom : float
        Degrees of freedom of their Student distribution.
    factor : float
        How many times as much as assumed the runs differ, in variance.
    likelihood : float
        Logarithm of the marginal likelihood of the levels, but for a constant that all designs with
        the same number of columns share.
    """

    coefficients: Array
    covariance: Array
    freedom: float
    factor: float
    likelihood: float

    def reach(self, within: Array, day_to_day: float) -> Array:
        """Return the half width of the 95 % interval of each run's own level, shape (runs,). [%].

        Parameters
        ----------
        within : ndarray, shape (runs, runs)
            Covariance by noise within the runs; what they have in common counts for none. [%²]
        day_to_day : float
            Assumed standard deviation from day to day. [%]
        """
        middle = np.eye(len(within)) - 1 / len(within)
        variance = np.diag(middle @ within @ middle) + day_to_day**2
        return np.asarray(stats.t.ppf(0.975, self.freedom) * np.sqrt(self.factor * variance))

    def estimate(self, contrast: Array) -> "LevelEstimate":
        """Return a combination of the coefficients with its interval."""
        centre = float(contrast @ self.coefficients)
        deviation = float(np.sqrt(contrast @ self.covariance @ contrast))
        reach = float(stats.t.ppf(0.975, self.freedom)) * deviation
        return LevelEstimate(
            value=centre,
            low=centre - reach,
            high=centre + reach,
            p_value=float(2 * stats.t.sf(abs(centre) / deviation, self.freedom)),
        )


@dataclass(frozen=True, slots=True)
class LevelEstimate:
    """A number with its 95 % interval and the chance of one as far from zero. [%]."""

    value: float
    low: float
    high: float
    p_value: float


def _marginal(left: Array, columns: Array, root: Array) -> float:
    freedom = PRIOR_FREEDOM + len(left) - columns.shape[1]
    spread = float(np.log(np.diag(root)).sum() + np.linalg.slogdet(columns.T @ columns)[1] / 2)
    return -spread - freedom / 2 * float(np.log(PRIOR_FREEDOM + float(left @ left)))
