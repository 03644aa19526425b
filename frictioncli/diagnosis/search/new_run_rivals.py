"""Rivals of a cause on the run that was held out: which of them it contradicts.

What explains the runs seen as well as a cause may predict another course on a new run: surfaces
stay run in, and friction after a rest is back on the next morning.
"""

from collections.abc import Sequence
from dataclasses import replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import WORSE, missed_of_new_run
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG


def without_refuted_rivals(
    causes: Sequence[Cause], found: SearchResult, new: Problem
) -> tuple[Cause, ...]:
    """Return causes whose sets lack the effects that predict a new run clearly worse.

    Changes have their history on the new run, and a lag of the gear has its own temperature: they
    stay, as do effects of the measurement.

    Parameters
    ----------
    causes : sequence of Cause
        Causes, judged on the new run.
    found : SearchResult
        The search that found them.
    new : Problem
        Rows of the new run.
    """
    return tuple(_judged(one, causes, found, new) for one in causes)


def _judged(cause: Cause, causes: Sequence[Cause], found: SearchResult, new: Problem) -> Cause:
    """Return a cause without the rivals that the new run refutes."""
    own = cause.fit.effect
    rivals = [BY_NAME[name] for name in cause.effects if name != own.name]
    rivals = [one for one in rivals if _predicts(one)]
    if cause.standing != "named" or not cause.holds_on_new_run or not _predicts(own) or not rivals:
        return cause
    others = [one.fit for one in causes if one.standing == "named" and one is not cause]
    step = found.step
    rows, weighted_fit = (step.problem, new), step.predicting_fit()
    with_own = missed_of_new_run([*others, cause.fit], rows, weighted_fit)
    refuted = {
        one.name
        for one, fit in zip(rivals, _fitted(rivals, others, found), strict=True)
        if missed_of_new_run([*others, fit], rows, weighted_fit) > WORSE * with_own
    }
    if not refuted:
        return cause
    kept = {name: share for name, share in cause.probabilities.items() if name not in refuted}
    whole = sum(kept.values())
    return replace(
        cause,
        effects=tuple(name for name in cause.effects if name not in refuted),
        probabilities={name: share / whole for name, share in kept.items()},
    )


def _predicts(effect: Effect) -> bool:
    """Return whether an effect says by itself what it adds on a new run."""
    return not effect.measurement and effect.moments is None and effect is not THERMAL_LAG


def _fitted(
    rivals: Sequence[Effect], others: Sequence[EffectFit], found: SearchResult
) -> list[EffectFit]:
    """Return each rival, fitted to the runs seen beside the other causes."""
    beside = [one for one in others if not one.effect.measurement]
    step = Step.of(found.step.precomputed, beside)
    wanted = {one.name for one in rivals}
    skipped = {one.name for one in found.catalogue.hypotheses} - wanted
    tests = step.tested(found.catalogue, skipped)
    return [step.refined(tests[one.name].effect_fit(one)) for one in rivals]
