"""Inner products of the columns of the base, decomposed under each noise model."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.transformed_columns import Part


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseProducts:
    """Inner products of the pair means of the base's columns under each noise model, decomposed.

    Attributes
    ----------
    size : ndarray, shape (noise models, columns)
        Length of each column; infinite where it is none.
    vectors : ndarray, shape (noise models, columns, columns)
        Eigenvectors of the products of columns of unit length.
    inverse : ndarray, shape (noise models, columns)
        Inverse of the eigenvalues; 0 where they count as zero.
    rank : int
        Greatest number of those that do not.
    determinant : ndarray, shape (noise models,)
        Logarithm of the determinant.
    """

    size: Array
    vectors: Array
    inverse: Array
    rank: int
    determinant: Array

    @classmethod
    def of(cls, own: Array) -> "BaseProducts":
        """Return the decomposition of inner products, shape (noise models, columns, columns)."""
        size = np.sqrt(np.maximum(np.diagonal(own, axis1=1, axis2=2), 0.0))
        size = np.where(size > 1e-12 * (1 + size.max(initial=0.0)), size, np.inf)
        values, vectors = np.linalg.eigh(own / (size[:, :, np.newaxis] * size[:, np.newaxis, :]))
        kept = values > 1e-8
        finite = np.where(np.isfinite(size), size, 1.0)
        logarithms = np.sum(np.where(kept, np.log(np.where(kept, values, 1.0)), 0.0), axis=1)
        return cls(
            size=size,
            vectors=vectors,
            inverse=np.where(kept, 1 / np.where(kept, values, 1.0), 0.0),
            rank=int(kept.sum(axis=1).max(initial=0)),
            determinant=logarithms + 2 * np.sum(np.log(finite), axis=1),
        )

    @classmethod
    def of_part(cls, part: Part, base: int) -> tuple["BaseProducts", "BaseProducts"]:
        """Return the decomposition for the first columns of a part, in friction and load.

        Parameters
        ----------
        part : Part
            The part.
        base : int
            Number of the columns of the base.
        """
        return cls._in_channel(part, base, 0), cls._in_channel(part, base, 1)

    @classmethod
    def _in_channel(cls, part: Part, base: int, channel: int) -> "BaseProducts":
        noises, means = part.noises, part.columns.channels[channel].means[:, :base]
        scaled = noises.spectra[channel].scaled(means)
        own = scaled.T @ noises.inverses(channel).times(scaled)
        return cls.of(own)

    def explained(self, right: Array) -> Array:
        """Return what the base explains of a column, from its inner products with it.

        Parameters
        ----------
        right : ndarray, shape (noise models, columns)
            Inner products of the base with the column.
        """
        projected = ((right / self.size)[:, np.newaxis] @ self.vectors)[:, 0]
        return np.asarray(np.sum(np.square(projected) * self.inverse, axis=1))
