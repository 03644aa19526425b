"""Sizes of causes from the coefficients of a fit, with intervals."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension, with_shapes
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, visible_size
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import FORM, shown_of
from frictioncli.effects.base import Basis, friction_only
from frictioncli.effects.thermal_lag import EFFECT as LAG


def fitted_sizes(
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
        The fit by which sizes are stated; its errors count.
    span : ndarray, shape (2 * rows, rank)
        What can take torque from a cause, base and measurement, at a measured temperature.
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
