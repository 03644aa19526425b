r"""Weighted least squares on ramps, with cluster-robust standard errors.

With the residuals *r*, the columns *X* off the nuisance columns, and clusters *g*, the covariance
of the coefficients is

.. math:: (X^\mathsf{T} X)^{+} \Big(\sum_g \frac{G}{G - 1}\, X_g^\mathsf{T} r_g r_g^\mathsf{T}
    X_g\Big) (X^\mathsf{T} X)^{+}

summed over the clusterings, each with *G* clusters [1]_.

References
----------
.. [1] A. C. Cameron, J. B. Gelbach and D. L. Miller, "Robust inference with multiway clustering,"
   J. Bus. Econ. Stat. 29(2), 2011, doi:10.1198/jbes.2010.07136.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import gram_inverse

Labels = Indices
"""Number of the cluster, or of the move, of each row."""

_ABSENT = 1e-9
"""A column with a smaller RMS within a move is zero there."""


@dataclass(frozen=True, slots=True)
class Projection:
    """Projection off nuisance columns: some free for each move, some common to all rows.

    Attributes
    ----------
    weight : ndarray, shape (rows,)
        Square root of each row's weight.
    starts : ndarray of int, shape (moves,)
        First row of each move; its rows stand together.
    per_move : ndarray, shape (rows, columns)
        Weighted columns that are free for each move, orthonormal within each.
    common : ndarray, shape (rows, columns)
        Orthonormal basis of the common columns, off those of the moves.
    """

    weight: Array
    starts: Labels
    per_move: Array
    common: Array

    @classmethod
    def of(cls, weight: Array, move: Labels, per_move: Array, common: Array) -> "Projection":
        """Return the projection.

        Parameters
        ----------
        weight : ndarray, shape (rows,)
            Weights.
        move : ndarray of int, shape (rows,)
            The move of each row; its rows stand together.
        per_move : ndarray, shape (rows, columns)
            Columns with a coefficient for each move.
        common : ndarray, shape (rows, columns)
            Columns with one coefficient for all moves.
        """
        root = np.sqrt(weight / np.mean(weight))
        starts = np.flatnonzero(np.concatenate([[True], move[1:] != move[:-1]]))
        projection = cls(root, starts, np.empty((len(root), 0)), np.empty((len(root), 0)))
        for column in per_move.T:
            residual = projection.residual(column[:, np.newaxis])[:, 0]
            size = projection.repeated(np.sqrt(np.add.reduceat(np.square(residual), starts)))
            unit = np.divide(residual, size, out=np.zeros_like(residual), where=size > _ABSENT)
            projection = cls(
                root, starts, np.column_stack([projection.per_move, unit]), projection.common
            )
        return projection.with_common(common)

    def with_common(self, columns: Array) -> "Projection":
        """Return a projection off further columns common to all rows, shape (rows, columns)."""
        residual = self.residual(columns)
        size = np.linalg.norm(residual, axis=0)
        before = np.linalg.norm(columns * self.weight[:, np.newaxis], axis=0)
        residual = residual[:, size > 1e-6 * before] / size[size > 1e-6 * before]
        basis, strength, _ = np.linalg.svd(residual, full_matrices=False)
        kept = basis[:, strength > 1e-6]
        return Projection(
            self.weight, self.starts, self.per_move, np.column_stack([self.common, kept])
        )

    def repeated(self, values: Array) -> Array:
        """Return one value per row from one value per move."""
        return np.repeat(values, np.diff(self.starts, append=len(self.weight)))

    def residual(self, columns: Array) -> Array:
        """Return weighted columns less their projection, shape (rows, columns)."""
        residual = columns * self.weight[:, np.newaxis]
        for column in self.per_move.T:
            share = np.add.reduceat(residual * column[:, np.newaxis], self.starts, axis=0)
            residual = residual - column[:, np.newaxis] * np.repeat(
                share, np.diff(self.starts, append=len(residual)), axis=0
            )
        return np.asarray(residual - self.common @ (self.common.T @ residual))


@dataclass(frozen=True, slots=True)
class RobustFit:
    """Coefficients of columns with a cluster-robust covariance.

    Attributes
    ----------
    coefficients : ndarray, shape (columns,)
        Coefficients.
    covariance : ndarray, shape (columns, columns)
        Their covariance.
    residual : ndarray, shape (rows,)
        Weighted residual of the misfit. [N·m]
    freedom : int
        Degrees of freedom of the covariance: the least number of clusters less one.
    """

    coefficients: Array
    covariance: Array
    residual: Array
    freedom: int

    def score(self, number: int) -> float:
        r"""Return twice the log likelihood ratio of a coefficient to zero.

        For Student's *t* with :math:`\nu` degrees of freedom that is
        :math:`(\nu + 1) \ln(1 + t^2 / \nu)`; it tends to :math:`t^2` with many clusters.

        Parameters
        ----------
        number : int
            Number of the coefficient.
        """
        variance = float(self.covariance[number, number])
        ratio = float(self.coefficients[number]) ** 2 / variance if variance > 0 else 0.0
        return float((self.freedom + 1) * np.log1p(ratio / self.freedom))


def robust_fit(columns: Array, misfit: Array, clusters: tuple[Labels, ...]) -> RobustFit:
    """Fit columns to a misfit, both off a projection, with errors robust to two clusterings.

    The variances of the clusterings are added; reference [1]_ would subtract that of their
    intersection. The sum is slightly too large, but never negative.

    Parameters
    ----------
    columns : ndarray, shape (rows, columns)
        Columns, less their projection.
    misfit : ndarray, shape (rows,)
        Misfit, less its projection. [N·m]
    clusters : tuple of ndarray of int, shape (rows,)
        Clusterings; rows with one label may be correlated in any way.
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
    return RobustFit(
        coefficients / scale,
        inverse @ covariance @ inverse / np.outer(scale, scale),
        residual,
        freedom=max(min(int(labels.max()) for labels in clusters), 1),
    )


@dataclass(frozen=True, slots=True)
class Residual:
    """Residual of a misfit off a projection, to which columns are fitted.

    Attributes
    ----------
    projection : Projection
        Projection off the nuisance columns.
    misfit : ndarray, shape (rows,)
        The misfit. [N·m]
    clusters : tuple of ndarray of int, shape (rows,)
        Clusterings of the rows.
    values : ndarray, shape (rows,)
        Weighted misfit less its projection. [N·m]
    """

    projection: Projection
    misfit: Array
    clusters: tuple[Labels, ...]
    values: Array

    @classmethod
    def of(cls, projection: Projection, misfit: Array, clusters: tuple[Labels, ...]) -> "Residual":
        """Return the residual of a misfit."""
        values = projection.residual(misfit[:, np.newaxis])[:, 0]
        return cls(projection, misfit, clusters, values)

    def without(self, column: Array) -> "Residual":
        """Return the residual off a further column, shape (rows,)."""
        projection = self.projection.with_common(column[:, np.newaxis])
        return Residual.of(projection, self.misfit, self.clusters)

    def fitted(self, *columns: Array) -> RobustFit:
        """Return the fit of columns, shapes (rows,) or (rows, columns)."""
        together = np.column_stack(columns)
        return robust_fit(self.projection.residual(together), self.values, self.clusters)

    def scores(
        self, column: Callable[[float], Array], grid: Array, *, negative: bool = True
    ) -> Array:
        """Return twice the log likelihood ratio at each shape of a grid.

        Parameters
        ----------
        column : callable
            Column of a shape parameter.
        grid : ndarray, shape (shapes,)
            The shape parameters.
        negative : bool, optional
            Whether a negative coefficient is allowed; else it scores 0.
        """
        fits = [self.fitted(column(shape)) for shape in grid]
        return np.array(
            [fit.score(0) if fit.coefficients[0] > 0 or negative else 0.0 for fit in fits]
        )

    def best(
        self, column: Callable[[float], Array], grid: Array, *, negative: bool = True
    ) -> float:
        """Return the shape with the least sum of squares, off the grid; parameters as above."""
        nothing = float(np.sum(np.square(self.values)))

        def squares(log: float) -> float:
            fit = self.fitted(column(float(np.exp(log))))
            forbidden = not negative and fit.coefficients[0] <= 0
            return nothing if forbidden else float(np.sum(np.square(fit.residual)))

        values = np.array([squares(log) for log in np.log(grid)])
        lowest = int(np.argmin(values))
        bounds = np.log(grid[[max(lowest - 1, 0), min(lowest + 1, len(grid) - 1)]])
        found = minimize_scalar(squares, bounds=bounds, method="bounded", options={"xatol": 1e-3})
        return float(np.exp(found.x)) if found.fun < values[lowest] else float(grid[lowest])
