"""Sums over runs of samples in one angle bin: by ``_bin_runs.c`` where it was built.

Without it numpy makes the same sums, to the last bit, in several passes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.array_runs import members

try:
    from frictioncli.pairs import _bin_runs
except ImportError:  # installed without a C compiler
    _bin_runs = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True)
class BinRuns:
    """Consecutive samples of a span in one angle bin, all of shape (runs,) but ``end``.

    Attributes
    ----------
    bin : ndarray
        Number of the bin, whole; bin 0 reaches from 0 to its width.
    position, torque, load, time : ndarray
        Sums over the samples; the load's NaN where one of them has none. [deg], [N·m], [s]
    count : ndarray of int
        Samples.
    end : ndarray of int, shape (spans,)
        Past-the-end run of each span; the first one's first is 0.
    """

    bin: Array
    position: Array
    torque: Array
    load: Array
    time: Array
    count: Numbers
    end: Numbers


def bin_runs(
    *,
    position: Array,
    torque: Array,
    load: Array,
    time: Array,
    start: Numbers,
    stop: Numbers,
    width: float,
) -> BinRuns:
    """Return the runs of samples in one angle bin, span after span; see :func:`bins.bin_means`."""
    samples = [np.ascontiguousarray(values) for values in (position, torque, load, time)]
    if _bin_runs is None:
        return _in_passes(samples, start, stop, width)
    room = int((stop - start).sum())
    sums, count, end = np.empty((5, room)), np.empty(room, np.int64), np.empty_like(start)
    given = [array.data for array in (*samples, start, stop)]
    _bin_runs.runs(*given, width, sums.data, count.data, end.data)
    runs = int(end[-1]) if len(end) else 0
    return _bin_runs_of(sums[0, :runs], list(sums[1:, :runs]), count[:runs], end)


def _in_passes(samples: Sequence[Array], start: Numbers, stop: Numbers, width: float) -> BinRuns:
    inside = members(start, stop)
    number = np.floor(samples[0][inside] / width)
    last = np.cumsum(stop - start)
    new = np.ones(len(inside) + 1, dtype=bool)
    np.not_equal(number[1:], number[:-1], out=new[1:-1])
    new[last] = True
    edges = np.flatnonzero(new)
    count = np.diff(edges)
    run = np.repeat(np.arange(len(count)), count)
    # added one after the other, unlike numpy.add.reduceat
    sums = [np.asarray(np.bincount(run, values[inside]), np.float64) for values in samples]
    return _bin_runs_of(number[edges[:-1]], sums, count, np.searchsorted(edges, last))


def _bin_runs_of(number: Array, sums: Sequence[Array], count: Numbers, end: Numbers) -> BinRuns:
    position, torque, load, time = sums
    return BinRuns(number, position, torque, load, time, count, end)
