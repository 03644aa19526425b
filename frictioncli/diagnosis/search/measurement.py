"""Effects of the measurement that stand beside the base: which are possible, and their tests."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import stats

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import beside_unfitted
from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.noise.significance import NullDistribution
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import sizes_of
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.standing import beyond_bounds
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import Effect, applicable

CLEAR = 0.01
"""Greatest p-value of an effect of the measurement that is listed and corrected without a name."""


def beside_base(
    problem: Problem, discrepancy: float = SHARE
) -> tuple[Precomputed, tuple[Effect, ...]]:
    """Return what is computed once, with the effects of the measurement that stand beside the base.

    They are those whose coefficients are physically possible. One that is not explains something
    else, as a payload that goes with speed, and would hide it.

    Parameters
    ----------
    problem : Problem
        One joint's measurements and base model.
    discrepancy : float, optional
        RMS of the discrepancy that is expected, relative to the mean friction; 0 for none.
    """
    beside = applicable(MEASUREMENT_EFFECTS, problem.table)
    while True:
        precomputed = Precomputed.of(problem, beside, discrepancy)
        causes = measurement_causes(Step.of(precomputed, []), beside)
        possible = tuple(
            cause.fit.effect for cause in causes if not beyond_bounds(cause.fit, problem)
        )
        if len(possible) == len(beside):
            return precomputed, beside
        beside = possible


def measurement_causes(step: Step, effects: Sequence[Effect]) -> tuple[Cause, ...]:
    """Return the effects of the measurement beside the base as causes, with their tests."""
    fit, first = step.fit, step.components.base - sum(len(one.coefficients) for one in effects)
    found = []
    for effect in effects:
        place = slice(first, first + len(effect.coefficients))
        first = place.stop
        coefficients, covariance = fit.coefficients[place], fit.covariance[place, place]
        statistic = float(coefficients @ np.linalg.pinv(covariance, hermitian=True) @ coefficients)
        own = EffectFit(effect, {}, coefficients, covariance, statistic)
        null = NullDistribution(coefficients=len(coefficients), freedom=step.components.pairs)
        test = HypothesisTest(
            name=effect.name,
            shape={},
            coefficients=coefficients,
            covariance=covariance,
            statistic=statistic,
            p_value=min(1.0, len(effects) * float(stats.chi2.sf(statistic, len(coefficients)))),
            log_bayes_factor=statistic / 2,
            freedom=len(coefficients),
            null=null,
            size_scale=0.0,
        )
        found.append(
            Cause(
                fit=own,
                test=test,
                effects=(effect.name,),
                probabilities={effect.name: 1.0},
                **sizes_of(step.precomputed, own),
            )
        )
    return tuple(found)


def corrected_without_name(
    judged: Sequence[Cause], causes: Sequence[Cause], problem: Problem
) -> tuple[Cause, ...]:
    """Return effects of the measurement that are corrected though they are not named.

    They may be smaller than what is worth naming, and a prediction without them is worse. Without
    causes there is no extended model that could correct them.

    Parameters
    ----------
    judged : sequence of Cause
        All that was found, with its standing.
    causes : sequence of Cause
        Those that extend the model.
    problem : Problem
        The joint's rows.
    """
    if not causes:
        return ()
    named = {cause.fit.effect.name for cause in causes}
    return tuple(
        replace(one, reason=f"{one.reason}; corrected all the same")
        for one in judged
        if one.fit.effect.measurement
        and one.test.p_value < CLEAR
        and one.fit.effect.name not in named
        and not beyond_bounds(one.fit, problem)
    )


def beside_the_rest(
    problem: Problem,
    weighted_fit: WeightedFit,
    measurement: Sequence[Cause],
    fitted: Sequence[EffectFit],
) -> WeightedFit:
    """Return a weighted fit that allows for effects of the measurement that are not fitted.

    Parameters
    ----------
    problem : Problem
        The rows.
    weighted_fit : WeightedFit
        Weights of both channels.
    measurement : sequence of Cause
        All effects of the measurement beside the base.
    fitted : sequence of EffectFit
        The effects that extend the model.
    """
    names = {one.effect.name for one in fitted}
    rest = [cause.fit for cause in measurement if cause.fit.effect.name not in names]
    return beside_unfitted(problem, weighted_fit, rest)
