"""Changes that the base model absorbs on the runs seen, but not on a run that was held out.

The base model, refitted, absorbs a part of a lasting change on the runs that it is fitted to. On a
later run the change is there throughout and the base is what it was: more of it is left. A change
that is too small for a name by the runs seen alone has one if the held-out run shows that it went
on as they predict, and if what it leaves there is above the margin.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import misfits, refit
from frictioncli.diagnosis.fit.hypotheses import EffectFit, free_coefficients
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.new_run import new_run_test
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.history import stretches


def with_size_on_new_run(
    causes: Sequence[Cause],
    certain: Collection[str],
    step: Step,
    new: Problem | None,
    margin: float,
) -> tuple[Cause, ...]:
    """Return causes; lasting changes that leave more than the margin on a new run are named.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    certain : collection of str
        Names of those that only their size may keep from a name.
    step : Step
        The last step of the search: the rows seen, and their noise.
    new : Problem or None
        Rows of a run that was held out.
    margin : float
        Smallest size worth a name. [N·m]
    """
    if new is None:
        return tuple(causes)
    named = [one for one in causes if one.standing == "named"]
    return tuple(
        replace(cause, standing="named", reason="")
        if cause.standing in ("visible", "negligible")
        and cause.fit.effect.name in certain
        and _lasts(cause.fit)
        and _least_size(cause, [one.fit for one in named], step, new)
        > channel_margin(step.problem, cause.fit.effect.channel, margin)
        else cause
        for cause in causes
    )


def _lasts(fit: EffectFit) -> bool:
    """Return whether an effect is a change that is there at the end of the measurements."""
    return fit.effect.moments is not None and stretches(fit.shape)[-1][1] == 1.0


def _least_size(cause: Cause, others: Sequence[EffectFit], step: Step, new: Problem) -> float:
    """Return the lower bound of what the base leaves of a change on a new run, by its RMS [N·m].

    By the runs seen and by the new one; 0 if the new one does not show it.
    """
    fit, problem = cause.fit, step.problem
    found = new_run_test(fit, problem, new, step.weighted_fit(), step.noise(), others)
    if not found.holds:
        return 0.0
    there = replace(fit, shape=found.shape)
    weighted_fit = step.predicting_fit()
    channels = zip(
        misfits(new, refit(problem, weighted_fit, others)),
        misfits(new, refit(problem, weighted_fit, [*others, there])),
        strict=True,
    )
    friction, load = (np.sqrt(np.mean(np.square(without - own))) for without, own in channels)
    left = friction if fit.effect.channel == "friction" else load
    free = free_coefficients(fit)
    size, covariance = fit.coefficients[free], fit.covariance[np.ix_(free, free)]
    relative = 1.0 / np.sqrt(size @ np.linalg.solve(covariance, size))
    return float(left * min(found.amplitude - Z95 * found.error, 1.0 - Z95 * relative))
