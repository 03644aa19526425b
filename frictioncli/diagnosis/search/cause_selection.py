"""Which of the causes found extend the model: those named that the hold-out rows do not contradict.

A cause is judged on rows that the fit has not seen: does the prediction become better by it? A
cause of which a new run shows nothing did not last; it is said so, and not extrapolated.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import misfits, reduction_interval, refit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause import Cause

_Squares = dict[str, Array]


def judged_on_new_run(
    causes: Sequence[Cause], problem: Problem, weighted_fit: WeightedFit, new: Problem, seed: int
) -> tuple[Cause, ...]:
    """Return causes with whether they hold on a new run, and their standing after it.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    problem : Problem
        The rows to which they were fitted.
    weighted_fit : WeightedFit
        Weights of both channels.
    new : Problem
        Rows of a run that was held out.
    seed : int
        Seed of the block bootstrap.
    """
    found = []
    with_all = _squares(problem, weighted_fit, causes, new)
    for cause in causes:
        fewer = [other for other in causes if other is not cause]
        without = _squares(problem, weighted_fit, fewer, new)
        channel = cause.fit.effect.channel
        low, high = reduction_interval(new, without[channel], with_all[channel], seed)
        holds = True if low > 0 else False if high < 0 else None
        judged = replace(cause, holds_on_new_run=holds)
        if holds is False and cause.fit.effect.moments is None:
            reason = "the run that was held out is predicted worse with it"
            judged = replace(judged, standing="visible", reason=reason)
        found.append(judged)
    return tuple(found)


def _squares(
    problem: Problem, weighted_fit: WeightedFit, causes: Sequence[Cause], new: Problem
) -> _Squares:
    """Return the squared misfit per channel that the base with these causes leaves. [(N·m)²]."""
    fitted = refit(problem, weighted_fit, [cause.fit for cause in causes])
    friction, load = misfits(new, fitted)
    return {"friction": np.square(friction), "load": np.square(load)}
