r"""Levels of runs with a day-to-day variance component, and what it makes of a difference.

The levels *z* of the runs, in per cent of the mean friction, are a change plus random deviations:

.. math:: z = X \beta + u, \quad u \sim N(0, \varphi V), \quad
    V = C + \sigma_0^2 I + \kappa_1^2 a a^T + \kappa_2^2 q q^T

*C* is the covariance by noise within the runs, :math:`\sigma_0` the day-to-day standard deviation,
*a* the ambient temperature of each run less their mean, in tens of °C, and :math:`q = a^2`: in the
cold a joint has another friction at the same motor temperature, because its gear and housing are
colder. The factor :math:`\varphi` has a scaled inverse chi-squared prior of :math:`\nu_0` degrees
of freedom about 1. The interval of a difference is therefore Student's with
:math:`\nu_0 + n - p` degrees of freedom: with two runs it depends on the assumed variance, with
many runs on the observed one [1]_, [2]_.

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

from frictioncli.arrays import Array
from frictioncli.distributions import t_quantile, t_tail

PRIOR_DEGREES_OF_FREEDOM = 3.0
"""Degrees of freedom of the prior for the variance factor."""

_AMBIENT_SLOPE = 4.0
"""Prior standard deviation of the linear effect of ambient temperature. [% per 10 °C]"""

_AMBIENT_CURVATURE = 2.0
"""Prior standard deviation of the quadratic effect. [% per (10 °C)²]"""

_UNKNOWN_AMBIENT = 10.0
"""Assumed day-to-day standard deviation where no temperature is known. [%]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LevelModel:
    """Covariance of levels without a change, but for a factor that the runs determine.

    Attributes
    ----------
    covariance : ndarray, shape (runs, runs)
        V. [%²]
    ambient : ndarray, shape (runs, runs)
        The part of it that is due to ambient temperature. [%²]
    """

    covariance: Array
    ambient: Array

    @classmethod
    def of(cls, within: Array, ambient: Array, day_to_day: float) -> "LevelModel":
        """Return the covariance of levels.

        Parameters
        ----------
        within : ndarray, shape (runs, runs)
            Covariance by noise within the runs. [%²]
        ambient : ndarray, shape (runs,)
            Ambient temperature of each run; NaN where unknown. [°C]
        day_to_day : float
            Assumed day-to-day standard deviation. [%]
        """
        away = (ambient - ambient.mean()) / 10.0
        by_ambient = _AMBIENT_SLOPE**2 * np.outer(away, away)
        by_ambient = by_ambient + _AMBIENT_CURVATURE**2 * np.outer(away**2, away**2)
        if not np.isfinite(ambient).all():
            by_ambient = _UNKNOWN_AMBIENT**2 * np.eye(len(within))
        own = within + day_to_day**2 * np.eye(len(within))
        return cls(covariance=own + by_ambient, ambient=by_ambient)

    def fit(self, levels: Array, design: Array) -> "LevelFit":
        """Fit a design to levels by generalised least squares.

        Parameters
        ----------
        levels : ndarray, shape (runs,)
            Levels. [%]
        design : ndarray, shape (runs, columns)
            Linearly independent columns.

        Returns
        -------
        LevelFit
            Coefficients with their Student distribution.

        Examples
        --------
        >>> model = LevelModel.of(np.zeros((2, 2)), ambient=np.zeros(2), day_to_day=1.0)
        >>> fit = model.fit(np.array([0.0, 4.0]), np.array([[1.0, 0.0], [1.0, 1.0]]))
        >>> change = fit.estimate(np.array([0.0, 1.0]))
        >>> round(change.value, 3), round(change.low, 3), round(change.high, 3)
        (4.0, -0.501, 8.501)
        """
        root = np.asarray(np.linalg.cholesky(self.covariance), dtype=float)
        columns, right = np.linalg.solve(root, design), np.linalg.solve(root, levels)
        coefficients = np.linalg.lstsq(columns, right, rcond=None)[0]
        residual = right - columns @ coefficients
        degrees = PRIOR_DEGREES_OF_FREEDOM + len(levels) - design.shape[1]
        factor = (PRIOR_DEGREES_OF_FREEDOM + float(residual @ residual)) / degrees
        return LevelFit(
            coefficients=coefficients,
            covariance=factor * np.linalg.inv(columns.T @ columns),
            degrees_of_freedom=degrees,
            variance_factor=factor,
            log_marginal_likelihood=_log_marginal_likelihood(residual, columns, root),
        )

    def ambient_effect(self, levels: Array, design: Array) -> Array:
        """Return the best linear prediction of the effect of ambient temperature on levels.

        Parameters
        ----------
        levels, design : ndarray
            As for :meth:`fit`.

        Returns
        -------
        ndarray, shape (runs,)
            Part of the levels that is due to ambient temperature. [%]
        """
        residual = levels - design @ self.fit(levels, design).coefficients
        return np.asarray(self.ambient @ np.linalg.solve(self.covariance, residual))


@dataclass(frozen=True, slots=True, kw_only=True)
class LevelFit:
    """Coefficients of a design with their Student distribution.

    Attributes
    ----------
    coefficients : ndarray, shape (columns,)
        Coefficients of the design's columns. [%]
    covariance : ndarray, shape (columns, columns)
        Their scale matrix. [%²]
    degrees_of_freedom : float
        Degrees of freedom of the Student distribution.
    variance_factor : float
        Estimate of the factor by which the variance differs from the assumed one.
    log_marginal_likelihood : float
        Log marginal likelihood of the levels, but for a constant that all designs with the same
        number of columns share.
    """

    coefficients: Array
    covariance: Array
    degrees_of_freedom: float
    variance_factor: float
    log_marginal_likelihood: float

    def half_widths(self, within: Array, day_to_day: float) -> Array:
        """Return the half-width of the 95 % interval of each run's level.

        Parameters
        ----------
        within : ndarray, shape (runs, runs)
            Covariance by noise within the runs; the common part of all runs is removed. [%²]
        day_to_day : float
            Assumed day-to-day standard deviation. [%]

        Returns
        -------
        ndarray, shape (runs,)
            Half-widths. [%]
        """
        centred = np.eye(len(within)) - 1 / len(within)
        variance = np.diag(centred @ within @ centred) + day_to_day**2
        quantile = t_quantile(0.975, self.degrees_of_freedom)
        return np.asarray(quantile * np.sqrt(self.variance_factor * variance))

    def estimate(self, contrast: Array) -> "LevelEstimate":
        """Return a linear combination of the coefficients with its interval.

        Parameters
        ----------
        contrast : ndarray, shape (columns,)
            Weights of the coefficients.
        """
        value = float(contrast @ self.coefficients)
        error = float(np.sqrt(contrast @ self.covariance @ contrast))
        half_width = t_quantile(0.975, self.degrees_of_freedom) * error
        return LevelEstimate(
            value=value,
            low=value - half_width,
            high=value + half_width,
            p_value=2 * t_tail(abs(value) / error, self.degrees_of_freedom),
        )


@dataclass(frozen=True, slots=True)
class LevelEstimate:
    """Estimate with its 95 % interval [%] and two-sided p-value.

    Attributes
    ----------
    value : float
        Estimate. [%]
    low, high : float
        Ends of the 95 % interval. [%]
    p_value : float
        Of the hypothesis that the true value is zero.
    """

    value: float
    low: float
    high: float
    p_value: float


def _log_marginal_likelihood(residual: Array, columns: Array, root: Array) -> float:
    degrees = PRIOR_DEGREES_OF_FREEDOM + len(residual) - columns.shape[1]
    volume = float(np.log(np.diag(root)).sum() + np.linalg.slogdet(columns.T @ columns)[1] / 2)
    squares = PRIOR_DEGREES_OF_FREEDOM + float(residual @ residual)
    return -volume - degrees / 2 * float(np.log(squares))
