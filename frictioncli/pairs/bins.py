"""Mean torque per angle bin of many constant-speed segments at once.

The sums over samples are made by ``_bin_runs.c`` where it was built. Without it numpy makes the
same sums, to the last bit, in several passes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.slices import slice_indices, slice_offsets

try:
    from frictioncli.pairs import _bin_runs
except ImportError:  # installed without a C compiler
    _bin_runs = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True)
class BinMeans:
    """Means per segment and angle bin; those of a segment stand together, by growing angle.

    Attributes
    ----------
    segment : ndarray of int, shape (rows,)
        Number of the segment, from 0.
    bin : ndarray of int, shape (rows,)
        Number of the bin; bin 0 reaches from 0 to its width.
    n : ndarray of int, shape (rows,)
        Number of samples.
    torque, load : ndarray, shape (rows,)
        Means, carried to the centre of the bin. [N·m]
    time : ndarray, shape (rows,)
        Mean time. [s]
    """

    segment: Numbers
    bin: Numbers
    n: Numbers
    torque: Array
    load: Array
    time: Array


@dataclass(frozen=True, slots=True)
class BinRuns:
    """Sums over runs of consecutive samples of a segment in one angle bin.

    Attributes
    ----------
    bin : ndarray, shape (runs,)
        Number of the bin, whole; bin 0 reaches from 0 to its width.
    position : ndarray, shape (runs,)
        Sum of the angles. [deg]
    torque, load : ndarray, shape (runs,)
        Sums; the load's is NaN where a sample has none. [N·m]
    time : ndarray, shape (runs,)
        Sum of the times. [s]
    count : ndarray of int, shape (runs,)
        Number of samples.
    end : ndarray of int, shape (segments,)
        Past-the-end run of each segment; the first run of the first segment is 0.
    """

    bin: Array
    position: Array
    torque: Array
    load: Array
    time: Array
    count: Numbers
    end: Numbers


def bin_means(
    *,
    position: Array,
    torque: Array,
    load: Array,
    time: Array,
    start: Numbers,
    stop: Numbers,
    width: float,
) -> BinMeans:
    """Return mean torque per angle bin, carried to the bin's centre along the torque's slope.

    The samples of a bin that a segment covers only in part have their mean off its centre. Without
    the correction, the gravity torques of the two directions would belong to different angles.

    Parameters
    ----------
    position, torque, load, time : ndarray, shape (samples,)
        Samples of one recording and joint. [deg], [N·m], [N·m], [s]
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of each segment, in order.
    width : float
        Width of the bins. [deg]

    Returns
    -------
    BinMeans
        Means, a row per segment and bin.

    Examples
    --------
    >>> position = np.array([1.0, 3.0, 6.0, 8.0])
    >>> means = bin_means(
    ...     position=position,
    ...     torque=2.0 * position,
    ...     load=np.full(4, np.nan),
    ...     time=np.arange(4.0),
    ...     start=np.array([0]),
    ...     stop=np.array([4]),
    ...     width=5.0,
    ... )
    >>> means.bin, means.torque
    (array([0, 1]), array([ 5., 15.]))
    """
    if not len(start):
        none, nothing = np.empty(0, np.int64), np.empty(0)
        return BinMeans(none, none, none, nothing, nothing, nothing)
    runs = bin_runs(
        position=position,
        torque=torque,
        load=load,
        time=time,
        start=start,
        stop=stop,
        width=width,
    )
    run, segment, head = _by_angle(runs.bin, np.append(0, runs.end[:-1]), runs.end)
    count = _sum_runs(runs.count[run], head)
    mean_position, mean_torque, mean_load, mean_time = (
        _sum_runs(sums[run], head) / count
        for sums in (runs.position, runs.torque, runs.load, runs.time)
    )
    number, segment = runs.bin[run[head]], segment[head]
    off_centre = (number + 0.5) * width - mean_position
    mean_torque += slopes(segment, mean_position, mean_torque) * off_centre
    if not np.isnan(mean_load).all():
        mean_load += slopes(segment, mean_position, mean_load) * off_centre
    return BinMeans(
        segment=segment,
        bin=number.astype(np.int64),
        n=count,
        torque=mean_torque,
        load=mean_load,
        time=mean_time,
    )


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
    """Return sums over runs of samples in one angle bin; parameters as of :func:`bin_means`."""
    samples = [np.ascontiguousarray(values) for values in (position, torque, load, time)]
    if _bin_runs is None:
        return _bin_runs_by_numpy(samples, start, stop, width)
    room = int((stop - start).sum())
    sums, count, end = np.empty((5, room)), np.empty(room, np.int64), np.empty_like(start)
    given = [array.data for array in (*samples, start, stop)]
    _bin_runs.runs(*given, width, sums.data, count.data, end.data)
    runs = int(end[-1]) if len(end) else 0
    return _bin_runs_of(sums[0, :runs], list(sums[1:, :runs]), count[:runs], end)


def slopes(segment: Numbers, position: Array, values: Array) -> Array:
    """Return the slope at each point of piecewise curves, as ``numpy.gradient`` of each does.

    Parameters
    ----------
    segment : ndarray of int, shape (points,)
        Segment of each point; the points of a segment stand together.
    position, values : ndarray, shape (points,)
        Positions, all different within a segment, and the values there.

    Returns
    -------
    ndarray, shape (points,)
        Slopes; 0 for a segment of one point.

    Examples
    --------
    >>> position, values = np.array([0.0, 1.0, 2.0, 0.0]), np.array([0.0, 1.0, 4.0, 5.0])
    >>> slopes(np.array([0, 0, 0, 1]), position, values)
    array([1., 2., 3., 0.])
    """
    n = len(segment)
    # differences between points of a segment; before its first and behind its last point 0 over 1
    joined, step, steep = np.zeros(n + 1, dtype=bool), np.ones(n + 1), np.zeros(n + 1)
    np.equal(segment[1:], segment[:-1], out=joined[1:-1])
    np.subtract(position[1:], position[:-1], out=step[1:-1], where=joined[1:-1])
    np.subtract(values[1:], values[:-1], out=steep[1:-1], where=joined[1:-1])
    steep /= step
    # the slope towards the nearer neighbour has the greater weight
    both = step[1:] * steep[:-1] + step[:-1] * steep[1:]
    both /= step[:-1] + step[1:]
    return np.where(joined[:-1] & joined[1:], both, steep[:-1] + steep[1:])


def _sum_runs(values: NDArray, head: Numbers) -> NDArray:
    """Return sums over the runs of each bin, which begin at ``head``."""
    return values if len(head) == len(values) else np.add.reduceat(values, head)


def _by_angle(number: Array, begin: Numbers, end: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Return runs by segment and bin, their segments, and where among them each bin begins.

    A joint that moves forward crosses its bins in ascending order, in reverse in descending order.
    Only where noise takes it to and fro over a bin's edge must the runs be sorted.

    Parameters
    ----------
    number : ndarray, shape (runs,)
        Bin of each run.
    begin, end : ndarray of int, shape (segments,)
        First and past-the-end run of each segment.
    """
    count = end - begin
    segment = np.repeat(np.arange(len(count)), count)
    # of a segment in reverse, from the last run back: counted in negative numbers
    first = np.where(number[begin] > number[end - 1], 1 - end, begin)
    run = np.abs(np.repeat(first - slice_offsets(count), count) + np.arange(len(segment)))
    ordered = number[run]
    if ((ordered[1:] > ordered[:-1]) | (segment[1:] != segment[:-1])).all():
        return run, segment, np.arange(len(run))
    order = np.lexsort((ordered, segment))
    run, segment, ordered = run[order], segment[order], ordered[order]
    new = (ordered[1:] != ordered[:-1]) | (segment[1:] != segment[:-1])
    return run, segment, np.flatnonzero(np.append(True, new))


def _bin_runs_by_numpy(
    samples: Sequence[Array], start: Numbers, stop: Numbers, width: float
) -> BinRuns:
    inside = slice_indices(start, stop)
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
