"""Rivals of a cause: effects that explain what it explains, and the likeliest of them."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest
from frictioncli.diagnosis.noise.significance import credible_set, posterior_probabilities
from frictioncli.diagnosis.search.possible import lies_on_bound
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect

CLEARLY = 3.0
"""Log Bayes factor by which another effect must fit better to replace an accepted one."""

_REFINED = 3
"""Number of effects whose shapes are refined off the grid before the best is accepted."""

_NEARLY = 5.0
"""Log Bayes factor below that of a cause at which another effect is too improbable to matter,
unless it is one of many."""

_FORM = 0.1
"""What the form of an entry may miss of an effect, relative to its size: two standard
deviations."""

_MOST_MISSED = 0.1
"""Greatest share of the evidence of a cause that its form may account for."""

_KEPT = 0.5
"""Share of its test statistic that a cause keeps beside an effect that explains something else."""


def likeliest(step: Step, tests: Sequence[HypothesisTest]) -> EffectFit:
    """Return the effect with the greatest Bayes factor once its shape is refined off the grid.

    Where an effect is large, a shape between two of the grid may explain many times as much. One
    whose size bounds set, not the data, stands back behind another that explains nearly as much.

    Parameters
    ----------
    step : Step
        Base and the effects accepted so far.
    tests : sequence of HypothesisTest
        Tests of the effects there.
    """
    first = sorted(tests, key=lambda one: -one.log_bayes_factor)[:_REFINED]
    refined = [step.refined(one.effect_fit(BY_NAME[one.name])) for one in first]
    factors = [one.refined_log_bayes_factor(fit) for one, fit in zip(first, refined, strict=True)]
    both = [
        (factor, fit)
        for factor, fit in zip(factors, refined, strict=True)
        if factor >= max(factors) - CLEARLY
    ]
    return max(both, key=lambda one: (not lies_on_bound(one[1]), one[0]))[1]


def rival_log_bayes_factors(
    step: Step,
    own: EffectFit,
    factor: float,
    tests: Mapping[str, HypothesisTest],
    left_share: float = 1.0,
    variants: Mapping[str, Effect] = MappingProxyType({}),
) -> dict[str, float]:
    """Return the log Bayes factors of a cause and of the effects that may stand for it, by name.

    Another effect that is as certain is no rival if the cause is needed beside it, too: it explains
    something else.

    No form is exactly true. What it misses is a greater part of what the base leaves of an effect
    than of the whole, and by the square of that part a rival may fall behind though it is the
    cause.

    Parameters
    ----------
    step : Step
        Base and the other causes.
    own : EffectFit
        The cause, fitted there.
    factor : float
        Its log Bayes factor.
    tests : mapping of str to HypothesisTest
        Tests of all effects there.
    left_share : float, optional
        Share of its RMS that the base leaves of the cause.
    variants : mapping of str to Effect, optional
        Effects by name that are not those of the catalogue.
    """
    missed = evidence_missed(own.statistic, left_share)
    near = {
        name: min(one.log_bayes_factor + missed, max(factor, one.log_bayes_factor))
        for name, one in tests.items()
        if name != own.effect.name
    }
    share = {own.effect.name: factor} | near
    judged = {own.effect.name}
    while True:
        # many that explain nothing are together more probable than each is
        members = credible_set(posterior_probabilities(share))
        doubtful = [
            name
            for name, value in share.items()
            if name not in judged and (value >= factor - _NEARLY or name in members)
        ]
        if not doubtful:
            return share
        judged.update(doubtful)
        for name in doubtful:
            if not _explains(
                step, own, tests[name].effect_fit(variants.get(name) or BY_NAME[name])
            ):
                del share[name]


def evidence_missed(statistic: float, left_share: float) -> float:
    """Return the logarithm of the evidence of a cause that errors of its form may account for.

    Parameters
    ----------
    statistic : float
        Its test statistic.
    left_share : float
        Share of its RMS that the base leaves of it.
    """
    return min((_FORM / max(left_share, _FORM)) ** 2, _MOST_MISSED) * statistic / 2


def _explains(step: Step, own: EffectFit, rival: EffectFit) -> bool:
    """Return whether a cause is hardly needed beside a rival."""
    instead = step.refined(rival)
    beside = Step.of(step.precomputed, [*step.accepted, instead])
    return beside.fitted(own.effect, own.shape).statistic < _KEPT * own.statistic
