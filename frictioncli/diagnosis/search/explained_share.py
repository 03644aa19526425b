"""How much of what the base misses on a new run the named causes explain."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK
from frictioncli.diagnosis.fit.extension import misfits, refit
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import predicts_new_run
from frictioncli.diagnosis.search.judging import Judging
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG
from frictioncli.linear_algebra import least_squares_residual

_LEAST = 0.45
"""Least share of the mean square that the base misses beside noise which right causes explain."""

_LITTLE = (
    "on the held-out run the named causes explain only {share:.0f} % of the mean square that the"
    " base model misses beside noise; it may be a part of something else"
)


def explains_little(causes: Sequence[Cause], step: Step, judging: Judging, floor: float) -> str:
    """Return why properties of the joint may be a part of something else; empty if not.

    What no catalogue lists looks a little like one of its entries, or like two together. These then
    explain a part of it only, and most remains on a new run, without structure that would tell.
    Coulomb and viscous friction differ a little from day to day; beside that a cause may explain
    more, and the greater share counts. A change has its history there and explains it always.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    step : Step
        Base and these causes.
    judging : Judging
        Rows and demands.
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    """
    measured, measured_new = judging.measured
    predicting = [one for one in causes if _predicts(one)]
    if measured_new is None or judging.new is None or not predicting:
        return ""
    if any(one.fit.effect.moments is not None for one in causes):
        return ""
    weighted_fit = step.predicting_fit()
    of_log = [one.fit for one in causes if one.fit.effect.measurement]
    before = _missed(measured, measured_new, weighted_fit, of_log)
    after = _missed(judging.problem, judging.new, weighted_fit, [one.fit for one in causes])
    left = np.square(after) - floor**2
    beside_noise = np.square(before) - floor**2
    if left[0] <= judging.margin**2 or np.any(beside_noise <= 0.0):
        return ""
    share = float(np.max(1.0 - left / beside_noise))
    return _LITTLE.format(share=100 * max(share, 0.0)) if share < _LEAST else ""


def _predicts(cause: Cause) -> bool:
    """Return whether a cause is a property of the joint that the new run should have."""
    effect = cause.fit.effect
    holds = cause.holds_on_new_run is not False
    return holds and (predicts_new_run(effect) or effect.name == THERMAL_LAG.name)


def _missed(
    problem: Problem, new: Problem, weighted_fit: WeightedFit, fits: Sequence[EffectFit]
) -> Array:
    """Return the RMS misfit of a new run, and that beside what days differ by, shape (2,) [N·m]."""
    friction, load = misfits(new, refit(problem, weighted_fit, fits))
    constant = np.ones((len(load), 1))
    viscous = new.table.viscous * np.sqrt(new.table.speed)
    beside = (
        least_squares_residual(np.column_stack([constant, viscous]), friction, tolerance=RANK),
        least_squares_residual(constant, load, tolerance=RANK),
    )
    squares = new.squared(friction, load), new.squared(*beside)
    return np.sqrt(np.mean(squares, axis=1))
