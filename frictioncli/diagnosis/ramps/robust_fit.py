"""Weighted least squares on ramps, with errors that are robust against what ramps share.

References
----------
.. [1] A. C. Cameron, J. B. Gelbach and D. L. Miller, "Robust inference with multiway clustering,"
   J. Bus. Econ. Stat. 29(2), 2011, doi:10.1198/jbes.2010.07136.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import gram_inverse

Labels = Indices

_NOTHING = 1e-9


@dataclass(frozen=True, slots=True)
class Projection:
    """Takes out columns of each move's own, and free columns of all rows together.

    Attributes
    ----------
    weight : ndarray, shape (rows,)
        Square root of each row's weight.
    starts : ndarray of int, shape (moves,)
        First row of each move; its rows stand together.
    own : ndarray, shape (rows, columns)
        Weighted columns of the moves, orthonormal within each.
    free : ndarray, shape (rows, columns)
        Orthonormal basis of the free columns, off those of the moves.
    """

    weight: Array
    starts: Labels
    own: Array
    free: Array

    @classmethod
    def of(cls, weight: Array, move: Labels, own: Array, free: Array) -> "Projection":
        """Return the projection.

        Parameters
        ----------
        weight : ndarray, shape (rows,)
            Weights.
        move : ndarray of int, shape (rows,)
            The move of each row; its rows stand together.
        own : ndarray, shape (rows, columns)
            What each move may have of its own.
        free : ndarray, shape (rows, columns)
            What all moves together may have.
        """
        root = np.sqrt(weight / np.mean(weight))
        starts = np.flatnonzero(np.concatenate([[True], move[1:] != move[:-1]]))
        bare = cls(root, starts, np.empty((len(root), 0)), np.empty((len(root), 0)))
        for column in own.T:
            left = bare.off(column[:, np.newaxis])[:, 0]
            size = bare.spread(np.sqrt(np.add.reduceat(np.square(left), starts)))
            unit = np.divide(left, size, out=np.zeros_like(left), where=size > _NOTHING)
            bare = cls(root, starts, np.column_stack([bare.own, unit]), bare.free)
        return bare.with_free(free)

    def with_free(self, columns: Array) -> "Projection":
        """Return a projection that takes out further columns of all rows together."""
        left = self.off(columns)
        size = np.linalg.norm(left, axis=0)
        whole = np.linalg.norm(columns * self.weight[:, np.newaxis], axis=0)
        left = left[:, size > 1e-6 * whole] / size[size > 1e-6 * whole]
        basis, strength, _ = np.linalg.svd(left, full_matrices=False)
        kept = basis[:, strength > 1e-6]
        return Projection(self.weight, self.starts, self.own, np.column_stack([self.free, kept]))

    def spread(self, per_move: Array) -> Array:
        """Return one value per row from one value per move."""
        return np.repeat(per_move, np.diff(self.starts, append=len(self.weight)))

    def off(self, columns: Array) -> Array:
        """Return weighted columns, shape (rows, columns), without what is taken out."""
        left = columns * self.weight[:, np.newaxis]
        for own in self.own.T:
            share = np.add.reduceat(left * own[:, np.newaxis], self.starts, axis=0)
            left = left - own[:, np.newaxis] * np.repeat(
                share, np.diff(self.starts, append=len(left)), axis=0
            )
        return np.asarray(left - self.free @ (self.free.T @ left))


@dataclass(frozen=True, slots=True)
class Fit:
    """Coefficients of columns, their covariance, and what is left of the misfit.

    ``freedom`` is the least number of clusters less one: as much is known of the covariance.
    """

    coefficients: Array
    covariance: Array
    residual: Array
    freedom: int

    def score(self, number: int) -> float:
        r"""Return a coefficient's squared ratio to its error, as much as few clusters bear.

        That is twice the logarithm of the likelihood ratio of Student's *t* with
        :math:`\nu` degrees of freedom, :math:`(\nu + 1) \ln(1 + t^2 / \nu)`.
        """
        variance = float(self.covariance[number, number])
        ratio = float(self.coefficients[number]) ** 2 / variance if variance > 0 else 0.0
        return float((self.freedom + 1) * np.log1p(ratio / self.freedom))


def fitted(columns: Array, misfit: Array, clusters: tuple[Labels, ...]) -> Fit:
    """Fit columns to a misfit, both off a projection, with the errors of each clustering added.

    The sum of two clusterings' variances is that of reference [1]_ without the part that they
    share, which it would subtract: a little too large, never negative.

    Parameters
    ----------
    columns : ndarray, shape (rows, columns)
        What is fitted.
    misfit : ndarray, shape (rows,)
        To what.
    clusters : tuple of ndarray of int, shape (rows,)
        Rows of one label may be correlated at will.
    """
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(size > 0, size, 1.0)
    inverse = gram_inverse(scaled.T @ scaled, tolerance=1e-10)
    coefficients = inverse @ (scaled.T @ misfit)
    residual = misfit - scaled @ coefficients
    scores = scaled * residual[:, np.newaxis]
    covariance = np.zeros_like(inverse)
    for labels in clusters:
        count = int(labels.max()) + 1
        sums = np.column_stack([np.bincount(labels, score, count) for score in scores.T])
        covariance += count / max(count - 1, 1) * sums.T @ sums
    scale = np.where(size > 0, size, 1.0)
    return Fit(
        coefficients / scale,
        inverse @ covariance @ inverse / np.outer(scale, scale),
        residual,
        freedom=max(min(int(labels.max()) for labels in clusters), 1),
    )
