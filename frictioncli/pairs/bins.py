"""Mean torque per angle bin of many constant-velocity spans at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.array_runs import offsets
from frictioncli.pairs.bin_runs import bin_runs


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
    runs = bin_runs(
        position=position,
        torque=torque,
        load=load,
        time=time,
        start=start,
        stop=stop,
        width=width,
    )
    run, span, head = _by_angle(runs.bin, np.append(0, runs.end[:-1]), runs.end)
    count = _together(runs.count[run], head)
    place, mean_torque, mean_load, mean_time = (
        _together(sums[run], head) / count
        for sums in (runs.position, runs.torque, runs.load, runs.time)
    )
    found, span = runs.bin[run[head]], span[head]
    off = (found + 0.5) * width - place
    mean_torque += slopes(span, place, mean_torque) * off
    if not np.isnan(mean_load).all():
        mean_load += slopes(span, place, mean_load) * off
    return BinMeans(
        span=span,
        bin=found.astype(np.int64),
        n=count,
        torque=mean_torque,
        load=mean_load,
        time=mean_time,
    )


def _together(values: NDArray, head: Numbers) -> NDArray:
    """Return sums over the runs of each bin, which begin at ``head``."""
    return values if len(head) == len(values) else np.add.reduceat(values, head)


def _by_angle(number: Array, begin: Numbers, end: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Return runs by span and bin, their spans, and where among them each bin begins.

    A joint that goes one way meets its bins one after the other, back in the opposite order; only
    where noise takes it to and fro over an edge need they be sorted.

    Parameters
    ----------
    number : ndarray, shape (runs,)
        Bin of each run of samples in one bin.
    begin, end : ndarray of int, shape (spans,)
        First and past-the-end run of each span.
    """
    count = end - begin
    span = np.repeat(np.arange(len(count)), count)
    # of a span that falls, from the last run back: counted in negative numbers
    first = np.where(number[begin] > number[end - 1], 1 - end, begin)
    run = np.abs(np.repeat(first - offsets(count), count) + np.arange(len(span)))
    own = number[run]
    if ((own[1:] > own[:-1]) | (span[1:] != span[:-1])).all():
        return run, span, np.arange(len(run))
    order = np.lexsort((own, span))
    run, span, own = run[order], span[order], own[order]
    new = (own[1:] != own[:-1]) | (span[1:] != span[:-1])
    return run, span, np.flatnonzero(np.append(True, new))


def slopes(span: Numbers, place: Array, values: Array) -> Array:
    """Return the slope at each point of piecewise curves, as ``numpy.gradient`` of each does.

    Parameters
    ----------
    span : ndarray of int, shape (points,)
        Curve of each point; those of a curve stand together.
    place, values : ndarray, shape (points,)
        Different places of a curve's points, and what stands there. A curve of one point is flat.
    """
    n = len(span)
    # between a curve's points; before its first and behind its last one 0 over 1
    joined, step, steep = np.zeros(n + 1, dtype=bool), np.ones(n + 1), np.zeros(n + 1)
    np.equal(span[1:], span[:-1], out=joined[1:-1])
    np.subtract(place[1:], place[:-1], out=step[1:-1], where=joined[1:-1])
    np.subtract(values[1:], values[:-1], out=steep[1:-1], where=joined[1:-1])
    steep /= step
    # of two neighbours, the nearer one's slope counts more
    both = step[1:] * steep[:-1] + step[:-1] * steep[1:]
    both /= step[:-1] + step[1:]
    return np.where(joined[:-1] & joined[1:], both, steep[:-1] + steep[1:])
