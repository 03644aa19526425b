r"""Covariance of white noise and a slow drift by its tridiagonal precision, in O(pairs).

The drift is a Markov process within each run, so that its inverse covariance is tridiagonal [1]_:
with the precision *Q* of the drift and the variances *W* of the white noise,

.. math:: V^{-1} = W^{-1} - W^{-1} (Q + W^{-1})^{-1} W^{-1} .

References
----------
.. [1] H. Rue and L. Held, Gaussian Markov Random Fields, 2005, doi:10.1201/9780203492024.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dpttrf, dpttrs, dtbtrs

from frictioncli.arrays import Array, Indices

LEAST_DRIFT = 1e-9
"""Least variance of the drift, relative to the mean of what is independent between pairs."""


def run_starts(run: Indices) -> Indices:
    """Return where each run begins, shape (runs,).

    Parameters
    ----------
    run : ndarray of int, shape (pairs,)
        Run of each pair; pairs of a run stand together.
    """
    return np.flatnonzero(np.diff(run, prepend=run[0] - 1))


@dataclass(frozen=True, slots=True)
class Drift:
    """Drift of variance 1 with one correlation time: its tridiagonal precision.

    Attributes
    ----------
    correlation : ndarray, shape (pairs,)
        Correlation with the pair before; 0 where a run starts.
    diagonal : ndarray, shape (pairs,)
        Diagonal of the precision.
    beside : ndarray, shape (pairs,)
        Precision between each pair and the one before it; 0 where a run starts.
    log_determinant : float
        Logarithm of the determinant of the covariance.
    """

    correlation: Array
    diagonal: Array
    beside: Array
    log_determinant: float

    @classmethod
    def of(cls, time: Array, run: Indices, duration: float) -> "Drift":
        """Return the drift of pairs.

        Parameters
        ----------
        time : ndarray, shape (pairs,)
            Times, growing within each run. [s]
        run : ndarray of int, shape (pairs,)
            Run of each pair; pairs of a run stand together.
        duration : float
            Correlation time. [s]
        """
        step = np.where(np.diff(run) == 0, np.diff(time), np.inf)
        decay = np.exp(-np.maximum(step, 1e-3) / duration)
        correlation = np.concatenate([[0.0], np.minimum(decay, 1 - 1e-9)])
        innovation = 1 - np.square(correlation)
        diagonal = 1 / innovation
        diagonal[:-1] += np.square(correlation[1:]) / innovation[1:]
        determinant = float(np.sum(np.log(innovation)))
        return cls(correlation, diagonal, -correlation / innovation, determinant)


def correlated(correlation: Array, right: Array) -> Array:
    """Return the covariance of a drift of variance 1 times columns.

    Parameters
    ----------
    correlation : ndarray, shape (pairs,)
        As of :class:`Drift`.
    right : ndarray, shape (pairs, ...)
        The columns.
    """
    # a product of a first-order recursion, its innovations and the same recursion backwards
    banded = np.array([np.ones_like(correlation), -np.append(correlation[1:], 0.0)])
    backward, _ = dtbtrs(banded, right, uplo="L", trans="T", diag="U")
    innovation = 1 - np.square(correlation)
    return np.asarray(dtbtrs(banded, (backward.T * innovation).T, uplo="L", diag="U")[0])


def whitened(correlation: Array, drift: float, white: Array, right: Array) -> Array:
    """Return columns made white: the innovations of each pair by those before it.

    A Kalman filter: inner products of such columns are those with the inverse covariance between.

    Parameters
    ----------
    correlation : ndarray, shape (pairs,)
        As of :class:`Drift`.
    drift : float
        Standard deviation of the drift. [N·m]
    white : ndarray, shape (pairs,)
        Variance that is independent between pairs. [(N·m)²]
    right : ndarray, shape (pairs, columns)
        The columns. [N·m]
    """
    innovations = np.empty_like(right)
    known, variance = np.zeros(right.shape[1]), 0.0
    for number, (before, own) in enumerate(zip(correlation.tolist(), white.tolist(), strict=True)):
        known = before * known
        variance = before**2 * variance + (1 - before**2) * drift**2
        beyond = right[number] - known
        innovations[number] = beyond / math.sqrt(variance + own)
        share = variance / (variance + own)
        known = known + share * beyond
        variance *= 1 - share
    return innovations


def posterior_factor(diagonal: Array, beside: Array, white: Array) -> Array:
    """Return the factors *L D L'* of a drift's precision plus ``1/white``.

    Parameters
    ----------
    diagonal, beside : ndarray, shape (pairs,)
        Precision of the drift, as of :class:`Drift`. [1/(N·m)²]
    white : ndarray, shape (pairs,)
        Variance that is independent between pairs. [(N·m)²]

    Returns
    -------
    ndarray, shape (2, pairs)
        The pivots *D*, and what stands below the diagonal of *L*; the last of these is 0.
    """
    return _factor(diagonal + 1 / white, np.append(beside[1:], 0.0))


def solved(factor: Array, white: Array, right: Array) -> Array:
    """Return the inverse covariance times columns.

    Parameters
    ----------
    factor : ndarray, shape (2, pairs)
        As of :func:`posterior_factor`.
    white : ndarray, shape (pairs,)
        Variance that is independent between pairs. [(N·m)²]
    right : ndarray, shape (pairs, ...)
        The columns.
    """
    weighted = (right.T / white).T
    smooth, _ = dpttrs(factor[0], _beside(factor[1]), weighted)
    return np.asarray(weighted - (smooth.T / white).T)


def inverse_diagonal(factor: Array, white: Array) -> Array:
    """Return the diagonal of the inverse covariance, shape (pairs,) [1/(N·m)²].

    Parameters
    ----------
    factor : ndarray, shape (2, pairs)
        As of :func:`posterior_factor`.
    white : ndarray, shape (pairs,)
        Variance that is independent between pairs. [(N·m)²]
    """
    # pivots of the tridiagonal matrix from its start and from its end
    pivots, below = factor
    beside = below * pivots
    diagonal = pivots.copy()
    diagonal[1:] += below[:-1] * beside[:-1]
    backward = _factor(diagonal[::-1], np.append(beside[-2::-1], 0.0))[0, ::-1]
    smooth = 1 / (pivots + backward - diagonal)
    return np.asarray((1 - smooth / white) / white)


def _factor(diagonal: Array, below: Array) -> Array:
    """Return the factors of a tridiagonal matrix, shape (2, pairs)."""
    pivots, left, fault = dpttrf(diagonal, _beside(below))
    if fault:
        raise np.linalg.LinAlgError("the covariance of the pair means is not positive definite")
    return np.array([pivots, np.append(left, 0.0)[: len(pivots)]])


def _beside(below: Array) -> Array:
    """Return one number less than there are pairs, as LAPACK wants it, but at least one."""
    return below[: max(len(below) - 1, 1)]
