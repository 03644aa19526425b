"""Forward search for causes: test every effect, accept the best, refit, test again.

At each step every other effect is tested against the null hypothesis, the base with the effects
accepted so far, with the noise model that suits either best. The search ends when no effect is
significant. At the end each accepted effect is tested against all others once more beside the other
accepted ones: every effect that explains its part nearly as well joins its credible set.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest, hypothesis_of
from frictioncli.diagnosis.noise.significance import credible_set, posterior_probabilities
from frictioncli.diagnosis.ramps.evidence import RampEvidence, with_ramp_evidence
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed
from frictioncli.diagnosis.search.step import DRAWS, Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect, applicable

_CONVINCING = 3.0
"""Log Bayes factor that an effect needs: with twenty effects, any of which may be at work, e³ is
about their number. An effect below it could not be told from most others anyway."""

_FORM = 0.02
"""An effect with less than this share of the statistic of one accepted before may only correct the
form of that one: no equation of the catalogue is exact."""

_FORM_ALIKE = 0.05
"""The same share where both show along the stroke, or both from pair to pair."""

_REFINED = 4
"""Number of effects whose shapes are refined off the grid before the best is accepted."""

_CLEARLY = 3.0
"""Log Bayes factor by which another effect must fit better to replace an accepted one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A cause found: the effect accepted, and the effects that could replace it.

    Attributes
    ----------
    fit : EffectFit
        The effect accepted, fitted beside the other causes.
    test : HypothesisTest
        Its test beside the other causes, over all its shapes.
    effects : tuple of str
        Its credible set.
    probabilities : dict of str to float
        Probability of each effect that could replace it.
    size : float
        RMS in its channel. [N·m]
    visible : float
        RMS of its residual after a fit of the base model. [N·m]
    visible_interval : (float, float)
        95 % interval of that. [N·m]
    standing : {"named", "visible", "negligible", "undetermined"}
        What may be said of it: it is named; it stands out of the noise but is not named; it is
        smaller than the margin; its size is not known well enough.
    reason : str
        Why it is not named, in words; empty where it is.
    holds_on_new_run : bool or None
        Whether it is there on the hold-out run too; None where that cannot be tested.
    """

    fit: EffectFit
    test: HypothesisTest
    effects: tuple[str, ...]
    probabilities: dict[str, float]
    size: float
    visible: float
    visible_interval: tuple[float, float] = (0.0, float("inf"))
    standing: str = "named"
    reason: str = ""
    holds_on_new_run: bool | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchResult:
    """Result of a search.

    Attributes
    ----------
    causes : tuple of Cause
        Causes found, strongest first.
    rejected : dict of str to HypothesisTest
        Tests of all other effects at the last step.
    step : Step
        The last step: base, causes and their noise.
    """

    causes: tuple[Cause, ...]
    rejected: dict[str, HypothesisTest]
    step: Step

    def detectable_sizes(self, effects: Sequence[Effect], alpha: float) -> dict[str, float | None]:
        """Return the smallest RMS size of each effect that would be found four times in five.

        Parameters
        ----------
        effects : sequence of Effect
            The catalogue.
        alpha : float
            Significance level of the whole search.

        Returns
        -------
        dict of str to (float or None)
            Sizes [N·m]; None where the data lack what the effect needs.
        """
        count = max(len(self.rejected) + len(self.causes), 1)
        tests = self.rejected | {cause.fit.effect.name: cause.test for cause in self.causes}
        return {
            effect.name: tests[effect.name].detectable_size(alpha / count)
            if effect.name in tests
            else None
            for effect in effects
        }


def find_causes(
    problem: Problem,
    effects: Sequence[Effect],
    settings: DiagnosisSettings,
    ramps: RampEvidence | None = None,
) -> SearchResult:
    """Search the catalogue for the causes of a problem's misfit.

    Parameters
    ----------
    problem : Problem
        One joint's measurements and base model.
    effects : sequence of Effect
        The catalogue.
    settings : DiagnosisSettings
        Significance level, seed and greatest number of causes.
    ramps : RampEvidence, optional
        Evidence of the ramps on inertia and on friction after a reversal.
    """
    precomputed = Precomputed.of(problem)
    hypotheses = [hypothesis_of(effect, problem) for effect in applicable(effects, problem.table)]
    search = _Search(precomputed, Catalogue.of(precomputed, hypotheses), settings, ramps)
    accepted: list[EffectFit] = []
    dropped: set[str] = set()
    while True:
        step, tests = search.tested(accepted, DRAWS)
        significant = [
            one
            for one in tests.values()
            if one.p_value < settings.alpha
            and one.log_bayes_factor > _CONVINCING
            and one.statistic > _form_error(accepted, one.name)
            and one.name not in dropped
        ]
        if not significant or len(accepted) >= settings.most:
            break
        candidates = [*accepted, _best(step, significant)]
        retested = search.retested(candidates)
        # an effect that another one has made superfluous must not come back again and again
        dropped |= _names(candidates) - _names(retested)
        accepted = retested
    causes = [_cause(search, accepted, i) for i in range(len(accepted))]
    strongest_first = tuple(sorted(causes, key=lambda cause: -cause.size))
    return SearchResult(causes=strongest_first, rejected=tests, step=step)


def _form_error(accepted: Sequence[EffectFit], name: str) -> float:
    """Return the statistic that errors in the form of the accepted effects may have."""
    within_stroke = _within_stroke(BY_NAME[name])
    shares = [
        one.statistic * (_FORM_ALIKE if _within_stroke(one.effect) == within_stroke else _FORM)
        for one in accepted
    ]
    return max(shares, default=0.0)


def _within_stroke(effect: Effect) -> bool:
    """Return whether an effect shows along the stroke, and not only from pair to pair."""
    return effect.channel == "load" or bool({"position", "load"} & set(effect.needs))


def _names(fits: Sequence[EffectFit]) -> set[str]:
    return {one.effect.name for one in fits}


def _best(step: Step, tests: Sequence[HypothesisTest]) -> EffectFit:
    """Return the effect with the greatest Bayes factor once its shape is refined off the grid.

    Where an effect is large, a shape between two of the grid may explain many times as much.
    """
    first = sorted(tests, key=lambda one: -one.log_bayes_factor)[:_REFINED]
    refined = [step.refined(one.effect_fit(BY_NAME[one.name])) for one in first]
    factors = [one.refined_log_bayes_factor(fit) for one, fit in zip(first, refined, strict=True)]
    return refined[factors.index(max(factors))]


@dataclass(frozen=True, slots=True)
class _Search:
    """Data, hypotheses and settings of a search."""

    precomputed: Precomputed
    catalogue: Catalogue
    settings: DiagnosisSettings
    ramps: RampEvidence | None

    def tested(
        self, accepted: Sequence[EffectFit], draws: int = 0
    ) -> tuple[Step, dict[str, HypothesisTest]]:
        """Return the step with these effects accepted, and the tests of all others there."""
        step = Step.of(self.precomputed, accepted)
        candidates = self.catalogue.without(_names(accepted))
        tests = step.tested(candidates, self.settings.seed, draws)
        factors = with_ramp_evidence(
            {name: one.log_bayes_factor for name, one in tests.items()}, self.ramps
        )
        return step, {
            name: replace(one, log_bayes_factor=factors[name]) for name, one in tests.items()
        }

    def retested(self, accepted: list[EffectFit]) -> list[EffectFit]:
        """Return the accepted effects, each tested once more beside the others.

        An effect accepted early was tested without the later ones. It is kept, replaced by an
        effect that fits clearly better, or dropped if the others have made it superfluous.
        """
        current = list(accepted)
        if len(current) == 1:
            return current
        for one in accepted:
            others = [other for other in current if other is not one]
            again = self._retested(one, others)
            if again is None:
                current = others
            else:
                current[current.index(one)] = again
        return current

    def _retested(self, one: EffectFit, others: Sequence[EffectFit]) -> EffectFit | None:
        """Return an effect refitted beside others, or its replacement; None if superfluous."""
        step, tests = self.tested(others)
        best = max(tests.values(), key=lambda test: test.log_bayes_factor)
        own = tests[one.effect.name]
        if best.log_bayes_factor <= _CONVINCING:
            return None
        again = step.refined(one)
        factor = own.refined_log_bayes_factor(again)
        if best.name != own.name and best.log_bayes_factor - factor > _CLEARLY:
            return _best(step, [best])
        return again


def _cause(search: _Search, accepted: Sequence[EffectFit], number: int) -> Cause:
    """Return an accepted effect with its credible set, beside the other accepted effects."""
    one = accepted[number]
    others = [other for other in accepted if other is not one]
    step, tests = search.tested(others, DRAWS)
    fit = step.refined(one)
    own = tests[one.effect.name]
    factors = {name: test.log_bayes_factor for name, test in tests.items()}
    factors[own.name] = own.refined_log_bayes_factor(fit)
    share = posterior_probabilities(factors)
    return Cause(
        fit=fit,
        test=own,
        effects=credible_set(share),
        probabilities={name: value for name, value in share.items() if value >= 1e-3},
        size=step.size(fit),
        visible=step.visible(fit),
    )
