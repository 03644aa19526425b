"""Columns in groups, one for each rival, made orthonormal from their inner products alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags, Indices

_VISIBLE = 1e-3
"""A column of which the base leaves less than this share says nothing of its own."""

_OWN = 1e-4
"""Nor does one of which the others of its group leave less than this share."""


def unmixing(inner: Array, before: Array) -> Array:
    r"""Return what makes columns orthonormal, from their inner products alone.

    Gram and Schmidt's way. For columns :math:`x_j` of unit length with inner products :math:`G`,

    .. math:: M_j = \Big(e_j - \sum_{k<j} (M_k\,G\,e_j)\, M_k\Big) \Big/
        \sqrt{1 - \sum_{k<j} (M_k\,G\,e_j)^2}

    gives :math:`M G M^\mathsf{T} = I`; the rows of columns that are not visible are zero.

    Parameters
    ----------
    inner : ndarray, shape (..., width, width)
        Inner products of what the base leaves of the columns.
    before : ndarray, shape (..., width)
        Squared lengths of the whole columns.

    Returns
    -------
    ndarray, shape (..., width, width)
        Rows of coefficients of the columns.
    """
    square = np.diagonal(inner, axis1=-2, axis2=-1)
    seen = (square > _VISIBLE**2 * before) & (square > 1e-24)
    size = np.sqrt(np.where(seen, square, np.inf))
    unit = inner / (size[..., :, np.newaxis] * size[..., np.newaxis, :])
    found = np.zeros_like(unit)
    for j in range(unit.shape[-1]):
        earlier = found[..., :j, :]
        share = np.einsum("...ki,...i->...k", earlier, unit[..., j])
        row = -np.einsum("...k,...ki->...i", share, earlier)
        row[..., j] += 1.0
        rest = (unit[..., j, j] - np.sum(np.square(share), axis=-1))[..., np.newaxis]
        found[..., j, :] = np.where(rest > _OWN**2, row / np.sqrt(np.maximum(rest, _OWN**2)), 0.0)
    return found / size[..., np.newaxis, :]


@dataclass(frozen=True, slots=True)
class Groups:
    """How columns are grouped: group *i* has ``width[i]`` columns from ``start[i]``."""

    start: Indices
    width: Indices

    @classmethod
    def of(cls, widths: Sequence[int]) -> "Groups":
        """Return groups that follow each other."""
        width = np.array(widths, dtype=np.intp)
        return cls((np.cumsum(width) - width).astype(np.intp), width)

    def columns(self, group: int) -> slice:
        """Return the columns of a group."""
        return slice(int(self.start[group]), int(self.start[group] + self.width[group]))

    def chosen(self, wanted: Flags) -> tuple["Groups", Indices]:
        """Return some of the groups, and the places of their columns among all."""
        return Groups.of(self.width[wanted].tolist()), np.flatnonzero(np.repeat(wanted, self.width))

    def alike(self) -> list[tuple[Indices, Indices]]:
        """Return the groups of each width with their columns, shapes (groups,), (groups, width)."""
        found = []
        for wide in sorted(set(self.width.tolist())):
            which = np.flatnonzero(self.width == wide)
            found.append((which, self.start[which, np.newaxis] + np.arange(wide)))
        return found

    def orthonormal(self, whole: Array, left: Array) -> Array:
        """Return the columns orthonormal within each group; what is not visible becomes zero.

        Parameters
        ----------
        whole, left : ndarray, shape (rows, columns)
            Columns before and after the base has taken its share.
        """
        before = np.einsum("ij,ij->j", whole, whole)
        unit = np.empty_like(left)
        for _, columns in self.alike():
            own = left.T[columns]
            mixing = unmixing(own @ own.swapaxes(-1, -2), before[columns])
            unit.T[columns] = mixing @ own
        return unit

    def taken(self, mixings: Sequence[Array], products: Array) -> Array:
        """Return what each group takes of the square sums of data, shape (groups, ...).

        Parameters
        ----------
        mixings : sequence of ndarray, shape (groups, width, width)
            What makes the columns of each width orthonormal, in the order of :meth:`alike`.
        products : ndarray, shape (columns, ...)
            Inner products of the columns with the data.
        """
        found = np.empty((len(self.start), products.shape[1]))
        for (which, columns), mixing in zip(self.alike(), mixings, strict=True):
            found[which] = np.sum(np.square(mixing @ products[columns]), axis=1)
        return found

    def sums(self, values: Array) -> Array:
        """Return sums over the columns of each group, shape (groups, ...)."""
        if not len(self.start):
            return np.zeros((0, values.shape[1]))
        return np.asarray(np.add.reduceat(values, self.start, axis=0))
