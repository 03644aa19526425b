"""The part of the load channel's constant that does not load the gear, where friction tells it.

The load channel has a constant besides the load: of the torque sensor, or of friction that differs
between directions. Friction that goes with the amount of the load is the same at two angles where
the load itself is, not the load with that constant: left in, it takes away the symmetry by which
load and angle are told apart.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from frictioncli.diagnosis.data.problem import Problem

_GREATEST = 0.1
"""Greatest such constant, relative to the mean friction and to the greatest load."""

_TRIED = 5
"""Constants that are tried, before the best is refined."""

_STEPS = 8
"""Greatest number of steps of that."""

_PRECISION = 0.05
"""Precision of the best, relative to the distance of those tried first."""


def most_likely_constant(problem: Problem, statistic: Callable[[float], float]) -> float:
    """Return the constant of the load channel at which friction by load explains most [N·m].

    Parameters
    ----------
    problem : Problem
        The rows.
    statistic : callable
        What friction explains that goes with the amount of the load less a constant.
    """
    load = float(np.max(np.abs(problem.table.load)))
    most = _GREATEST * min(float(np.mean(np.abs(problem.friction))), load)
    tried, reach = np.linspace(-most, most, _TRIED, retstep=True)
    best = max(tried.tolist(), key=statistic)
    near = minimize_scalar(
        lambda constant: -statistic(float(constant)),
        bounds=(best - reach, best + reach),
        method="bounded",
        options={"maxiter": _STEPS, "xatol": _PRECISION * float(reach)},
    )
    return float(near.x)
