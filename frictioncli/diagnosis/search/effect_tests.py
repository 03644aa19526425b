"""Tests of effects at a step of the search, and of those accepted once more beside each other."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictioncli.diagnosis.fit.hypotheses import (
    EffectFit,
    Hypothesis,
    HypothesisTest,
    free_coefficients,
)
from frictioncli.diagnosis.ramps.evidence import RampEvidence, with_ramp_evidence
from frictioncli.diagnosis.search.cancelling import Cancelling, cancelling
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause import CONVINCING
from frictioncli.diagnosis.search.effect_size import elsewhere, left_size
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.possible import beyond_bounds
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.refined_test import refined_test
from frictioncli.diagnosis.search.rivals import CLEARLY, likeliest
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect
from frictioncli.effects.history_search import leaves_out
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

_LEAST_SHARE = 0.5
"""Share of the margin that the base must leave of an effect for the search to go on with it."""

_REMEMBERED = 3
"""Number of steps with accepted effects that are remembered, beside the first."""


def names_of_fits(fits: Sequence[EffectFit]) -> set[str]:
    """Return the names of the effects that were fitted.

    Parameters
    ----------
    fits : sequence of EffectFit
        The effects.
    """
    return {one.effect.name for one in fits}


@dataclass(frozen=True, slots=True)
class EffectTests:
    """Tests of the catalogue's effects, each beside those that a search has accepted.

    Attributes
    ----------
    precomputed : Precomputed
        What all steps of the search share.
    catalogue : Catalogue
        The effects that are tried.
    margin : float
        Smallest size worth a name. [N·m]
    ramps : RampEvidence or None
        Evidence of the ramps on inertia and on friction after a reversal.
    beside : tuple of Effect
        Effects of the measurement beside the base.
    """

    precomputed: Precomputed
    catalogue: Catalogue
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
        skip = names_of_fits(step.accepted)
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
