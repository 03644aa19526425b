"""Segments of arrays: sums, runs and members of many stretches of samples at once."""

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Flags, Numbers

_ARRAY = 1 << 22
"""Values of the largest array whose memory the C library may be taught to keep: 32 MB."""


def keep_freed_memory() -> None:
    """Let the C library use freed memory again, instead of asking the system for each new array.

    glibc hands memory of large arrays back at once, until it has seen a larger one freed. That
    costs more than the sums over arrays of half a megabyte. Other C libraries do not mind.
    """
    np.empty(_ARRAY - (1 << 14))


def members(start: Numbers, stop: Numbers) -> Numbers:
    """Return the numbers of all samples of the segments, one segment after the other.

    Parameters
    ----------
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of each.
    """
    length = stop - start
    return np.repeat(start - offsets(length), length) + np.arange(int(length.sum()))


def offsets(length: Numbers) -> Numbers:
    """Return where each segment begins when segments of these lengths are put end to end."""
    return np.cumsum(length) - length


def over_samples(values: Array, start: Numbers, stop: Numbers, size: int, outside: float) -> Array:
    """Return for each of ``size`` samples the value of its segment.

    Parameters
    ----------
    values : ndarray, shape (segments,)
        What the samples of each segment get.
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of segments that do not overlap, in order.
    size : int
        Samples.
    outside : float
        What those in no segment get.
    """
    bounds = np.column_stack([start, stop]).ravel()
    length = np.diff(bounds, prepend=0, append=size)
    held = np.full(len(length), outside)
    held[1::2] = values
    return np.repeat(held, length)


def reduced(function: np.ufunc, values: NDArray, start: Numbers, stop: Numbers) -> NDArray:
    """Return a ufunc's reduction over each segment.

    Parameters
    ----------
    function : ufunc
        ``np.add``, ``np.maximum``, ...
    values : ndarray, shape (samples,)
        What is reduced.
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of segments that hold one sample at least and do not overlap,
        in order.
    """
    if not len(start):
        return values[:0]
    edges = np.column_stack([start, stop]).ravel()
    # the end of the last one may lie behind the last sample, where reduceat cannot look
    return function.reduceat(values[: stop[-1]], edges[:-1])[::2]


def means(values: Array, start: Numbers, stop: Numbers) -> Array:
    """Return the mean of each segment's finite values; NaN where it has none.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        What is averaged.
    start, stop : ndarray of int, shape (segments,)
        As for :func:`reduced`.
    """
    with np.errstate(invalid="ignore"):
        total = reduced(np.add, values, start, stop)
    if np.isfinite(total).all():
        return total / (stop - start)
    finite = np.isfinite(values)
    count = reduced(np.add, finite.astype(float), start, stop)
    total = reduced(np.add, np.where(finite, values, 0.0), start, stop)
    return np.divide(total, count, out=np.full(len(start), np.nan), where=count > 0)


def runs(flags: Flags, offset: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Return start, stop and segment of each run of true flags within one segment.

    Parameters
    ----------
    flags : ndarray of bool, shape (samples,)
        Segments in order, none true between them.
    offset : ndarray of int, shape (segments,)
        Where each begins.
    """
    edge = np.empty(len(flags) + 1, dtype=bool)
    edge[1:-1] = flags[1:] != flags[:-1]
    edge[offset] = edge[0] = edge[-1] = True
    edges = np.flatnonzero(edge)
    start, stop = edges[:-1], edges[1:]
    held = flags[start]
    start, stop = start[held], stop[held]
    return start, stop, np.searchsorted(offset, start, side="right") - 1
