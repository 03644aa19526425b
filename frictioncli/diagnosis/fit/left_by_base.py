"""What the base model leaves of an effect: the size that counts for its name."""

from collections.abc import Sequence

import numpy as np
from scipy import special

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK, base_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.effects.base import Basis
from frictioncli.linear_algebra import orthonormal_basis

_UPPER = 0.975
"""Upper end of a 95 % interval."""

_PRECISE = 1e4
"""Statistics above which the root of noncentral chi squared is normal."""

Z95 = 1.96
"""Standard errors on either side of an estimate in its 95 % interval."""


def span_of(problem: Problem, beside: Sequence[Basis] = ()) -> Array:
    """Return an orthonormal basis of base and further columns, friction above load.

    Parameters
    ----------
    problem : Problem
        The rows with their base.
    beside : sequence of Basis
        Columns beside the base, as those of measurement effects.

    Returns
    -------
    ndarray, shape (2 * rows, rank)
        The basis.
    """
    columns = [np.vstack(base_rows(problem)), *(np.vstack(one) for one in beside)]
    return orthonormal_basis(np.hstack(columns), tolerance=RANK)


def left_by(span: Array, basis: Basis) -> Array:
    """Return what a span leaves of columns, friction above load, shape (2 * rows, width).

    Parameters
    ----------
    span : ndarray, shape (2 * rows, rank)
        As of :func:`span_of`.
    basis : Basis
        The columns in both channels.
    """
    columns = np.vstack(basis)
    return np.asarray(columns - span @ (span.T @ columns))


def torque_left_by(span: Array, problem: Problem, fit: EffectFit) -> Array:
    """Return what a span leaves of the torque of a fitted effect, shape (2 * rows,) [N·m].

    Parameters
    ----------
    span : ndarray, shape (2 * rows, rank)
        As of :func:`span_of`.
    problem : Problem
        The rows.
    fit : EffectFit
        The effect.
    """
    return np.asarray(left_by(span, problem.basis(fit.effect, fit.shape)) @ fit.coefficients)


def rms_left(left: Array) -> float:
    """Return the RMS of a torque that a span leaves, of both channels together [N·m].

    Parameters
    ----------
    left : ndarray, shape (2 * rows,)
        The torque, friction above load. [N·m]
    """
    return float(np.linalg.norm(left)) / np.sqrt(len(left) / 2)


def products_left_by(span: Array, basis: Basis) -> Array:
    """Return inner products of what a span leaves of columns, shape (width, width).

    Parameters
    ----------
    span : ndarray, shape (2 * rows, rank)
        As of :func:`span_of`.
    basis : Basis
        The columns in both channels.
    """
    width = basis.friction.shape[1]
    own, along = np.zeros((width, width)), np.zeros((span.shape[1], width))
    for part, columns in zip(np.split(span, 2), basis, strict=True):
        if columns.any():
            own += columns.T @ columns
            along += part.T @ columns
    return np.asarray(own - along.T @ along)


def visible_size(left: Array, coefficients: Array, covariance: Array) -> tuple[float, float, float]:
    r"""Return the RMS of a combination of columns, with its 95 % interval.

    With the mean inner products *R* of the columns, coefficients *c* and their covariance
    :math:`\Sigma` the mean square is :math:`c^\mathsf{T} R c`. It is about *a* times a noncentral
    chi-squared variable [1]_ of :math:`\operatorname{tr} R \Sigma / a` degrees of freedom, with
    the variance *a* of the combination along itself,

    .. math::
        a = \frac{c^\mathsf{T} R \Sigma R c + \operatorname{tr} (R \Sigma)^2}
                 {c^\mathsf{T} R c + \operatorname{tr} R \Sigma} ,

    and the mean square that is looked for is *a* times the noncentrality: that at which it would be
    as small, or as great, in one of forty cases.

    Parameters
    ----------
    left : ndarray, shape (2 * rows, width)
        What the base leaves of the columns, friction above load. [N·m per unit of the coefficient]
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
    >>> left = np.vstack([np.ones((4, 1)), np.zeros((4, 1))])
    >>> size = visible_size(left, np.array([2.0]), np.array([[0.01]]))
    >>> print(np.round(size, 2))
    [2.  1.8 2.2]
    """
    return visible_size_of(left.T @ left / (len(left) / 2), coefficients, covariance)


def visible_size_of(
    inner: Array, coefficients: Array, covariance: Array
) -> tuple[float, float, float]:
    """Return the same from the mean inner products of the columns.

    Parameters
    ----------
    inner : ndarray, shape (width, width)
        Mean inner products of what the base leaves of the columns.
    coefficients : ndarray, shape (width,)
        Coefficients.
    covariance : ndarray, shape (width, width)
        Their covariance.

    Returns
    -------
    size, low, high : float
        As of :func:`visible_size`. [N·m]
    """
    square = float(coefficients @ inner @ coefficients)
    product = inner @ covariance
    added = float(np.trace(product))
    along = float(coefficients @ product @ inner @ coefficients) + float(
        np.trace(product @ product)
    )
    if square + added <= 0 or along <= 0:
        size = float(np.sqrt(max(square, 0.0)))
        return size, size, size
    unit = along / (square + added)
    freedom, statistic = max(added / unit, 1.0), square / unit
    size, low = (_noncentrality(statistic, freedom, one) for one in (0.5, _UPPER))
    # errors may cancel the effect by chance: that it is nothing does not follow
    high = _noncentrality(max(statistic, freedom), freedom, 1 - _UPPER)
    return float(np.sqrt(unit * size)), float(np.sqrt(unit * low)), float(np.sqrt(unit * high))


def _noncentrality(statistic: float, freedom: float, probability: float) -> float:
    """Return the noncentrality with which a statistic is below its value so often."""
    if special.chdtr(freedom, statistic) <= probability:
        return 0.0
    if statistic > _PRECISE:
        root = np.sqrt(statistic - freedom + 1) - special.ndtri(probability)
        return float(max(root, 0.0) ** 2)
    return float(special.chndtrinc(statistic, freedom, probability))
