"""Which of the causes found are worth modelling."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import misfits, reduction_interval, refit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause_search import Cause, Found

_Squares = dict[str, Array]

WORTHWHILE = 0.03
"""A cause that takes away less of the misfit than this share is seen, but not worth modelling."""

BEYOND_DOUBT = 1e-6
"""Unless it is less likely by chance than this, and a new run does not speak against it."""

SLIGHT = 0.001
"""A cause of which the base leaves less than this share of the friction never is."""


def worthwhile(
    found: Found, weighing: WeightedFit, judged: Problem, seed: int
) -> tuple[tuple[Cause, ...], tuple[Cause, ...]]:
    """Return the causes that are worth modelling, and those that are only visible.

    The cause whose loss costs least is dropped, and the others refitted, until each is worth it:
    it takes away at least 3 % of the misfit that its channel has without it; or it is smaller
    beside the noise, which no model can predict, but beyond doubt, and the judged rows do not speak
    against it: the interval of its gain there reaches above zero. A cause of which the base leaves
    less than 0.1 % of the friction is never worth it.

    Parameters
    ----------
    found : Found
        Result of the search.
    weighing : WeightedFit
        Weights of both channels.
    judged : Problem
        Rows on which a cause must prove itself, of a new run where there is one.
    seed : int
        Seed of the drawn blocks.
    """
    slight = SLIGHT * float(np.mean(np.abs(judged.friction)))
    kept = [cause for cause in found.causes if cause.visible >= slight]
    dropped = [cause for cause in found.causes if cause.visible < slight]
    whole = _squares(found, weighing, kept, judged)
    while kept:
        fewer = [kept[:i] + kept[i + 1 :] for i in range(len(kept))]
        without = [_squares(found, weighing, causes, judged) for causes in fewer]
        worth = [
            _worth(cause, judged, less, whole, seed)
            for cause, less in zip(kept, without, strict=True)
        ]
        least = worth.index(min(worth))
        if worth[least][0]:
            break
        dropped.append(kept[least])
        kept, whole = fewer[least], without[least]
    return tuple(kept), tuple(dropped)


def _worth(
    cause: Cause, judged: Problem, without: _Squares, whole: _Squares, seed: int
) -> tuple[bool, float]:
    """Return whether a cause is worth modelling, and the share of the misfit that it takes away."""
    before, after = (one[cause.score.effect.channel] for one in (without, whole))
    gain = 1 - float(np.sqrt(np.mean(after) / np.mean(before)))
    _, high = reduction_interval(judged, before, after, seed)
    sure = cause.judged.p_value < BEYOND_DOUBT and high > 0
    return gain >= WORTHWHILE or sure, gain


def _squares(
    found: Found, weighing: WeightedFit, causes: Sequence[Cause], judged: Problem
) -> _Squares:
    """Return the squared misfit per channel that the base with these causes leaves."""
    fitted = refit(found.step.problem, weighing, [cause.score for cause in causes])
    friction, load = misfits(judged, fitted)
    return {"friction": np.square(friction), "load": np.square(load)}
