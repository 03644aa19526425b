"""Columns in groups, one for each candidate, made orthonormal from their inner products alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags, Indices

_VISIBLE = 1e-3
"""A column of which the base leaves less than this share of its length explains nothing."""

_INDEPENDENT = 1e-4
"""Nor does one of which the other columns of its group leave less than this share."""


def gram_schmidt(inner: Array, squared_length: Array) -> Array:
    r"""Return the transformation that makes columns orthonormal, from their inner products alone.

    For columns :math:`x_j` of unit length with inner products :math:`G`,

    .. math:: M_j = \Big(e_j - \sum_{k<j} (M_k\,G\,e_j)\, M_k\Big) \Big/
        \sqrt{1 - \sum_{k<j} (M_k\,G\,e_j)^2}

    gives :math:`M G M^\mathsf{T} = I`; the rows of columns that are not visible are zero.

    Parameters
    ----------
    inner : ndarray, shape (..., width, width)
        Inner products of what the base leaves of the columns.
    squared_length : ndarray, shape (..., width)
        Squared lengths of the columns before the base is taken out.

    Returns
    -------
    ndarray, shape (..., width, width)
        M; each row holds coefficients of the columns.

    Examples
    --------
    >>> import numpy as np
    >>> inner = np.array([[4.0, 2.0], [2.0, 2.0]])
    >>> transformation = gram_schmidt(inner, np.array([4.0, 2.0]))
    >>> print(transformation @ inner @ transformation.T)
    [[1. 0.]
     [0. 1.]]
    """
    square = np.diagonal(inner, axis1=-2, axis2=-1)
    visible = (square > _VISIBLE**2 * squared_length) & (square > 1e-24)
    size = np.sqrt(np.where(visible, square, np.inf))
    unit = inner / (size[..., :, np.newaxis] * size[..., np.newaxis, :])
    found = np.zeros_like(unit)
    for j in range(unit.shape[-1]):
        earlier = found[..., :j, :]
        share = np.einsum("...ki,...i->...k", earlier, unit[..., j])
        row = -np.einsum("...k,...ki->...i", share, earlier)
        row[..., j] += 1.0
        rest = (unit[..., j, j] - np.sum(np.square(share), axis=-1))[..., np.newaxis]
        found[..., j, :] = np.where(
            rest > _INDEPENDENT**2, row / np.sqrt(np.maximum(rest, _INDEPENDENT**2)), 0.0
        )
    return found / size[..., np.newaxis, :]


@dataclass(frozen=True, slots=True)
class Groups:
    """Division of columns into consecutive groups.

    Attributes
    ----------
    start, width : ndarray of int, shape (groups,)
        Group *i* has ``width[i]`` columns from ``start[i]``.
    """

    start: Indices
    width: Indices

    @classmethod
    def of(cls, widths: Sequence[int]) -> "Groups":
        """Return groups of these widths that follow each other."""
        width = np.array(widths, dtype=np.intp)
        return cls((np.cumsum(width) - width).astype(np.intp), width)

    def columns(self, group: int) -> slice:
        """Return the columns of a group."""
        return slice(int(self.start[group]), int(self.start[group] + self.width[group]))

    def select(self, wanted: Flags) -> tuple["Groups", Indices]:
        """Return some of the groups, and the places of their columns among all."""
        return Groups.of(self.width[wanted].tolist()), np.flatnonzero(np.repeat(wanted, self.width))

    def by_width(self) -> list[tuple[Indices, Indices]]:
        """Return the groups of each width with their columns, shapes (groups,), (groups, width)."""
        found = []
        for width in sorted(set(self.width.tolist())):
            which = np.flatnonzero(self.width == width)
            found.append((which, self.start[which, np.newaxis] + np.arange(width)))
        return found

    def orthonormal(self, columns: Array, residuals: Array) -> Array:
        """Return the residuals of columns orthonormal within each group; zero if not visible.

        Parameters
        ----------
        columns, residuals : ndarray, shape (rows, columns)
            Columns before and after the base is taken out.
        """
        squared_length = np.einsum("ij,ij->j", columns, columns)
        unit = np.empty_like(residuals)
        for _, places in self.by_width():
            own = residuals.T[places]
            transformation = gram_schmidt(own @ own.swapaxes(-1, -2), squared_length[places])
            unit.T[places] = transformation @ own
        return unit

    def explained(self, transformations: Sequence[Array], products: Array) -> Array:
        """Return the sum of squares of data that each group explains, shape (groups, ...).

        Parameters
        ----------
        transformations : sequence of ndarray, shape (groups, width, width)
            As of :func:`gram_schmidt` for each width, in the order of :meth:`by_width`.
        products : ndarray, shape (columns, ...)
            Inner products of the columns with the data.
        """
        found = np.empty((len(self.start), products.shape[1]))
        for (which, columns), one in zip(self.by_width(), transformations, strict=True):
            found[which] = np.sum(np.square(one @ products[columns]), axis=1)
        return found

    def sums(self, values: Array) -> Array:
        """Return sums over the columns of each group, shape (groups, ...)."""
        if not len(self.start):
            return np.zeros((0, values.shape[1]))
        return np.asarray(np.add.reduceat(values, self.start, axis=0))
