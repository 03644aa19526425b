"""One level per pair of moves and one per angle, taken off columns of a regression.

References
----------
.. [1] B. H. Baltagi, Econometric Analysis of Panel Data, 2021, doi:10.1007/978-3-030-53953-5.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices

TOLERANCE = 1e-9
"""Share of the squared length below which nothing is left of a column."""


@dataclass(frozen=True, slots=True)
class Levels:
    """One level per pair and one per angle (two-way fixed effects [1]_).

    Attributes
    ----------
    pair, angle : ndarray of int, shape (rows,)
        Numbers of both, from 0 without gaps.
    pairs : ndarray, shape (pairs,)
        Rows of each pair.
    inverse : ndarray, shape (angles, angles)
        Pseudo-inverse of the inner products of the angles' columns within the pairs.
    rank : int
        Number of levels of angles that the pairs determine.
    """

    pair: Indices
    angle: Indices
    pairs: Array
    inverse: Array
    rank: int

    @classmethod
    def of(cls, pair: Indices, angle: Indices) -> "Levels":
        """Return the levels of rows with these pairs and angles."""
        pairs = np.bincount(pair).astype(float)
        count = int(angle.max()) + 1
        both = np.bincount(pair * count + angle, minlength=len(pairs) * count)
        both = both.reshape(len(pairs), count).astype(float)
        products = np.diag(both.sum(axis=0)) - both.T @ (both / pairs[:, np.newaxis])
        values, vectors = np.linalg.eigh(products)
        kept = values > TOLERANCE * max(float(values[-1]), 1e-300)
        inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
        return cls(pair, angle, pairs, inverse, int(kept.sum()))

    def taken_off(self, columns: Array) -> Array:
        """Return what the levels leave of columns, shape (rows, columns)."""
        return np.column_stack([self._taken_off(column) for column in columns.T])

    def _taken_off(self, column: Array) -> Array:
        within = self._within(column)
        by_angle = np.bincount(self.angle, within, minlength=len(self.inverse))
        return within - self._within((self.inverse @ by_angle)[self.angle])

    def _within(self, column: Array) -> Array:
        return np.asarray(column - (np.bincount(self.pair, column) / self.pairs)[self.pair])
