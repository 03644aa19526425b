r"""Cholesky factor of a matrix in which two sets of columns have no products with each other.

Functions of the discrepancy show in friction or in load, the base and effects in both. With the
columns of one channel each (1, 2) and those of both (s) the matrix and its factor are

.. math::
    M = \begin{pmatrix} M_1 & 0 & C_1 \\ 0 & M_2 & C_2 \\ C_1^\mathsf{T} & C_2^\mathsf{T} & M_s
    \end{pmatrix}, \quad
    L = \begin{pmatrix} L_1 & 0 & 0 \\ 0 & L_2 & 0 \\ A_1^\mathsf{T} & A_2^\mathsf{T} & L_s
    \end{pmatrix}, \quad A_c = L_c^{-1} C_c,

with :math:`L_s L_s^\mathsf{T} = M_s - \sum_c A_c^\mathsf{T} A_c`, which takes a fraction of the
operations that a factor of the whole takes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import lapack

from frictioncli.arrays import Array, Indices

Sets = tuple[tuple[Indices, Indices], Indices]
"""Numbers of the columns of both sets, each of which may be empty, and of all other columns."""


@dataclass(frozen=True, slots=True)
class BlockCholesky:
    """Cholesky factor of a positive definite matrix.

    Attributes
    ----------
    sets : ((ndarray of int, ndarray of int), ndarray of int)
        Numbers of the columns of both sets, and of all others.
    roots : list of ndarray, shape (own, own)
        Lower factor of each set.
    across : list of ndarray, shape (own, others)
        The factor's rows of the other columns, transposed.
    root : ndarray, shape (others, others)
        Lower factor of what the sets leave of the other columns.
    """

    sets: Sets
    roots: list[Array]
    across: list[Array]
    root: Array
    _of_others: list[Array] = field(default_factory=list, init=False, repr=False)

    @classmethod
    def of(
        cls, sets: Sets, own: Sequence[Array], across: Sequence[Array], among: Array
    ) -> "BlockCholesky | None":
        """Return the factor; None where the matrix is not positive definite.

        Parameters
        ----------
        sets : ((ndarray of int, ndarray of int), ndarray of int)
            Numbers of the columns of both sets, and of all others.
        own : sequence of ndarray, shape (own, own)
            The matrix among the columns of each set.
        across : sequence of ndarray, shape (own, others)
            The same of each set with the other columns.
        among : ndarray, shape (others, others)
            The same among these.
        """
        roots, lowered = [], []
        for square, beside in zip(own, across, strict=True):
            root = _root(square)
            if root is None:
                return None
            below = _solved(root, beside)
            among = among - below.T @ below
            roots.append(root)
            lowered.append(below)
        root = _root(among)
        return None if root is None else cls(sets, roots, lowered, root)

    @property
    def count(self) -> int:
        """Number of columns."""
        own, others = self.sets
        return len(others) + sum(map(len, own))

    def logarithms(self) -> Array:
        """Return the logarithms of the factor's diagonal, shape (columns,).

        Their sum over the columns of both sets and the first ones of the others is half of the
        logarithm of the determinant of these alone.
        """
        found = np.empty(self.count)
        own, others = self.sets
        for place, root in zip((*own, others), (*self.roots, self.root), strict=True):
            found[place] = np.log(np.diagonal(root))
        return found

    def solve(self, right: Array) -> Array:
        """Return the solution of the linear equations, shape (columns,).

        Parameters
        ----------
        right : ndarray, shape (columns,)
            Their right-hand side.
        """
        found = np.empty_like(right)
        own, others = self.sets
        left = right[others]
        lowered = []
        for place, root, across in zip(own, self.roots, self.across, strict=True):
            lowered.append(_solved(root, right[place]))
            left = left - lowered[-1] @ across
        found[others] = solved = _solved(self.root, _solved(self.root, left), transposed=True)
        for place, root, across, low in zip(own, self.roots, self.across, lowered, strict=True):
            found[place] = _solved(root, low - across @ solved, transposed=True)
        return found

    def inverse(self) -> Array:
        """Return the inverse of the matrix, shape (columns, columns)."""
        found = np.empty((self.count, self.count))
        (first, second), others = self.sets
        for number in (0, 1):
            shown = np.concatenate([self.sets[0][number], others])
            found[shown[:, np.newaxis], shown] = self.inverse_beside(number)
        one, two = (self._taken(number) for number in (0, 1))
        across = one @ self.inverse_of_others() @ two.T
        found[first[:, np.newaxis], second] = across
        found[second[:, np.newaxis], first] = across.T
        return found

    def inverse_beside(self, number: int) -> Array:
        """Return the inverse at the columns of one set and, behind them, the others.

        Parameters
        ----------
        number : int
            0 or 1, number of the set.
        """
        taken, middle = self._taken(number), self.inverse_of_others()
        width = len(taken)
        found = np.empty((width + len(middle),) * 2)
        weighted = taken @ middle
        found[width:, width:] = middle
        found[:width, width:] = -weighted
        found[width:, :width] = -weighted.T
        found[:width, :width] = _inverse(self.roots[number]) + weighted @ taken.T
        return found

    def inverse_of_others(self) -> Array:
        """Return the inverse of the matrix at the other columns, which both sets have beside."""
        if not self._of_others:
            self._of_others.append(_inverse(self.root))
        return self._of_others[0]

    def _taken(self, number: int) -> Array:
        """Return what a set takes of the other columns, shape (own, others)."""
        return _solved(self.roots[number], self.across[number], transposed=True)


def _root(square: Array) -> Array | None:
    """Return the lower factor of a symmetric matrix; None where it is not positive definite."""
    if not len(square):
        return square
    # the matrix is symmetric: what is contiguous for numpy is so for LAPACK once transposed
    root, fault = lapack.dpotrf(square.T, lower=True)
    return None if fault else root


def _solved(root: Array, right: Array, *, transposed: bool = False) -> Array:
    """Return the solution of equations with a lower factor, or with its transpose."""
    if not len(root):
        return right
    return np.asarray(lapack.dtrtrs(root, right, lower=True, trans=int(transposed))[0])


def _inverse(root: Array) -> Array:
    """Return the inverse of a matrix from its lower factor."""
    if not len(root):
        return root
    half, _ = lapack.dpotri(root, lower=True)
    found = half + half.T
    np.fill_diagonal(found, np.diagonal(half))
    return np.asarray(found)
