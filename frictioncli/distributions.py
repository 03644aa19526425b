"""Tail probabilities and quantiles of Student's t, chi-squared, F and the standard normal.

They are those of ``scipy.stats``, bit by bit; importing that takes longer than most commands here.
"""

import math

from numpy.typing import ArrayLike
from scipy import special

from frictioncli.arrays import Array


def t_quantile(probability: float, freedom: float) -> float:
    """Return the value that Student's t stays below with a probability.

    Parameters
    ----------
    probability : float
        From 0 to 1.
    freedom : float
        Degrees of freedom.

    Examples
    --------
    >>> round(t_quantile(0.975, 10), 3)
    2.228
    """
    return float(special.stdtrit(freedom, probability))


def t_tail(value: float, freedom: float) -> float:
    """Return the probability that Student's t exceeds a value.

    Parameters
    ----------
    value : float
        The value.
    freedom : float
        Degrees of freedom.
    """
    return float(special.stdtr(freedom, -value))


def chi2_tail(value: float, freedom: float) -> float:
    """Return the probability that chi-squared exceeds a value.

    Parameters
    ----------
    value : float
        The value; everything exceeds a negative one.
    freedom : float
        Degrees of freedom.

    Examples
    --------
    >>> round(chi2_tail(3.841, 1), 3)
    0.05
    """
    return float(special.chdtrc(freedom, value)) if value > 0 else 1.0


def f_tail(value: float, numerator: float, denominator: float) -> float:
    """Return the probability that F exceeds a value.

    Parameters
    ----------
    value : float
        The value, at least 0.
    numerator, denominator : float
        Degrees of freedom.

    Examples
    --------
    >>> round(f_tail(4.965, 1, 10), 3)
    0.05
    """
    return float(special.fdtrc(numerator, denominator, value))


def f_exceeded(probability: float, numerator: float, denominator: float) -> float:
    """Return the value that F exceeds with a probability.

    Parameters
    ----------
    probability : float
        From 0 to 1; below 1e-16 the value is infinite.
    numerator, denominator : float
        Degrees of freedom.
    """
    return float(special.fdtri(numerator, denominator, 1 - probability))


def normal_quantile(probability: ArrayLike) -> Array:
    """Return the values that a standard normal variable stays below with given probabilities.

    Parameters
    ----------
    probability : array_like
        From 0 to 1.
    """
    return special.ndtri(probability)


def normal_log_density(value: float | Array, sd: float) -> float | Array:
    """Return the logarithm of the density of a normal variable with mean zero.

    Parameters
    ----------
    value : float or ndarray
        Where, in the unit of ``sd``.
    sd : float
        Standard deviation.
    """
    return -((value / sd) ** 2) / 2.0 - math.log(math.sqrt(2 * math.pi)) - math.log(sd)
