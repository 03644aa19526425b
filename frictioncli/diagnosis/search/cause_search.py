"""Forward search for causes: test every effect, accept the best, refit, test again.

Effects of the measurement stand beside the base from the start, so that no other effect can explain
what they explain. At each step every other effect is tested against the null hypothesis, the base
with the effects accepted so far, with the variances of noise and discrepancy that suit either best.
The search ends when no effect is significant and large enough to matter. At the end each accepted
effect is tested against all others once more beside the other accepted ones: every effect that
explains its part nearly as well joins its credible set.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import (
    EffectFit,
    Hypothesis,
    HypothesisTest,
    free_coefficients,
)
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.noise.significance import (
    credible_set,
    posterior_probabilities,
)
from frictioncli.diagnosis.ramps.evidence import RampEvidence, with_ramp_evidence
from frictioncli.diagnosis.search.cancelling import Cancelling, cancelling
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause import CONVINCING, Cause
from frictioncli.diagnosis.search.effect_size import elsewhere, left_size, sizes_of
from frictioncli.diagnosis.search.guessed_travel import likelier_travel
from frictioncli.diagnosis.search.margin import channel_margin, strength
from frictioncli.diagnosis.search.measurement import measurement_causes
from frictioncli.diagnosis.search.possible import beyond_bounds
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.refined_test import refined_test
from frictioncli.diagnosis.search.rivals import CLEARLY, likeliest, rival_log_bayes_factors
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.shown import shown_by_residuals
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, MEASUREMENT_EFFECTS
from frictioncli.effects.base import Effect, applicable
from frictioncli.effects.history_search import leaves_out
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

_LEAST_SHARE = 0.5
"""Share of the margin that the base must leave of an effect for the search to go on with it."""

_SUPERFLUOUS = "other causes explain it"

_REMEMBERED = 3
"""Number of steps with accepted effects that are remembered, beside the first."""


def find_causes(
    problem: Problem,
    effects: Sequence[Effect],
    settings: DiagnosisSettings,
    margin: float,
    ramps: RampEvidence | None = None,
    discrepancy: float = SHARE,
    preparation: Preparation | None = None,
    measurement: tuple[Effect, ...] = MEASUREMENT_EFFECTS,
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
    margin : float
        Smallest size worth a name. [N·m]
    ramps : RampEvidence, optional
        Evidence of the ramps on inertia and on friction after a reversal.
    discrepancy : float, optional
        RMS of the discrepancy that is expected, relative to the mean friction; 0 for none.
    preparation : Preparation, optional
        What is known of problems that are searched more than once.
    measurement : tuple of Effect, optional
        Effects of the measurement that may stand beside the base.
    """
    preparation = preparation or Preparation()
    beside = preparation.beside(problem, discrepancy, measurement)
    precomputed = beside.precomputed
    tried = applicable(effects, problem.table)
    hypotheses = preparation.hypotheses(problem, tried)
    catalogue = Catalogue.of(precomputed, hypotheses)
    search = _Search(precomputed, catalogue, settings, margin, ramps, beside.effects)
    accepted: list[EffectFit] = []
    dropped: dict[str, str] = {}
    impossible: set[str] = set()
    superfluous: set[str] = set()
    again: set[str] = set()
    while True:
        step, tests = search.tested(accepted)
        significant = [
            one
            for one in tests.values()
            if one.p_value < settings.alpha
            and one.log_bayes_factor > CONVINCING
            and (one.name not in dropped or one.name in superfluous)
            and search.matters(step, one)
        ]
        new = [one for one in significant if one.name not in superfluous]
        significant = new or significant
        if not significant or len(accepted) >= settings.most:
            both = search.cancelling(accepted)
            if both is None:
                break
            accepted = [one for one in accepted if one is not both.effect]
            if not both.stands_alone:
                kept = tuple(one for one in measurement if one is not both.measured.fit.effect)
                common = (problem, effects, settings, margin, ramps, discrepancy, preparation)
                without = find_causes(*common, kept)
                return replace(without, refused=(*without.refused, both.measured))
            name = both.effect.effect.name
            dropped[name] = both.reason
            impossible.add(name)
            continue
        # what made these superfluous may have been given up since: each comes back once
        for one in significant:
            if one.name in superfluous:
                superfluous.remove(one.name)
                again.add(one.name)
                del dropped[one.name]
        candidates = [*accepted, likeliest(step, significant)]
        reason = search.impossible(candidates)
        if reason:
            dropped[candidates[-1].effect.name] = reason
            impossible.add(candidates[-1].effect.name)
            continue
        # what others made superfluous may be better than one of them alone: it comes back once, too
        retested = search.retested(candidates, set(dropped) - superfluous)
        for name in _names(retested) & superfluous:
            superfluous.remove(name)
            again.add(name)
            del dropped[name]
        # an effect that another one has made superfluous must not come back again and again
        for name in _names(candidates) - _names(retested):
            if name not in again:
                superfluous.add(name)
            dropped[name] = _SUPERFLUOUS
        accepted = retested
    causes = [_cause(search, accepted, i, impossible) for i in range(len(accepted))]

    def share(cause: Cause) -> float:
        return strength(problem, cause.fit.effect.channel, cause.size)

    return SearchResult(
        causes=tuple(sorted(causes, key=share, reverse=True)),
        measurement=measurement_causes(step, beside.effects),
        refused=beside.refused,
        rejected=tests,
        dropped={name: why for name, why in dropped.items() if name not in _names(accepted)},
        step=step,
        catalogue=catalogue,
    )


def _names(fits: Sequence[EffectFit]) -> set[str]:
    return {one.effect.name for one in fits}


@dataclass(frozen=True, slots=True)
class _Search:
    """Data, hypotheses and settings of a search."""

    precomputed: Precomputed
    catalogue: Catalogue
    settings: DiagnosisSettings
    margin: float
    ramps: RampEvidence | None
    beside: tuple[Effect, ...] = ()
    _known: dict[tuple[int, ...], tuple[Step, dict[str, HypothesisTest]]] = field(
        default_factory=dict
    )

    def tested(self, accepted: Sequence[EffectFit]) -> tuple[Step, dict[str, HypothesisTest]]:
        """Return the step with these effects accepted, and the tests of all others there."""
        # the same effects are accepted more than once: a step holds them, and so their numbers
        key = tuple(id(one) for one in accepted)
        if key not in self._known:
            for old in [one for one in self._known if one][:-_REMEMBERED]:
                del self._known[old]
            self._known[key] = self._tested(Step.of(self.precomputed, accepted))
        return self._known[key]

    def _tested(self, step: Step) -> tuple[Step, dict[str, HypothesisTest]]:
        skip = _names(step.accepted)
        least = {one.name: self._least(BY_NAME[one.name]) for one in self.catalogue.hypotheses}
        tests = step.tested(self.catalogue, skip, least=least)
        for one in self.catalogue.hypotheses:
            if one.name in tests and self._leaves_out(one):
                fit = step.refined(tests[one.name].effect_fit(BY_NAME[one.name]))
                tests[one.name] = self.refined_test(tests[one.name], fit)
        factors = with_ramp_evidence(
            {name: one.log_bayes_factor for name, one in tests.items()}, self.ramps
        )
        return step, {
            name: replace(one, log_bayes_factor=factors[name]) for name, one in tests.items()
        }

    def _leaves_out(self, hypothesis: Hypothesis) -> bool:
        """Return whether a change may have begun at a moment that its grid leaves out."""
        problem = self.precomputed.problem
        is_change = BY_NAME[hypothesis.name].moments is not None
        return is_change and leaves_out(problem.all_runs, problem.rows, hypothesis.shapes)

    def refined_test(self, test: HypothesisTest, fit: EffectFit) -> HypothesisTest:
        """Return the test of an effect at its refined shape."""
        return refined_test(self.precomputed.problem, test, fit, len(self.catalogue.hypotheses))

    def matters(self, step: Step, test: HypothesisTest) -> bool:
        """Return whether the base leaves enough of an effect for the search to go on with it."""
        effect = BY_NAME[test.name]
        return left_size(step.precomputed, test.effect_fit(effect))[0] > self._least(effect)

    def _least(self, effect: Effect) -> float:
        """Return the least size with which the search goes on, in the channel of an effect."""
        problem = self.precomputed.problem
        return _LEAST_SHARE * channel_margin(problem, effect.channel, self.margin)

    def impossible(self, accepted: Sequence[EffectFit]) -> str:
        """Return why the last of some effects is impossible, or not shown by its own channel.

        Once accepted its coefficients that lie on no bound are free, and would explain what is
        another's. A lag of the gear is possible where friction is linear about a hidden
        temperature, which was found within physical bounds: beyond them it asks for another's.
        """
        newest = accepted[-1]
        if newest.effect is THERMAL_LAG and self.precomputed.problem.hidden is not None:
            return ""
        fit = Step.of(self.precomputed, accepted).fit
        free = free_coefficients(newest)
        place = len(fit.coefficients) - len(free) + np.arange(len(free))
        coefficients, covariance = newest.coefficients.copy(), newest.covariance.copy()
        coefficients[free] = fit.coefficients[place]
        covariance[np.ix_(free, free)] = fit.covariance[np.ix_(place, place)]
        unbounded = replace(newest, coefficients=coefficients, covariance=covariance)
        known = self.precomputed
        return beyond_bounds(unbounded, known.problem) or elsewhere(known, newest)

    def cancelling(self, accepted: Sequence[EffectFit]) -> Cancelling | None:
        """Return an accepted effect and one of the measurement that cancel each other, if any."""
        return cancelling(self.precomputed, self.beside, accepted)

    def retested(self, accepted: list[EffectFit], dropped: Collection[str] = ()) -> list[EffectFit]:
        """Return the accepted effects, each tested once more beside the others.

        An effect accepted early was tested without the later ones. It is kept, replaced by an
        effect that fits clearly better, or dropped if the others have made it superfluous. One that
        was given up replaces none: what is impossible would explain what is another's.
        """
        current = list(accepted)
        if len(current) == 1:
            return current
        for one in accepted:
            others = [other for other in current if other is not one]
            again = self._retested(one, others, dropped)
            if again is None:
                current = others
            else:
                current[current.index(one)] = again
        return current

    def _retested(
        self, one: EffectFit, others: Sequence[EffectFit], dropped: Collection[str]
    ) -> EffectFit | None:
        """Return an effect refitted beside others, or its replacement; None if superfluous."""
        step, tests = self.tested(others)
        possible = [test for test in tests.values() if test.name not in dropped]
        best = max(possible, key=lambda test: test.log_bayes_factor)
        own = tests[one.effect.name]
        if best.log_bayes_factor <= CONVINCING:
            return None
        again = step.refined(one)
        factor = own.refined_log_bayes_factor(again)
        if best.name != own.name and best.log_bayes_factor - factor > CLEARLY:
            replacement = likeliest(step, [best])
            return again if self.impossible([*others, replacement]) else replacement
        return again


def _cause(
    search: _Search, accepted: Sequence[EffectFit], number: int, impossible: Collection[str]
) -> Cause:
    """Return an accepted effect with its credible set, beside the other accepted effects.

    What is physically impossible cannot replace it.
    """
    one = accepted[number]
    others = [other for other in accepted if other is not one]
    step, tests = search.tested(others)
    fit = step.refined(one)
    own = search.refined_test(tests[one.effect.name], fit)
    factor = own.log_bayes_factor
    possible = {name: test for name, test in tests.items() if name not in impossible}
    possible, variants = likelier_travel(step, possible, factor)
    sizes = sizes_of(step.precomputed, fit)
    left_share = sizes["visible"] / max(sizes["size"], 1e-300)
    share = posterior_probabilities(
        rival_log_bayes_factors(step, fit, factor, possible, left_share, variants)
    )
    return Cause(
        fit=fit,
        test=own,
        effects=credible_set(share),
        probabilities={name: value for name, value in share.items() if value >= 1e-3},
        shown=shown_by_residuals(step.precomputed, fit, others),
        **sizes,
    )
