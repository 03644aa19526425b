"""The search for causes: test every effect, accept the best, refit, test again.

At each step both channels' noise is estimated with the base and the effects accepted so far, data
and candidates are whitened by it, and every other effect is scored. The search ends when no score
stands out of what noise gives in as many tries. At the end each accepted effect is set against all
others once more, with its companions in place: what could take its part joins its credible set.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.candidates import Score, score
from frictioncli.diagnosis.problem import Problem
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.diagnosis.significance import credible_set, probabilities
from frictioncli.diagnosis.step import Candidate, Step, physical
from frictioncli.effects.availability import judgeable
from frictioncli.effects.base import Effect

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A cause found: the effect accepted, and what else could take its part."""

    candidate: Candidate
    effects: tuple[str, ...]
    probabilities: dict[str, float]
    size: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What a search found.

    Attributes
    ----------
    causes : tuple of Cause
        Strongest first.
    last : dict of str to Candidate
        All effects at the last step: what silence means.
    step : Step
        The last step: noise, whiteners and what base and causes leave of the misfit.
    """

    causes: tuple[Cause, ...]
    last: dict[str, Candidate]
    step: Step


def find_causes(problem: Problem, effects: Sequence[Effect], settings: DiagnosisSettings) -> Found:
    """Search the catalogue for the causes of a problem's misfit.

    Parameters
    ----------
    problem : Problem
        One joint's measurements and base model.
    effects : sequence of Effect
        The catalogue.
    settings : DiagnosisSettings
        How sure a finding must be.
    """
    able = judgeable(effects, problem.table)
    accepted: list[Score] = []
    p_values: list[Candidate] = []
    while True:
        step = Step.of(problem, accepted)
        rivals = [effect for effect in able if effect.name not in {s.effect.name for s in accepted}]
        found = {effect.name: step.judged(effect, len(able), settings.seed) for effect in rivals}
        possible = [c for c in found.values() if c.p_value < settings.alpha and physical(c.score)]
        if not possible or len(accepted) >= settings.most:
            break
        best = max(possible, key=lambda candidate: candidate.evidence)
        p_values.append(best)
        accepted = _refitted(problem, [*accepted, step.refined(best.score)])
    causes = [
        _cause(problem, accepted, i, able, p_values[i], settings) for i in range(len(accepted))
    ]
    strongest_first = tuple(sorted(causes, key=lambda cause: -cause.size))
    return Found(causes=strongest_first, last=found, step=step)


def _refitted(problem: Problem, accepted: list[Score]) -> list[Score]:
    """Return the accepted effects with the shape of each searched again beside the others."""
    if len(accepted) == 1:
        return accepted
    fitted = list(accepted)
    for i, one in enumerate(fitted):
        step = Step.of(problem, fitted[:i] + fitted[i + 1 :])
        again, _ = score(one.effect, problem, step.channels, step.projector, step.misfit)
        fitted[i] = step.refined(again)
    return fitted


def _cause(
    problem: Problem,
    accepted: Sequence[Score],
    number: int,
    able: Sequence[Effect],
    found: Candidate,
    settings: DiagnosisSettings,
) -> Cause:
    """Return an accepted effect with all that could take its part, its companions in place."""
    others = [score for i, score in enumerate(accepted) if i != number]
    step = Step.of(problem, others)
    companions = {score.effect.name for score in others}
    rivals = {
        effect.name: step.judged(effect, len(able), settings.seed)
        for effect in able
        if effect.name not in companions
    }
    evidence = {name: rival.evidence for name, rival in rivals.items() if physical(rival.score)}
    share = probabilities(evidence)
    fitted = step.refined(rivals[accepted[number].effect.name].score)
    return Cause(
        candidate=replace(found, score=fitted),
        effects=credible_set(share),
        probabilities={name: value for name, value in share.items() if value >= 1e-3},
        size=step.size(fitted),
    )
