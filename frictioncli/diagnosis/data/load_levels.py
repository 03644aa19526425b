"""A load that is carried in some of the pairs, in any order: told by two levels of the load torque.

What is picked up and put down between recordings leaves pairs of two kinds. Of each pair the misfit
of the load torque has a part that goes with the cosine of the angle and one that goes with its
sine; in the direction in which pairs differ most these are two groups, far apart. What changes
gradually, with the temperature or with time, has all values between.
"""

import numpy as np

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.history import Shape, Stretch, history
from frictioncli.effects.pair_series import measured_share

_APART = 6.0
"""Distance of two groups from which they are two, in standard deviations within the wider one.
Halves of an even distribution are 3.5 apart, those of a sine 4.1."""

_FEWEST = 3
"""Pairs in the smaller group."""


def two_level_history(problem: Problem) -> Shape | None:
    """Return when the pairs of a problem carry another load, several times; None if they do not.

    Parameters
    ----------
    problem : Problem
        The joint's rows.

    Returns
    -------
    dict of str to float or None
        History of the load that the first pair does not have.
    """
    share = measured_share(problem.all_runs)[problem.rows]
    known, pair = np.unique(share, return_inverse=True)
    if len(known) < 2 * _FEWEST:
        return None
    there = _of_two_groups(_along_greatest(problem, pair, len(known)))
    if there is None:
        return None
    edges = np.append(known, _after(problem, known[-1]))
    parts = _stretches(there != there[0], edges)
    return history(parts) if len(parts) > 1 else None


def _along_greatest(problem: Problem, pair: Indices, count: int) -> Array:
    """Return how much load each pair has in the direction in which they differ most [N·m]."""
    angle = np.radians(problem.table.angle)
    rows = np.bincount(pair, minlength=count)
    parts = np.column_stack(
        [
            np.bincount(pair, weights=problem.load_misfit * wave, minlength=count) / rows
            for wave in (np.cos(angle), np.sin(angle))
        ]
    )
    parts = parts - parts.mean(axis=0)
    direction = np.linalg.svd(parts, full_matrices=False)[2][0]
    return np.asarray(parts @ direction)


def _of_two_groups(values: Array) -> Flags | None:
    """Return which values are in the upper of two groups; None where there are not two.

    The threshold leaves the least variance within the groups.
    """
    order = np.sort(values)
    size = np.arange(_FEWEST, len(order) - _FEWEST + 1)
    sums, whole = np.cumsum(order), float(order.sum())
    low = sums[size - 1] / size
    high = (whole - sums[size - 1]) / (len(order) - size)
    between = size * (len(order) - size) * np.square(high - low)
    best = int(np.argmax(between))
    upper = values >= order[size[best]]
    within = max(float(np.std(values[upper])), float(np.std(values[~upper])))
    return np.asarray(upper) if high[best] - low[best] >= _APART * within else None


def _stretches(there: Flags, edges: Array) -> list[Stretch]:
    """Return the stretches of some pairs, each up to the pair that follows it."""
    changes = np.flatnonzero(np.diff(np.concatenate([[False], there, [False]]).astype(int)))
    begins, ends = edges[changes[::2]], edges[changes[1::2]]
    return list(zip(begins.tolist(), ends.tolist(), strict=True))


def _after(problem: Problem, last: float) -> float:
    """Return the share of the pairs measured before the first that follows the last one."""
    share = measured_share(problem.all_runs)
    return float(np.min(share[share > last], initial=1.0))
