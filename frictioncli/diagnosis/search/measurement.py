"""Effects of the measurement that stand beside the base: which are possible, and their tests.

References
----------
.. [1] J. A. Hausman, "Specification tests in econometrics," Econometrica 46(6), 1978,
   doi:10.2307/1913827.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Flags
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import beside_unfitted
from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.noise.significance import NullDistribution
from frictioncli.diagnosis.noise.spectra import Spectra
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import sizes_of
from frictioncli.diagnosis.search.possible import (
    beyond_bounds,
    impossible,
    smoother_than_late,
    standard_errors,
    times_its_range,
    undetermined,
    with_unit,
)
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.distributions import chi2_tail
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import Effect, applicable
from frictioncli.effects.torque_delay import EFFECT as TORQUE_DELAY
from frictioncli.effects.torque_filter import EFFECT as TORQUE_FILTER
from frictioncli.wording import in_words

CLEAR = 0.01
"""Greatest p-value of an effect of the measurement that is listed and corrected without a name."""

_HAUSMAN = 3.0
"""Standard errors by which an estimate may change when another effect is given up [1]_."""

_UNCHANGED = 0.25
"""Share of an estimate by which it may change besides, and by its standard error: what the model
lacks moves precise estimates by more than their errors."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BesideBase:
    """What stands beside the base from the start, and what was refused.

    Attributes
    ----------
    precomputed : Precomputed
        What is computed once, with the effects.
    effects : tuple of Effect
        Effects of the measurement that are possible.
    refused : tuple of Cause
        Those that are not, each with the reason, as it came out when it was refused.
    """

    precomputed: Precomputed
    effects: tuple[Effect, ...]
    refused: tuple[Cause, ...]


def beside_base(
    problem: Problem,
    discrepancy: float = SHARE,
    measurement: Sequence[Effect] = MEASUREMENT_EFFECTS,
    found: Sequence[EffectFit] = (),
    spectra: Sequence[Spectra] = (),
) -> BesideBase:
    """Return what is computed once, with the effects of the measurement that stand beside the base.

    One that is physically impossible explains something else, as friction along angle and speed,
    and would hide it: impossible ones are given up one at a time, and with each those whose
    estimates hang on it. Then those that the data do not determine are given up together: which of
    two that they cannot tell apart is there, is not for bounds to say.

    Parameters
    ----------
    problem : Problem
        One joint's measurements and base model.
    discrepancy : float, optional
        RMS of the discrepancy that is expected, relative to the mean friction; 0 for none.
    measurement : sequence of Effect, optional
        Effects of the measurement that may stand there.
    found : sequence of EffectFit, optional
        Properties of the joint that are known to be there: without them, what they add may look
        like an effect of the measurement, or hide one.
    spectra : sequence of Spectra, optional
        Spectra of the same pairs, so that none is worked out twice.
    """
    beside = applicable(measurement, problem.table)
    if problem.has_load_channel:
        # what a log does to its torque does not show in a load that it measures apart
        beside = tuple(one for one in beside if one.channel == "friction")
    refused: list[Cause] = []
    before: tuple[Cause, ...] = ()
    precomputed: Precomputed | None = None
    while True:
        precomputed = Precomputed.of(problem, beside, discrepancy, precomputed, spectra)
        spectra = precomputed.noises.spectra
        causes = measurement_causes(Step.of(precomputed, found), beside)
        against = _moved(before, causes, refused[-1:])
        before = ()
        if not against:
            doubted = _first([(one, impossible(one.fit, problem)) for one in causes])
            against = sorted(doubted, key=lambda one: -times_its_range(one[0].fit, problem))[:1]
            before = causes if against else ()
        against = against or doubtful_filter(causes, alone=not found)
        against = against or _first([(one, undetermined(one.fit, problem)) for one in causes])
        if not against:
            return BesideBase(precomputed=precomputed, effects=beside, refused=tuple(refused))
        refused += [replace(one, standing="undetermined", reason=why) for one, why in against]
        gone = {one.fit.effect.name for one, _ in against}
        beside = tuple(one for one in beside if one.name not in gone)


def doubtful_filter(causes: Sequence[Cause], *, alone: bool = True) -> list[tuple[Cause, str]]:
    """Return the filter with the reason if it smooths the torque more than the torque is late.

    Parameters
    ----------
    causes : sequence of Cause
        Effects of the measurement that are fitted together.
    alone : bool, optional
        Whether no property of the joint stands beside them.
    """
    fits = {one.fit.effect.name: one for one in causes}
    late, smeared = fits.get(TORQUE_DELAY.name), fits.get(TORQUE_FILTER.name)
    if late is None or smeared is None:
        return []
    why = smoother_than_late(smeared.fit, late.fit, alone=alone)
    return [(smeared, why)] if why else []


def _first(doubted: Sequence[tuple[Cause, str]]) -> list[tuple[Cause, str]]:
    """Return which of those with a reason are given up next: of higher order before the others."""
    against = [(one, why) for one, why in doubted if why]
    higher = [(one, why) for one, why in against if one.fit.effect.name == TORQUE_FILTER.name]
    return higher or against


def _moved(
    before: Sequence[Cause], causes: Sequence[Cause], refused: Sequence[Cause]
) -> list[tuple[Cause, str]]:
    """Return the effects whose estimates hang on one that was refused, with the reason.

    By the test of Hausman: of an estimate that does not hang on it, the change has the variance by
    which that of the estimate falls. So does one of which there is no evidence beside it: the data
    do not tell one from the other, and what is there is not the one that is refused.
    """
    old = {one.fit.effect.name: one.fit for one in before}
    found = []
    for one in causes if old else ():
        first, fit = old[one.fit.effect.name], one.fit
        freed = np.maximum(np.diag(first.covariance) - np.diag(fit.covariance), 0.0)
        reach = _HAUSMAN * np.sqrt(freed) + _UNCHANGED * np.abs(first.coefficients)
        reach += standard_errors(fit)
        own = (fit.effect.coefficients, first.coefficients, fit.coefficients, reach)
        only_without = (_differ(fit) & ~_differ(first)).tolist()
        for parameter, was, value, most, alone in zip(*own, only_without, strict=True):
            if alone or abs(value - was) > most:
                other = in_words(refused[0].fit.effect.name)
                why = (
                    f"its {parameter.in_words} depends on a physically impossible {other}:"
                    f" {with_unit(parameter, was)} with it, {with_unit(parameter, value)} without"
                )
                found.append((one, why))
                break
    return found


def _differ(fit: EffectFit) -> Flags:
    """Return which coefficients differ from 0."""
    return np.asarray(np.abs(fit.coefficients) > Z95 * standard_errors(fit))


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
            p_value=min(1.0, len(effects) * chi2_tail(statistic, len(coefficients))),
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


def clear_effects(beside: BesideBase, found: Sequence[EffectFit] = ()) -> tuple[Effect, ...]:
    """Return the effects of the measurement beside the base that are clearly there.

    Parameters
    ----------
    beside : BesideBase
        What stands beside the base.
    found : sequence of EffectFit, optional
        Properties of the joint that are known to be there.
    """
    causes = measurement_causes(Step.of(beside.precomputed, found), beside.effects)
    return tuple(one.fit.effect for one in causes if one.test.p_value < CLEAR)


def corrected_without_name(
    judged: Sequence[Cause], causes: Sequence[Cause], problem: Problem
) -> tuple[Cause, ...]:
    """Return effects of the measurement that are corrected though they are not named.

    They may be smaller than what is worth naming, and a prediction without them is worse: on the
    run that was kept out that looks like structure of its own.

    Parameters
    ----------
    judged : sequence of Cause
        All that was found, with its standing.
    causes : sequence of Cause
        Those that extend the model.
    problem : Problem
        The joint's rows.
    """
    named = {cause.fit.effect.name for cause in causes}
    return tuple(
        replace(one, reason=f"{one.reason}; corrected nonetheless")
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
