"""Operations on many slices of an array at once: sums, means, indices and runs.

Slices are given by the arrays ``start`` and ``stop`` of first and past-the-end indices.
"""

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Flags, Numbers

_LARGEST_ARRAY = 1 << 22
"""Values of the largest array whose memory the C library may be made to keep: 32 MB."""


def keep_freed_memory() -> None:
    """Let the C library use freed memory again, instead of asking the system for each new array.

    glibc returns the memory of large arrays at once, until it has seen a larger one freed. That
    costs more than the sums over arrays of half a megabyte. Other C libraries are not affected.
    """
    np.empty(_LARGEST_ARRAY - (1 << 14))


def slice_indices(start: Numbers, stop: Numbers) -> Numbers:
    """Return the indices in all slices, one slice after the other.

    Parameters
    ----------
    start, stop : ndarray of int, shape (slices,)
        First and past-the-end index of each slice.

    Returns
    -------
    ndarray of int, shape (sum of lengths,)
        Indices.

    Examples
    --------
    >>> slice_indices(np.array([0, 5]), np.array([2, 8]))
    array([0, 1, 5, 6, 7])
    """
    length = stop - start
    return np.repeat(start - slice_offsets(length), length) + np.arange(int(length.sum()))


def slice_offsets(length: Numbers) -> Numbers:
    """Return where each slice begins when slices of these lengths are put end to end."""
    return np.cumsum(length) - length


def fill_slices(values: Array, start: Numbers, stop: Numbers, size: int, outside: float) -> Array:
    """Return an array that has one value in each slice and another outside of all.

    Parameters
    ----------
    values : ndarray, shape (slices,)
        Value of each slice.
    start, stop : ndarray of int, shape (slices,)
        First and past-the-end index of slices that do not overlap, in order.
    size : int
        Length of the result.
    outside : float
        Value outside of all slices.

    Returns
    -------
    ndarray, shape (size,)
        Values.

    Examples
    --------
    >>> fill_slices(np.array([1.0, 2.0]), np.array([0, 3]), np.array([2, 4]), 5, 0.0)
    array([1., 1., 0., 2., 0.])
    """
    bounds = np.column_stack([start, stop]).ravel()
    length = np.diff(bounds, prepend=0, append=size)
    filled = np.full(len(length), outside)
    filled[1::2] = values
    return np.repeat(filled, length)


def reduce_slices(function: np.ufunc, values: NDArray, start: Numbers, stop: Numbers) -> NDArray:
    """Return the reduction of each slice by a ufunc.

    Parameters
    ----------
    function : ufunc
        ``np.add``, ``np.maximum``, ...
    values : ndarray, shape (samples,)
        Values to reduce.
    start, stop : ndarray of int, shape (slices,)
        First and past-the-end index of slices that are not empty and do not overlap, in order.

    Returns
    -------
    ndarray, shape (slices,)
        Reductions.

    Examples
    --------
    >>> reduce_slices(np.add, np.arange(5.0), np.array([0, 3]), np.array([2, 5]))
    array([1., 7.])
    """
    if not len(start):
        return values[:0]
    edges = np.column_stack([start, stop]).ravel()
    # the end of the last slice may lie behind the last value, where reduceat cannot look
    return function.reduceat(values[: stop[-1]], edges[:-1])[::2]


def slice_means(values: Array, start: Numbers, stop: Numbers) -> Array:
    """Return the mean of the finite values of each slice; NaN where it has none.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        Values to average.
    start, stop : ndarray of int, shape (slices,)
        First and past-the-end index of slices that are not empty and do not overlap, in order.

    Returns
    -------
    ndarray, shape (slices,)
        Means.

    Examples
    --------
    >>> slice_means(np.array([1.0, np.nan, 3.0, np.nan]), np.array([0, 3]), np.array([3, 4]))
    array([ 2., nan])
    """
    with np.errstate(invalid="ignore"):
        total = reduce_slices(np.add, values, start, stop)
    if np.isfinite(total).all():
        return total / (stop - start)
    finite = np.isfinite(values)
    count = reduce_slices(np.add, finite.astype(float), start, stop)
    total = reduce_slices(np.add, np.where(finite, values, 0.0), start, stop)
    return np.divide(total, count, out=np.full(len(start), np.nan), where=count > 0)


def true_runs(flags: Flags, offset: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Return start, stop and slice of each run of true flags within one slice.

    Parameters
    ----------
    flags : ndarray of bool, shape (samples,)
        Flags, all false between the slices.
    offset : ndarray of int, shape (slices,)
        First index of each slice, in order.

    Returns
    -------
    start, stop : ndarray of int, shape (runs,)
        First and past-the-end index of each run.
    number : ndarray of int, shape (runs,)
        Slice of each run.

    Examples
    --------
    >>> start, stop, number = true_runs(np.array([True, True, False, True]), np.array([0, 1]))
    >>> start.tolist(), stop.tolist(), number.tolist()
    ([0, 1, 3], [1, 2, 4], [0, 1, 1])
    """
    edge = np.empty(len(flags) + 1, dtype=bool)
    edge[1:-1] = flags[1:] != flags[:-1]
    edge[offset] = edge[0] = edge[-1] = True
    edges = np.flatnonzero(edge)
    start, stop = edges[:-1], edges[1:]
    held = flags[start]
    start, stop = start[held], stop[held]
    return start, stop, np.searchsorted(offset, start, side="right") - 1
