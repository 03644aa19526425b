"""What the base model leaves of an effect: the size that counts for its name."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK, base_rows, main_channel
from frictioncli.effects.base import Basis, Effect
from frictioncli.linear_algebra import orthonormal_basis

_Z95 = 1.96


def left_of(problem: Problem, effect: Effect, basis: Basis, beside: Sequence[Basis]) -> Array:
    """Return what base and other columns leave of an effect's columns, shape (rows, width).

    Parameters
    ----------
    problem : Problem
        The rows with their base.
    effect : Effect
        The effect; the channel in which it shows most counts.
    basis : Basis
        Its columns.
    beside : sequence of Basis
        Columns beside the base, as those of measurement effects.
    """
    return left_by(problem, main_channel(basis, effect), effect.channel, beside)


def left_by(problem: Problem, columns: Array, channel: str, beside: Sequence[Basis]) -> Array:
    """Return what base and other columns leave of columns in one channel, of the same shape.

    Parameters
    ----------
    problem : Problem
        The rows with their base.
    columns : ndarray, shape (rows, width)
        Columns in the channel.
    channel : {"friction", "load"}
        The channel.
    beside : sequence of Basis
        Columns beside the base.
    """
    number = ("friction", "load").index(channel)
    base = np.hstack([base_rows(problem)[number], *(one[number] for one in beside)])
    span = orthonormal_basis(base, tolerance=RANK)
    return np.asarray(columns - span @ (span.T @ columns))


def visible_size(left: Array, coefficients: Array, covariance: Array) -> tuple[float, float, float]:
    r"""Return the RMS of a combination of columns, with its 95 % interval.

    With the mean inner products *R* of the columns, coefficients *c* and their covariance
    :math:`\Sigma` the mean square is :math:`c^\mathsf{T} R c`. Errors add
    :math:`\operatorname{tr} R \Sigma` to it on average, and give it the variance
    :math:`2 \operatorname{tr} (R \Sigma)^2 + 4 m^\mathsf{T} R \Sigma R m` [1]_.

    Parameters
    ----------
    left : ndarray, shape (rows, width)
        What the base leaves of the columns. [N·m per unit of the coefficient]
    coefficients : ndarray, shape (width,)
        Coefficients.
    covariance : ndarray, shape (width, width)
        Their covariance.

    Returns
    -------
    size, low, high : float
        RMS without what errors add, and its interval. [N·m]

    References
    ----------
    .. [1] A. M. Mathai and S. B. Provost, *Quadratic Forms in Random Variables*, Dekker, 1992.

    Examples
    --------
    >>> import numpy as np
    >>> size = visible_size(np.ones((4, 1)), np.array([2.0]), np.array([[0.01]]))
    >>> print(np.round(size, 2))
    [2.  1.8 2.2]
    """
    inner = left.T @ left / len(left)
    square = float(coefficients @ inner @ coefficients)
    product = inner @ covariance
    added = float(np.trace(product))
    mean = max(square - added, 0.0)
    share = np.sqrt(mean / square) if square > 0 else 0.0
    slope = float(coefficients @ product @ inner @ coefficients) * share**2
    error = float(np.sqrt(max(2 * np.trace(product @ product) + 4 * slope, 0.0)))
    if len(coefficients) == 1:
        deviation = float(np.sqrt(added))
        size = float(np.sqrt(square))
        return size, max(size - _Z95 * deviation, 0.0), size + _Z95 * deviation
    low, high = max(mean - _Z95 * error, 0.0), mean + _Z95 * error
    return float(np.sqrt(mean)), float(np.sqrt(low)), float(np.sqrt(high))
