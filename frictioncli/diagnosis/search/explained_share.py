"""How much of what the base misses on a new run the named causes explain."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK
from frictioncli.diagnosis.fit.extension import misfits, refit
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import predicts_new_run
from frictioncli.diagnosis.search.judging import Judging
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.thermal.refine import LAG, RefinedLag, settled
from frictioncli.linear_algebra import least_squares_residual

_LEAST = 0.4
"""Least share of the mean square that the base misses beside noise which right causes explain."""

_LITTLE = (
    "on the held-out run the named causes explain only {share:.0f} % of the mean square that the"
    " base model misses beside noise; it may be a part of something else"
)


def explains_little(
    causes: Sequence[Cause],
    step: Step,
    judging: Judging,
    floor: float,
    lag: RefinedLag | None = None,
) -> str:
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
    lag : RefinedLag, optional
        The lag of the gear, where it is one of the causes.
    """
    _, base = judging.measured
    if base is None or judging.new is None or not any(_predicts(one) for one in causes):
        return ""
    if any(one.fit.effect.moments is not None for one in causes):
        return ""
    before = _rms(base, base.friction_misfit, base.load_misfit)
    after = _rms(judging.new, *_missed([one.fit for one in causes], step, judging, lag))
    left = np.square(after) - floor**2
    beside_noise = np.square(before) - floor**2
    if left[0] <= judging.margin**2 or np.any(beside_noise <= 0.0):
        return ""
    share = float(np.max(1.0 - left / beside_noise))
    return _LITTLE.format(share=100 * max(share, 0.0)) if share < _LEAST else ""


def _missed(
    fits: Sequence[EffectFit], step: Step, judging: Judging, lag: RefinedLag | None
) -> tuple[Array, Array]:
    """Return the misfit of the new run with some effects, shape (rows,) each [N·m]."""
    weighted_fit = step.predicting_fit()
    if lag is not None and LAG in {one.effect.name for one in fits}:
        about, extension = settled(lag, fits, weighted_fit)
        assert about.new is not None  # there is one wherever a run was held out
        return misfits(about.new, extension)
    assert judging.new is not None
    return misfits(judging.new, refit(judging.problem, weighted_fit, fits))


def _rms(new: Problem, friction: Array, load: Array) -> Array:
    """Return the RMS of a misfit, and that beside what days differ by, shape (2,) [N·m]."""
    constant = np.ones((len(load), 1))
    viscous = new.table.viscous * np.sqrt(new.table.speed)
    beside = (
        least_squares_residual(np.column_stack([constant, viscous]), friction, tolerance=RANK),
        least_squares_residual(constant, load, tolerance=RANK),
    )
    squares = new.squared(friction, load), new.squared(*beside)
    return np.sqrt(np.mean(squares, axis=1))


def _predicts(cause: Cause) -> bool:
    """Return whether a cause is a property of the joint that the new run should have."""
    effect = cause.fit.effect
    holds = cause.holds_on_new_run is not False
    return holds and (predicts_new_run(effect) or effect.name == LAG)
