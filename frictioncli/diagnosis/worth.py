"""Which of the causes found are worth modelling."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.extension import extend, misfits, reduction_interval
from frictioncli.diagnosis.problem import Problem
from frictioncli.diagnosis.search import Cause, Found
from frictioncli.diagnosis.weighing import Weighing

Array = NDArray[np.float64]

WORTHWHILE = 0.03
"""A cause that takes away less of the misfit than this share is seen, but not worth modelling."""

BEYOND_DOUBT = 1e-6
"""Unless it is less likely by chance than this, and a new run does not speak against it."""

SLIGHT = 0.001
"""A cause of which the base leaves less than this share of the friction never is."""


def worthwhile(
    found: Found, judged: Problem, seed: int
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
    judged : Problem
        Rows on which a cause must prove itself, of a new run where there is one.
    seed : int
        Seed of the drawn blocks.
    """
    slight = SLIGHT * float(np.mean(np.abs(judged.friction)))
    kept = [cause for cause in found.causes if cause.visible >= slight]
    dropped = [cause for cause in found.causes if cause.visible < slight]
    weighing = found.step.weighing()
    while kept:
        whole = _squares(found, weighing, kept, judged)
        worth = []
        for i, cause in enumerate(kept):
            channel = cause.score.effect.channel
            without = _squares(found, weighing, kept[:i] + kept[i + 1 :], judged)[channel]
            gain = 1 - float(np.sqrt(np.mean(whole[channel]) / np.mean(without)))
            _, high = reduction_interval(judged, without, whole[channel], seed)
            sure = cause.judged.p_value < BEYOND_DOUBT and high > 0
            worth.append((gain >= WORTHWHILE or sure, gain))
        least = min(range(len(kept)), key=lambda i: worth[i])
        if worth[least][0]:
            break
        dropped.append(kept.pop(least))
    return tuple(kept), tuple(dropped)


def _squares(
    found: Found, weighing: Weighing, causes: Sequence[Cause], judged: Problem
) -> dict[str, Array]:
    """Return the squared misfit per channel that the base with these causes leaves."""
    extension = extend(found.step.problem, weighing, [cause.score for cause in causes])
    friction, load = misfits(judged, extension)
    return {"friction": np.square(friction), "load": np.square(load)}
