"""The search for causes: test every effect, accept the best, refit, test again.

At each step every other effect is set against the base and the effects accepted so far, with the
noise that suits either best. The search ends when none stands out of what noise gives. At the end
each accepted effect is set against all others once more, with its companions in place: what could
take its part joins its credible set.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import hypothesis_of
from frictioncli.diagnosis.fit.judgement import Judged, Score
from frictioncli.diagnosis.noise.significance import credible_set, probabilities
from frictioncli.diagnosis.ramps.evidence import RampEvidence, arbitrated
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed
from frictioncli.diagnosis.search.step import DRAWS, Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.effects.availability import judgeable
from frictioncli.effects.base import Effect

_CONVINCING = 3.0
"""Logarithm of the Bayes factor that an effect needs: twenty effects, any may be at work or none.
What stands out less is also not to be told from most others."""

_FORM = 0.02
"""What has less than this share of the statistic of an effect found before may only mend that
one's form: no equation of the catalogue is true to the last digit."""

_FORM_ALIKE = 0.05
"""The same share where both show along the stroke, or both from pair to pair."""

_CONTENDERS = 4
"""Effects whose shapes are searched off the grid before the best is taken."""

_CLEARLY = 3.0
"""Logarithm of the Bayes factor by which another name must fit better to replace an earlier."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A cause found: the effect accepted, and what else could take its part.

    Attributes
    ----------
    score : Score
        The effect accepted, fitted beside its companions.
    judged : Judged
        How it stands beside its companions, over all its shapes.
    effects : tuple of str
        Its credible set.
    probabilities : dict of str to float
        Probability of each effect that could take its part.
    size : float
        RMS in its channel. [N·m]
    visible : float
        RMS of what the base model cannot take of it. [N·m]
    """

    score: Score
    judged: Judged
    effects: tuple[str, ...]
    probabilities: dict[str, float]
    size: float
    visible: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What a search found.

    Attributes
    ----------
    causes : tuple of Cause
        Strongest first.
    last : dict of str to Judged
        All effects at the last step: what silence means.
    step : Step
        The last step: base, causes and their noise.
    """

    causes: tuple[Cause, ...]
    last: dict[str, Judged]
    step: Step


def find_causes(
    problem: Problem,
    effects: Sequence[Effect],
    settings: DiagnosisSettings,
    ramps: RampEvidence | None = None,
) -> Found:
    """Search the catalogue for the causes of a problem's misfit.

    Parameters
    ----------
    problem : Problem
        One joint's measurements and base model.
    effects : sequence of Effect
        The catalogue.
    settings : DiagnosisSettings
        How sure a finding must be.
    ramps : RampEvidence, optional
        What the ramps say of inertia and of friction after a reversal.
    """
    able = judgeable(effects, problem.table)
    bench = Precomputed.of(problem)
    catalogue = Catalogue.of(bench, [hypothesis_of(effect, problem) for effect in able])
    hunt = _Search(bench, catalogue, settings, ramps)
    accepted: list[Score] = []
    dropped: set[str] = set()
    while True:
        step, found = hunt.judged(accepted, DRAWS)
        possible = [
            one
            for one in found.values()
            if one.p_value < settings.alpha
            and one.evidence > _CONVINCING
            and one.statistic > _form_error(accepted, one.name)
            and one.name not in dropped
        ]
        if not possible or len(accepted) >= settings.most:
            break
        tried = [*accepted, _best(step, possible)]
        settled = hunt.settled(tried)
        # an effect that another one has made needless must not come back again and again
        dropped |= _names(tried) - _names(settled)
        accepted = settled
    causes = [_cause(hunt, accepted, i) for i in range(len(accepted))]
    strongest_first = tuple(sorted(causes, key=lambda cause: -cause.size))
    return Found(causes=strongest_first, last=found, step=step)


def _form_error(accepted: Sequence[Score], name: str) -> float:
    """Return what an effect must explain so as not to be a mere error of another one's form."""
    own = _within_stroke(BY_NAME[name])
    shares = [
        one.statistic * (_FORM_ALIKE if _within_stroke(one.effect) == own else _FORM)
        for one in accepted
    ]
    return max(shares, default=0.0)


def _within_stroke(effect: Effect) -> bool:
    """Return whether an effect shows along the stroke, and not only from pair to pair."""
    return effect.channel == "load" or bool({"position", "load"} & set(effect.needs))


def _names(scores: Sequence[Score]) -> set[str]:
    return {one.effect.name for one in scores}


def _best(step: Step, possible: Sequence[Judged]) -> Score:
    """Return the effect that stands best once its shape is searched off the grid.

    Where an effect is large, a shape between two of the grid may explain many times as much.
    """
    first = sorted(possible, key=lambda one: -one.evidence)[:_CONTENDERS]
    refined = [step.refined(one.score(BY_NAME[one.name])) for one in first]
    stand = [
        one.evidence + max(score.statistic - one.statistic, 0.0) / 2
        for one, score in zip(first, refined, strict=True)
    ]
    return refined[stand.index(max(stand))]


@dataclass(frozen=True, slots=True)
class _Search:
    """The search's tools: data, catalogue and settings."""

    bench: Precomputed
    catalogue: Catalogue
    settings: DiagnosisSettings
    ramps: RampEvidence | None

    def judged(self, accepted: Sequence[Score], draws: int = 0) -> tuple[Step, dict[str, Judged]]:
        """Return the step with these effects, and how all others stand there."""
        step = Step.of(self.bench, accepted)
        rivals = self.catalogue.without(_names(accepted))
        found = step.judged(rivals, self.settings.seed, draws)
        evidence = arbitrated({name: one.evidence for name, one in found.items()}, self.ramps)
        return step, {name: replace(one, evidence=evidence[name]) for name, one in found.items()}

    def settled(self, accepted: list[Score]) -> list[Score]:
        """Return the effects judged once more, each with the others in place.

        What was accepted early was judged with too little beside it. It is kept, changes its name
        to one that fits clearly better, or goes if the others have made it needless.
        """
        current = list(accepted)
        if len(current) == 1:
            return current
        for one in accepted:
            others = [other for other in current if other is not one]
            again = self._again(one, others)
            if again is None:
                current = others
            else:
                current[current.index(one)] = again
        return current

    def _again(self, one: Score, others: Sequence[Score]) -> Score | None:
        """Return an effect fitted beside others, or what replaces it there; none if needless."""
        step, found = self.judged(others)
        best, own = max(found.values(), key=lambda judged: judged.evidence), found[one.effect.name]
        if best.evidence <= _CONVINCING:
            return None
        again = step.refined(one)
        stands = own.evidence + max(again.statistic - own.statistic, 0.0) / 2
        if best.name != own.name and best.evidence - stands > _CLEARLY:
            return _best(step, [best])
        return again


def _cause(hunt: _Search, accepted: Sequence[Score], number: int) -> Cause:
    """Return an accepted effect with all that could take its part, its companions in place."""
    one = accepted[number]
    others = [other for other in accepted if other is not one]
    step, rivals = hunt.judged(others, DRAWS)
    score = step.refined(one)
    own = rivals[one.effect.name]
    evidence = {name: rival.evidence for name, rival in rivals.items()}
    evidence[own.name] += max(score.statistic - own.statistic, 0.0) / 2
    share = probabilities(evidence)
    return Cause(
        score=score,
        judged=own,
        effects=credible_set(share),
        probabilities={name: value for name, value in share.items() if value >= 1e-3},
        size=step.size(score),
        visible=step.visible(score),
    )
