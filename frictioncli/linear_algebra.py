"""Least squares from inner products: pseudo-inverses, Schur complements, bases and residuals.

A matrix of inner products ``G = X.T @ X`` of columns ``X`` in different units is badly scaled. The
functions here scale columns to unit length first, so that one relative tolerance decides which
directions the columns determine.
"""

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from frictioncli.arrays import Array


def gram_inverse(gram: Array, *, tolerance: float) -> Array:
    """Return the pseudo-inverse of inner products of columns of comparable length.

    Parameters
    ----------
    gram : ndarray, shape (..., columns, columns)
        Symmetric, positive semidefinite.
    tolerance : float
        Eigenvalues below this share of the greatest count as zero.

    Returns
    -------
    ndarray, shape (..., columns, columns)
        The Moore-Penrose inverse.

    Examples
    --------
    >>> import numpy as np
    >>> inverse = gram_inverse(np.array([[1.0, 1.0], [1.0, 1.0]]), tolerance=1e-9)
    >>> print(inverse.round(6))
    [[0.25 0.25]
     [0.25 0.25]]
    """
    return np.asarray(np.linalg.pinv(gram, rcond=tolerance, hermitian=True))


def scaled_gram_inverse(gram: Array, *, tolerance: float, absent: float = 0.0) -> Array:
    """Return the pseudo-inverse of inner products of columns in any units.

    Columns are scaled to unit length before the inversion, and the result is scaled back. Rows and
    columns of absent columns are zero in it.

    Parameters
    ----------
    gram : ndarray, shape (..., columns, columns)
        Symmetric, positive semidefinite.
    tolerance : float
        Eigenvalues below this share of the greatest count as zero, for columns of unit length.
    absent : float, optional
        A column of no more than this squared length counts as zero.

    Returns
    -------
    ndarray, shape (..., columns, columns)
        The inverse in the units of the columns.

    Examples
    --------
    >>> import numpy as np
    >>> scaled_gram_inverse(np.diag([1e-12, 4e12, 0.0]), tolerance=1e-9)
    array([[1.0e+12, 0.0e+00, 0.0e+00],
           [0.0e+00, 2.5e-13, 0.0e+00],
           [0.0e+00, 0.0e+00, 0.0e+00]])
    """
    squared = np.diagonal(gram, axis1=-2, axis2=-1)
    size = np.where(squared > absent, np.sqrt(np.maximum(squared, 0.0)), np.inf)
    sizes = _outer(size)
    return gram_inverse(gram / sizes, tolerance=tolerance) / sizes


def schur_complement(gram: Array, count: int, *, tolerance: float) -> tuple[Array, Array]:
    r"""Return the inner products of what the first columns leave of the others, at unit length.

    With the blocks *A*, *B* and *D* of the scaled inner products
    :math:`\begin{pmatrix} A & B \\ B^\mathsf{T} & D \end{pmatrix}` that is the Schur complement
    :math:`D - B^\mathsf{T} A^{+} B`.

    Parameters
    ----------
    gram : ndarray, shape (..., columns, columns)
        Symmetric, positive semidefinite.
    count : int
        Number of the first columns.
    tolerance : float
        As of :func:`gram_inverse`, for the first columns at unit length.

    Returns
    -------
    complement : ndarray, shape (..., others, others)
        Inner products of the residuals of the other columns, each divided by the length of its
        column: 1 on the diagonal where the first columns explain nothing, 0 where they explain all.
    size : ndarray, shape (..., others)
        Lengths of the other columns.

    Examples
    --------
    >>> import numpy as np
    >>> complement, size = schur_complement(np.array([[1.0, 1.0], [1.0, 4.0]]), 1, tolerance=1e-9)
    >>> print(complement, size)
    [[0.75]] [2.]
    """
    size = np.sqrt(np.maximum(np.diagonal(gram, axis1=-2, axis2=-1), 1e-300))
    scaled = gram / _outer(size)
    inner = gram_inverse(scaled[..., :count, :count], tolerance=tolerance)
    across = scaled[..., :count, count:]
    explained = np.ascontiguousarray(across.swapaxes(-1, -2)) @ inner @ across
    return np.asarray(scaled[..., count:, count:] - explained), size[..., count:]


def least_squares_residual(columns: Array, target: Array, *, tolerance: float) -> Array:
    """Return what a linear combination of columns leaves of a target by least squares.

    Parameters
    ----------
    columns : ndarray, shape (rows, columns)
        The columns, in any units; those of zeros explain nothing.
    target : ndarray, shape (rows,)
        What they are fitted to.
    tolerance : float
        Singular values below this share of the greatest count as zero, for columns of unit length.

    Returns
    -------
    ndarray, shape (rows,)
        Target minus fit.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.column_stack([np.ones(3), np.arange(3.0)])
    >>> print(least_squares_residual(line, np.array([0.0, 3.0, 0.0]), tolerance=1e-9).round(6))
    [-1.  2. -1.]
    """
    size = np.linalg.norm(columns, axis=0)
    unit = columns[:, size > 0] / size[size > 0]
    return np.asarray(target - unit @ np.linalg.lstsq(unit, target, rcond=tolerance)[0])


def orthonormal_basis(columns: Array, *, tolerance: float) -> Array:
    """Return an orthonormal basis of the span of columns.

    Parameters
    ----------
    columns : ndarray, shape (rows, columns)
        The columns, in any units; those shorter than 1e-12 count as zero.
    tolerance : float
        Singular values below this share of the greatest count as zero, for columns of unit length.

    Returns
    -------
    ndarray, shape (rows, rank)
        The basis.

    Examples
    --------
    >>> import numpy as np
    >>> orthonormal_basis(np.array([[1.0, 2.0], [1.0, 2.0]]), tolerance=1e-7).shape
    (2, 1)
    """
    kept = unit_columns(columns)
    if not kept.shape[1]:
        return np.empty((len(columns), 0))
    left, strength, _ = np.linalg.svd(kept, full_matrices=False)
    return np.asarray(left[:, strength > tolerance * strength[0]])


def unit_columns(columns: Array) -> Array:
    """Return columns at unit length, without those shorter than 1e-12.

    Parameters
    ----------
    columns : ndarray, shape (rows, columns)
        The columns, in any units.
    """
    size = np.linalg.norm(columns, axis=0)
    return columns[:, size > 1e-12] / size[size > 1e-12]


def inverse_and_determinant(gram: Array) -> tuple[Array, float]:
    """Return the inverse of a symmetric, positive definite matrix and its log determinant.

    By a Cholesky factor; where rounding spoils that, by elimination.

    Parameters
    ----------
    gram : ndarray, shape (columns, columns)
        The matrix.

    Examples
    --------
    >>> import numpy as np
    >>> inverse, determinant = inverse_and_determinant(np.array([[4.0, 2.0], [2.0, 2.0]]))
    >>> print(inverse, round(determinant, 6))
    [[ 0.5 -0.5]
     [-0.5  1. ]] 1.386294
    """
    factor, fault = dpotrf(gram, lower=True) if len(gram) else (gram, 1)
    if fault:
        return np.asarray(np.linalg.inv(gram), float), float(np.linalg.slogdet(gram)[1])
    half, _ = dpotri(factor, lower=True)
    inverse = half + np.tril(half, -1).T
    return np.asarray(inverse), 2 * float(np.sum(np.log(np.diagonal(factor))))


def _outer(size: Array) -> Array:
    """Return the products of the columns' lengths, shape (..., columns, columns)."""
    return size[..., :, np.newaxis] * size[..., np.newaxis, :]
