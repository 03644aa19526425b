"""Backward elimination: which of the causes found improve the prediction of hold-out rows."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import misfits, reduction_interval, refit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause_search import Cause, SearchResult

_Squares = dict[str, Array]

LEAST_REDUCTION = 0.03
"""A cause that reduces the misfit by less than this share is visible, but not modelled."""

BEYOND_DOUBT = 1e-6
"""Unless its p-value is below this, and the hold-out rows do not contradict it."""

LEAST_VISIBLE = 0.001
"""A cause of which the base leaves less than this share of the friction is never modelled."""


def select_causes(
    found: SearchResult, weighted_fit: WeightedFit, hold_out: Problem, seed: int
) -> tuple[tuple[Cause, ...], tuple[Cause, ...]]:
    """Return the causes that are modelled, and those that are only visible in the data.

    The cause with the least reduction is dropped, and the others refitted, until each remaining
    one either reduces the misfit of its channel by at least 3 %; or is smaller beside the noise,
    which no model can predict, but beyond doubt (p < 1e-6), and the 95 % interval of its reduction
    on the hold-out rows reaches above zero. A cause of which the base leaves less than 0.1 % of the
    friction is always dropped.

    Parameters
    ----------
    found : SearchResult
        Result of the search.
    weighted_fit : WeightedFit
        Weights of both channels.
    hold_out : Problem
        Rows on which a cause must prove itself, of a new run where there is one.
    seed : int
        Seed of the block bootstrap.
    """
    least = LEAST_VISIBLE * float(np.mean(np.abs(hold_out.friction)))
    kept = [cause for cause in found.causes if cause.visible >= least]
    dropped = [cause for cause in found.causes if cause.visible < least]
    with_all = _squares(found, weighted_fit, kept, hold_out)
    while kept:
        fewer = [kept[:i] + kept[i + 1 :] for i in range(len(kept))]
        without = [_squares(found, weighted_fit, causes, hold_out) for causes in fewer]
        reductions = [
            _reduction(cause, hold_out, one, with_all, seed)
            for cause, one in zip(kept, without, strict=True)
        ]
        weakest = reductions.index(min(reductions))
        if reductions[weakest][0]:
            break
        dropped.append(kept[weakest])
        kept, with_all = fewer[weakest], without[weakest]
    return tuple(kept), tuple(dropped)


def _reduction(
    cause: Cause, hold_out: Problem, without: _Squares, with_all: _Squares, seed: int
) -> tuple[bool, float]:
    """Return whether a cause is modelled, and by how much it reduces the RMS misfit."""
    before, after = (one[cause.fit.effect.channel] for one in (without, with_all))
    reduction = 1 - float(np.sqrt(np.mean(after) / np.mean(before)))
    _, high = reduction_interval(hold_out, before, after, seed)
    certain = cause.test.p_value < BEYOND_DOUBT and high > 0
    return reduction >= LEAST_REDUCTION or certain, reduction


def _squares(
    found: SearchResult, weighted_fit: WeightedFit, causes: Sequence[Cause], hold_out: Problem
) -> _Squares:
    """Return the squared misfit per channel that the base with these causes leaves. [(N·m)²]."""
    fitted = refit(found.step.problem, weighted_fit, [cause.fit for cause in causes])
    friction, load = misfits(hold_out, fitted)
    return {"friction": np.square(friction), "load": np.square(load)}
