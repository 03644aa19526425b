"""Rivals of a cause on the run that was held out: which of them it contradicts.

What explains the runs seen as well as a cause may predict another course on a new run: surfaces
stay run in, and friction after a rest is back on the next morning.
"""

from collections.abc import Sequence
from dataclasses import replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import (
    WORSE,
    missed_of_new_run,
    predicts_new_run,
)
from frictioncli.diagnosis.search.guessed_travel import variants
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect
from frictioncli.wording import in_words

_OF_TIME = frozenset({"clock", "order", "travel"})
"""Columns of a table that tell what went before."""


def without_refuted_rivals(
    causes: Sequence[Cause], found: SearchResult, new: Problem
) -> tuple[Cause, ...]:
    """Return causes whose sets lack the effects that predict a new run clearly worse.

    Effects that do not say by themselves what they add there stay; see :func:`predicts_new_run`.

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


def refuted_by_return(
    causes: Sequence[Cause], found: SearchResult, new: Problem
) -> tuple[Cause, ...]:
    """Return causes of which a new run shows that they are back, no longer named.

    Each runs in parallel with an effect that comes back by itself, as running-in with friction
    after a rest: that one then predicts the new run clearly better. An effect of speed, load,
    temperature or angle is back there as well, and the runs seen tell it from others as surely.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named, judged on the new run.
    found : SearchResult
        The search that found them.
    new : Problem
        Rows of the new run.
    """
    weighted_fit = found.step.predicting_fit()
    tried = {one.name for one in found.catalogue.hypotheses}
    refuted = []
    for cause in causes:
        own = cause.fit.effect
        others = [one.fit for one in causes if one is not cause]
        known = {*cause.effects, *(one.effect.name for one in others)}
        rivals = [BY_NAME[name] for name in own.confounders if name in tried - known]
        rivals = [one for one in rivals if one.recurs]
        lasting = not _OF_TIME.isdisjoint(own.needs)
        if not (rivals and lasting and predicts_new_run(own)) or cause.holds_on_new_run is False:
            continue

        def missed(fit: EffectFit, others: Sequence[EffectFit] = others) -> float:
            return missed_of_new_run([*others, fit], found.step.problem, new, weighted_fit)

        least = missed(cause.fit) / WORSE
        back = [fit for fit in _fitted(rivals, others, found) if missed(fit) < least]
        if back:
            reason = f"{in_words(back[0].effect.name)} predicts the held-out run better"
            refuted.append(replace(cause, standing="visible", reason=reason))
    return tuple(refuted)


def _judged(cause: Cause, causes: Sequence[Cause], found: SearchResult, new: Problem) -> Cause:
    """Return a cause without the rivals that the new run refutes."""
    own = cause.fit.effect
    rivals = [BY_NAME[name] for name in cause.effects if name != own.name]
    rivals = [one for one in rivals if predicts_new_run(one)]
    holds = cause.standing == "named" and cause.holds_on_new_run
    if not holds or not predicts_new_run(own) or not rivals:
        return cause
    others = [one.fit for one in causes if one.standing == "named" and one is not cause]
    weighted_fit = found.step.predicting_fit()

    def missed(fit: EffectFit) -> float:
        return missed_of_new_run([*others, fit], found.step.problem, new, weighted_fit)

    most = WORSE * missed(cause.fit)
    fits = _fitted(rivals, others, found)
    refuted = {one.name for one in rivals} - {
        fit.effect.name for fit in fits if missed(fit) <= most
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


def _fitted(
    rivals: Sequence[Effect], others: Sequence[EffectFit], found: SearchResult
) -> list[EffectFit]:
    """Return each variant of each rival, fitted to the runs seen beside the other causes."""
    beside = [one for one in others if not one.effect.measurement]
    step = Step.of(found.step.precomputed, beside)
    wanted = {one.name for one in rivals}
    skipped = {one.name for one in found.catalogue.hypotheses} - wanted
    tests = step.tested(found.catalogue, skipped)
    table = step.problem.all_runs
    return [
        step.refined(tests[one.name].effect_fit(variant))
        for one in rivals
        for variant in variants(one, table)
    ]
