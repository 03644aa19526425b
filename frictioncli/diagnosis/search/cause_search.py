"""Forward search for causes: test every effect, accept the best, refit, test again.

Effects of the measurement stand beside the base from the start, so that no other effect can explain
what they explain. At each step every other effect is tested against the null hypothesis, the base
with the effects accepted so far, with the variances of noise and discrepancy that suit either best.
The search ends when no effect is significant and large enough to matter. At the end each accepted
effect is tested against all others once more beside the other accepted ones: every effect that
explains its part nearly as well joins its credible set.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.noise.significance import credible_set, posterior_probabilities
from frictioncli.diagnosis.ramps.evidence import RampEvidence
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause import CONVINCING, Cause
from frictioncli.diagnosis.search.effect_size import sizes_of
from frictioncli.diagnosis.search.effect_tests import EffectTests, names_of_fits
from frictioncli.diagnosis.search.guessed_travel import likelier_travel
from frictioncli.diagnosis.search.margin import strength
from frictioncli.diagnosis.search.measurement import measurement_causes
from frictioncli.diagnosis.search.possible import lies_on_bound
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.rivals import likeliest, rival_log_bayes_factors
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.shown import shown_by_residuals
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import Effect, applicable

_SUPERFLUOUS = "other causes explain it"


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
    search = EffectTests(precomputed, catalogue, margin, ramps, beside.effects)
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
        for name in names_of_fits(retested) & superfluous:
            superfluous.remove(name)
            again.add(name)
            del dropped[name]
        # an effect that another one has made superfluous must not come back again and again
        for name in names_of_fits(candidates) - names_of_fits(retested):
            if name not in again:
                superfluous.add(name)
            dropped[name] = _SUPERFLUOUS
        accepted = retested
    causes = _causes(search, accepted, impossible)
    within = [_within_bounds(search, accepted, one) for one in causes]
    if any(within):
        accepted = [two or one for one, two in zip(accepted, within, strict=True)]
        step, tests = search.tested(accepted)
        causes = _causes(search, accepted, impossible)

    def share(cause: Cause) -> float:
        return strength(problem, cause.fit.effect.channel, cause.size)

    return SearchResult(
        causes=tuple(sorted(causes, key=share, reverse=True)),
        measurement=measurement_causes(step, beside.effects),
        refused=beside.refused,
        rejected=tests,
        dropped={name: why for name, why in dropped.items() if name not in names_of_fits(accepted)},
        step=step,
        catalogue=catalogue,
    )


def _causes(
    search: EffectTests, accepted: Sequence[EffectFit], impossible: Collection[str]
) -> list[Cause]:
    return [_cause(search, accepted, number, impossible) for number in range(len(accepted))]


def _within_bounds(
    search: EffectTests, accepted: Sequence[EffectFit], cause: Cause
) -> EffectFit | None:
    """Return an effect that may replace one whose size a bound sets, if it has a size itself."""
    own = cause.fit.effect.name
    if not lies_on_bound(cause.fit) or len(cause.effects) == 1:
        return None
    step, tests = search.tested([one for one in accepted if one.effect.name != own])
    found = likeliest(step, [tests[name] for name in cause.effects if name != own])
    return None if lies_on_bound(found) else found


def _cause(
    search: EffectTests, accepted: Sequence[EffectFit], number: int, impossible: Collection[str]
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
