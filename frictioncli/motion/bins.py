"""Mean torque per angle bin of many constant-velocity spans at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class BinMeans:
    """Means per span and angle bin: those of a span stand together, by growing angle.

    Attributes
    ----------
    span : ndarray of int, shape (visits,)
        Which of the spans, from 0.
    bin : ndarray of int, shape (visits,)
        Number of the bin; bin 0 reaches from 0 to its width.
    n : ndarray of int, shape (visits,)
        Samples.
    torque, load : ndarray, shape (visits,)
        Means, carried to the bin's centre. [N·m]
    time : ndarray, shape (visits,)
        Mean time. [s]
    """

    span: Numbers
    bin: Numbers
    n: Numbers
    torque: Array
    load: Array
    time: Array


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

    A bin that a move crossed only in part has its samples off its centre; left there, the gravity
    torque of the two directions would be taken at different angles.

    Parameters
    ----------
    position, torque, load, time : ndarray, shape (samples,)
        Samples of one recording and joint. [deg], [N·m], [N·m], [s]
    start, stop : ndarray of int, shape (spans,)
        First and past-the-end sample of each span, in order.
    width : float
        Width of the bins. [deg]
    """
    if not len(start):
        none, nothing = np.empty(0, np.int64), np.empty(0)
        return BinMeans(none, none, none, nothing, nothing, nothing)
    number = position / width
    np.floor(number, out=number)
    edge = np.ones(len(number), dtype=bool)
    np.not_equal(number[1:], number[:-1], out=edge[1:])
    edge[start] = True
    edge[stop[stop < len(edge)]] = True
    edges = np.flatnonzero(edge)
    span = np.searchsorted(start, edges, side="right") - 1
    run = np.flatnonzero((span >= 0) & (edges < stop[span]))
    order, head = _by_angle(span[run], number[edges[run]])
    run = run[order]
    count = np.diff(edges, append=len(number))[run]
    count = count if len(head) == len(run) else np.add.reduceat(count, head)
    place, mean_torque, mean_time = (
        _sums(values, edges, run, head) / count for values in (position, torque, time)
    )
    span = span[run][head]
    found = number[edges[run[head]]]
    off = (found + 0.5) * width - place
    mean_load = np.full(len(count), np.nan)
    if not np.isnan(load).all():
        mean_load = _sums(load, edges, run, head) / count
        mean_load += slopes(span, place, mean_load) * off
    return BinMeans(
        span=span,
        bin=found.astype(np.int64),
        n=count,
        torque=mean_torque + slopes(span, place, mean_torque) * off,
        load=mean_load,
        time=mean_time,
    )


def _sums(values: Array, edges: Numbers, run: Numbers, head: Numbers) -> Array:
    """Return sums over runs of samples, in the order given, those of one bin together."""
    sums = np.add.reduceat(values, edges)[run]
    return sums if len(head) == len(run) else np.add.reduceat(sums, head)


def _by_angle(span: Numbers, number: Array) -> tuple[Numbers, Numbers]:
    """Return the order of runs by span and bin, and where in it each bin begins.

    A joint that goes one way meets its bins one after the other, back in the opposite order; only
    where noise takes it to and fro over an edge need they be sorted.
    """
    first = np.flatnonzero(np.diff(span, prepend=-1))
    last = np.append(first[1:], len(span)) - 1
    mirror = np.where(number[first] > number[last], first + last, 0)
    order = np.abs(np.repeat(mirror, last - first + 1) - np.arange(len(span)))
    rising = np.diff(number[order]) > 0
    rising[first[1:] - 1] = True
    if rising.all():
        return order, np.arange(len(order))
    order = np.lexsort((number, span))
    new = (np.diff(number[order]) != 0) | (np.diff(span) != 0)
    return order, np.flatnonzero(np.append(True, new))


def slopes(span: Numbers, place: Array, values: Array) -> Array:
    """Return the slope at each point of piecewise curves, as ``numpy.gradient`` of each does.

    Parameters
    ----------
    span : ndarray of int, shape (points,)
        Curve of each point; those of a curve stand together.
    place, values : ndarray, shape (points,)
        Different places of a curve's points, and what stands there. A curve of one point is flat.
    """
    joined = span[1:] == span[:-1]
    # the next curve may begin where this one ends
    step = np.where(joined, np.diff(place), 1.0)
    steep = np.diff(values) / step
    before, behind = np.append(False, joined), np.append(joined, False)
    steep_before, steep_behind = np.append(0.0, steep), np.append(steep, 0.0)
    step_before, step_behind = np.append(1.0, step), np.append(step, 1.0)
    # of two neighbours, the nearer one's slope counts more
    both = (step_behind * steep_before + step_before * steep_behind) / (step_before + step_behind)
    one_sided = np.where(behind, steep_behind, np.where(before, steep_before, 0.0))
    return np.where(before & behind, both, one_sided)
