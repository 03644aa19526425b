"""Neighbouring pairs at one speed: groups whose deviations are pooled, and jumps between them.

What is the same in neighbouring pairs is pooled without loss. Where a payload comes or goes it is
not the same: a group ends there, and the change is no noise.
"""

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Indices

_JUMP = 16.0
"""Mean square of a change from pair to pair, relative to the usual one, that is no noise."""

_POOLED = 5
"""Neighbouring pairs at one speed whose deviations are pooled."""


def neighbours(run: Indices, level: Indices, stretch: Indices) -> Indices:
    """Return the number of each pair's group of neighbours at one speed, shape (pairs,).

    Parameters
    ----------
    run, level, stretch : ndarray of int, shape (pairs,)
        Run, speed level and stretch of each pair.
    """
    group = numbered(run, level, stretch)
    order = np.argsort(group, kind="stable")
    count = np.bincount(group)
    place = np.empty_like(group)
    place[order] = np.arange(len(group)) - np.repeat(np.cumsum(count) - count, count)
    return numbered(group, place // _POOLED)


def jumps_of(
    deviations: Array, row_pair: Indices, run: Indices, level: Indices, position: Array
) -> Flags:
    """Return the pairs whose course over the angle is suddenly another, shape (pairs,).

    They differ from the pair before that crosses the same bins in the same run at one speed far
    more than others at this speed do.

    Parameters
    ----------
    deviations : ndarray, shape (rows, channels)
        Deviations of the bins from the means of their pairs. [N·m]
    row_pair : ndarray of int, shape (rows,)
        Pair of each row.
    run, level : ndarray of int, shape (pairs,)
        Run and speed level of each pair.
    position : ndarray, shape (rows,)
        Centre of each row's angle bin. [deg]
    """
    steps: dict[int, list[Array]] = {}
    later: dict[int, list[Indices]] = {}
    for chosen in same_bins(row_pair, numbered(run, level), position):
        pairs = row_pair[chosen[:, 0]]
        squares = np.mean(np.square(np.diff(deviations[chosen], axis=0)), axis=1)
        steps.setdefault(int(level[pairs[0]]), []).append(squares)
        later.setdefault(int(level[pairs[0]]), []).append(pairs[1:])
    jumps = np.zeros(len(run), bool)
    for number, found in steps.items():
        squares = np.concatenate(found)
        usual = np.median(squares, axis=0)
        far = np.any((squares > _JUMP * usual) & (usual > 0), axis=1)
        jumps[np.concatenate(later[number])[far]] = True
    return jumps


def stretches_of(jumps: Flags, run: Indices, level: Indices) -> Indices:
    """Return the number of the stretch between two jumps of each pair, shape (pairs,).

    Parameters
    ----------
    jumps : ndarray of bool, shape (pairs,)
        Pairs with which a stretch begins.
    run, level : ndarray of int, shape (pairs,)
        Run and speed level of each pair.
    """
    numbers = pd.Series(jumps.astype(np.intp)).groupby(numbered(run, level)).cumsum()
    return np.asarray(numbers)


def same_bins(row_pair: Indices, group: Indices, position: Array) -> tuple[Indices, ...]:
    """Return the rows of the pairs of each group that cross the same bins, shape (pairs, bins).

    Parameters
    ----------
    row_pair : ndarray of int, shape (rows,)
        Pair of each row.
    group : ndarray of int, shape (pairs,)
        Group of each pair.
    position : ndarray, shape (rows,)
        Centre of each row's angle bin. [deg]
    """
    starts = np.flatnonzero(np.diff(row_pair, prepend=-1))
    ends = np.append(starts[1:], len(row_pair))
    alike: dict[tuple[int, bytes], list[Indices]] = {}
    for pair, (start, end) in enumerate(zip(starts, ends, strict=True)):
        key = (int(group[pair]), position[start:end].tobytes())
        alike.setdefault(key, []).append(np.arange(start, end))
    return tuple(np.array(rows) for rows in alike.values() if len(rows) > 1 and len(rows[0]) > 2)


def numbered(*keys: Indices) -> Indices:
    """Return the number of each pair's combination of keys, in their order, shape (pairs,).

    Parameters
    ----------
    *keys : ndarray of int, shape (pairs,)
        Keys of each pair, as its run and its speed level.
    """
    return np.unique(np.column_stack(keys), axis=0, return_inverse=True)[1].ravel()
