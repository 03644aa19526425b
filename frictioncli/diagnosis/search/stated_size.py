"""Sizes of named causes as the extended model has them: these are stated.

Causes are found under the noise and the discrepancy that suit them best. At a few speeds, or near a
few angles, discrepancy may then explain what the form of an effect misses, and the effect is as
large as the many other rows have it. The extended model is fitted to all rows alike, so that it has
what the residuals show of an effect at face value; its errors allow for noise, for discrepancy, for
effects of the measurement that are not fitted, and for the shapes.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension, extend
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import span_of
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.fitted_size import fitted_sizes
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.measurement import CLEAR, beside_the_rest
from frictioncli.diagnosis.search.possible_beside import possible_beside
from frictioncli.diagnosis.search.slow_sensor import behind_sensor
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.thermal_lag import EFFECT as LAG

_KNOWN = 0.5
"""Lower end of the interval of a size, relative to it, from which on the size is well known."""


def span_at_measured(base: Problem, measurement: Sequence[Cause]) -> Array:
    """Return what can take torque from a cause: base and measurement, at a measured temperature.

    Parameters
    ----------
    base : Problem
        The rows with the base model about the measured temperature.
    measurement : sequence of Cause
        Effects of the measurement beside the base.

    Returns
    -------
    ndarray, shape (2 * rows, rank)
        An orthonormal basis.
    """
    return span_of(base, [base.basis(one.fit.effect, {}) for one in measurement])


def sizing_fit(
    step: Step, measurement: Sequence[Cause], fitted: Sequence[EffectFit]
) -> WeightedFit:
    """Return the fit by which sizes are stated: of all rows alike, beside what is not fitted.

    What stands out of base and measurement is along torque that the data show: unlike that of a
    parameter of the base, its error by the discrepancy is as large as they tell.

    Parameters
    ----------
    step : Step
        Base and causes, with the noise that suits them best.
    measurement : sequence of Cause
        Effects of the measurement beside the base.
    fitted : sequence of EffectFit
        The effects that extend the model.
    """
    torques = step.precomputed.discrepancy.torques(step.fit.variances.amplitude)
    friction, load = np.split(torques, 2)
    fit = replace(step.predicting_fit(), unfitted=((friction, load),))
    return beside_the_rest(step.problem, fit, measurement, fitted)


def _at_least(
    stated: Sequence[Cause],
    fits: Sequence[EffectFit],
    step: Step,
    sizing: WeightedFit,
    span: Array,
) -> tuple[Cause, ...]:
    """Return causes with intervals that do not reach below what is sure in spite of a drift.

    With all rows alike a slow drift of the noise may leave a size undetermined. Weighted by the
    covariance of the noise, what changes faster than the drift decides. Of what is slow a part is
    then taken for drift: such a size is a lower limit.

    Parameters
    ----------
    stated : sequence of Cause
        Causes with their sizes, in the order of the first of `fits`.
    fits : sequence of EffectFit
        The effects that extend the model.
    step : Step
        Base and causes, with the noise that suits them best.
    sizing : WeightedFit
        The fit by which the sizes were stated.
    span : ndarray, shape (2 * rows, rank)
        What can take torque from a cause, as of :func:`span_at_measured`.
    """
    if all(one.visible_interval[0] >= _KNOWN * one.visible for one in stated):
        return tuple(stated)
    sizing = sizing.by_covariance()
    again = extend(step.problem, sizing, fits)
    weighted = fitted_sizes(stated, again, step.problem, sizing, span)
    return tuple(_with_limit(one, other) for one, other in zip(stated, weighted, strict=True))


def _with_limit(one: Cause, weighted: Cause) -> Cause:
    """Return a cause whose size is no less than a lower limit that agrees with its interval."""
    low, high = one.visible_interval
    least = weighted.visible_interval[0]
    undetermined = not one.fit.effect.measurement and low < _KNOWN * one.visible
    if not undetermined or one.size_interval is None or not low < least <= weighted.visible <= high:
        return one
    return replace(
        one,
        size=one.size if one.size > least else weighted.size,
        size_interval=(max(least, one.size_interval[0]), one.size_interval[1]),
        visible=one.visible if one.visible > least else weighted.visible,
        visible_interval=(least, high),
    )


def sizes_in_model(
    causes: Sequence[Cause],
    extension: Extension,
    step: Step,
    measurement: Sequence[Cause],
    base: Problem,
    refused: Sequence[Cause] = (),
) -> tuple[Cause, ...]:
    """Return causes with their sizes in an extended model, a lag of the gear behind a slow sensor.

    Parameters
    ----------
    causes : sequence of Cause
        The causes, in the order of the first effects of the extension.
    extension : Extension
        The extended model.
    step : Step
        Base and causes, with the noise that suits them best.
    measurement : sequence of Cause
        Effects of the measurement beside the base.
    base : Problem
        The rows with the base model about the measured temperature, which takes torque from causes.
    refused : sequence of Cause, optional
        Effects of the measurement that were refused beside the base: those that are possible beside
        the causes may be there or not, and the intervals hold the sizes in both cases.
    """
    if all(one.fit.effect.measurement for one in causes):
        return tuple(causes)
    span = span_at_measured(base, measurement)
    weighted_fit = sizing_fit(step, measurement, extension.effects)
    stated = fitted_sizes(causes, extension, step.problem, weighted_fit, span)
    stated = _at_least(stated, extension.effects, step, weighted_fit, span)
    possible = possible_beside(extension.effects, step, measurement, refused)
    if possible:
        fits = (*extension.effects, *possible)
        again = extend(step.problem, step.predicting_fit(), fits)
        weighted_fit = sizing_fit(step, measurement, fits)
        beside = fitted_sizes(causes, again, step.problem, weighted_fit, span)
        stated = tuple(_with_either(one, other) for one, other in zip(stated, beside, strict=True))
    stated = behind_sensor(stated, measurement, step.problem, base, span)
    return tuple(_holding_found(one, found) for one, found in zip(stated, causes, strict=True))


def _holding_found(stated: Cause, found: Cause) -> Cause:
    """Return a cause whose interval reaches what was found of it where that is surely more.

    Where the temperature only rises, parameters of the base that no joint has take most of a lag.
    """
    least, most = found.visible_interval
    if found.fit.effect.measurement or least <= stated.visible_interval[1]:
        return stated
    whole = stated.size_interval
    return replace(
        stated,
        visible_interval=(stated.visible_interval[0], most),
        size_interval=whole and (whole[0], max(whole[1], most)),
    )


def _with_either(one: Cause, other: Cause) -> Cause:
    """Return a cause with intervals that hold those of another estimate of it.

    The temperature of the gear is that of the extended model, and no other estimate of it. Where
    the other estimate may be 0, the data do not tell the cause from what it was fitted beside, and
    which of both is there was for the search to decide.
    """
    if one.fit.effect.name == LAG.name or one.size_interval is None or other.size_interval is None:
        return one
    if other.size_interval[0] <= 0.0:
        return one

    def either(first: tuple[float, float], second: tuple[float, float]) -> tuple[float, float]:
        return min(first[0], second[0]), max(first[1], second[1])

    return replace(
        one,
        size_interval=either(one.size_interval, other.size_interval),
        visible_interval=either(one.visible_interval, other.visible_interval),
    )


def sizes_beside_each_other(
    causes: Sequence[Cause],
    step: Step,
    measurement: Sequence[Cause],
    base: Problem,
    margin: float,
) -> tuple[Cause, ...]:
    """Return causes with the sizes that decide on their names, beside others that have one.

    What the extended model has of a cause decides, or what the search found of it if the model
    surely has some. The smallest one that may be below the margin goes first, with the size that it
    has in the model; the others are estimated without it.

    Parameters
    ----------
    causes : sequence of Cause
        Causes, none of them an effect of the measurement.
    step, measurement, base
        As of :func:`sizes_in_model`.
    margin : float
        Smallest size worth a name. [N·m]

    Returns
    -------
    tuple of Cause
        In another order.
    """
    clear = [one.fit for one in measurement if one.test.p_value < CLEAR]
    alike = step.predicting_fit()
    among: list[Cause] = list(causes)
    gone: list[Cause] = []

    def over_margin(cause: Cause) -> float:
        return cause.visible_interval[0] / channel_margin(base, cause.fit.effect.channel, margin)

    def deciding(found: Cause, stated: Cause) -> Cause:
        return found if over_margin(found) > 1.0 and 0.0 < over_margin(stated) <= 1.0 else stated

    while among:
        fits = [*(one.fit for one in among), *clear]
        weighted_fit = beside_the_rest(step.problem, alike, measurement, fits)
        extension = extend(step.problem, weighted_fit, fits)
        stated = sizes_in_model(among, extension, step, measurement, base)
        sized = [deciding(one, two) for one, two in zip(among, stated, strict=True)]
        least = min(range(len(sized)), key=lambda number: over_margin(sized[number]))
        if over_margin(sized[least]) > 1.0:
            return (*sized, *gone)
        del among[least]
        gone.append(stated[least])
    return tuple(gone)
