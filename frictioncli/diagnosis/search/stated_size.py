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
from frictioncli.diagnosis.fit.extension import Extension, extend, with_shapes
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, span_of, visible_size
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import FORM, shown_of
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.measurement import CLEAR, beside_the_rest
from frictioncli.diagnosis.search.possible_beside import possible_beside
from frictioncli.diagnosis.search.slow_sensor import behind_sensor
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis, friction_only
from frictioncli.effects.thermal_lag import EFFECT as LAG


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
    stated = stated_sizes(causes, extension, step.problem, weighted_fit, span)
    possible = possible_beside(extension.effects, step, measurement, refused)
    if possible:
        fits = (*extension.effects, *possible)
        again = extend(step.problem, step.predicting_fit(), fits)
        weighted_fit = sizing_fit(step, measurement, fits)
        beside = stated_sizes(causes, again, step.problem, weighted_fit, span)
        stated = tuple(_with_either(one, other) for one, other in zip(stated, beside, strict=True))
    return behind_sensor(stated, measurement, step.problem, base, span)


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


def stated_sizes(
    causes: Sequence[Cause],
    extension: Extension,
    problem: Problem,
    weighted_fit: WeightedFit,
    span: Array,
) -> tuple[Cause, ...]:
    """Return named causes with the sizes that the extended model gives them.

    Effects of the measurement keep theirs. The size of a lag of the gear is what the base at the
    measured temperature leaves of the friction at the hidden one, with all that its parameters add:
    a gear that warms more and friction that falls less with temperature compensate each other, so
    that the size is known though neither is.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named, in the order of the first effects of the extension.
    extension : Extension
        The extended model.
    problem : Problem
        The rows, as the causes were found.
    weighted_fit : WeightedFit
        As of :func:`sizing_fit`.
    span : ndarray, shape (2 * rows, rank)
        What can take torque from a cause, as of :func:`span_at_measured`.
    """
    friction, load = with_shapes(problem, extension.effects)
    covariance = weighted_fit.error_covariance(friction, load, whole=True)
    found = []
    for number, cause in enumerate(causes):
        if cause.fit.effect.measurement:
            found.append(cause)
            continue
        one = extension.effects[number]
        own = np.r_[extension.place(number), extension.shape_place(number)]
        # to first order a change of the shape is a change of torque, and adds to no size by itself
        coefficients = np.append(one.coefficients, np.zeros(len(one.effect.shape)))
        if one.effect.name == LAG.name:
            own = np.r_[np.arange(len(extension.names)), own]
            coefficients = np.append(extension.changes, coefficients)
        columns = Basis(friction[:, own], load[:, own])
        fitted = columns, coefficients, covariance[np.ix_(own, own)]
        if one.effect.name == LAG.name:
            fitted = _with_simulated(problem, *fitted)
        found.append(_stated(cause, one, problem, span, fitted))
    return tuple(found)


def _with_simulated(
    problem: Problem, columns: Basis, coefficients: Array, covariance: Array
) -> tuple[Basis, Array, Array]:
    """Return columns, coefficients and their covariance with the simulated friction before them.

    At the measured temperature the base leaves nothing of it.
    """
    simulated = friction_only(problem.friction - problem.friction_misfit)
    before = (np.column_stack(one) for one in zip(simulated, columns, strict=True))
    return Basis(*before), np.append(1.0, coefficients), np.pad(covariance, ((1, 0), (1, 0)))


def _stated(
    cause: Cause,
    one: EffectFit,
    problem: Problem,
    span: Array,
    fitted: tuple[Basis, Array, Array],
) -> Cause:
    """Return a cause with its sizes, from its columns, their coefficients and the covariance."""
    columns, coefficients, covariance = fitted

    def size_of(both: Array) -> tuple[float, tuple[float, float]]:
        shown = shown_of(problem, one.effect, both)
        size, low, high = visible_size(shown, coefficients, covariance)
        below, above = np.hypot([size - low, high - size], Z95 * FORM * size)
        return size, (max(float(size - below), 0.0), float(size + above))

    visible, interval = size_of(left_by(span, columns))
    size, size_interval = visible, interval
    if len(one.coefficients) == 1:
        in_friction = one.effect.channel == "friction"
        torque = columns.friction if in_friction else columns.load
        whole, whole_interval = size_of(_in_one(torque, in_friction=in_friction))
        # where the base may take any of it, only what the base leaves is known
        if whole_interval[0] > 0.0 or interval[0] <= 0.0:
            size, size_interval = whole, whole_interval
    return replace(
        cause,
        size=size,
        size_interval=size_interval,
        visible=visible,
        visible_interval=interval,
    )


def _in_one(torque: Array, *, in_friction: bool) -> Array:
    """Return torque in one channel, friction above load."""
    nothing = np.zeros_like(torque)
    return np.vstack([torque, nothing] if in_friction else [nothing, torque])
