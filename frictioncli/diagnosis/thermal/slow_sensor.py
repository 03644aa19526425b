"""What a temperature sensor that lags may hide of a lag of the gear."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.fit.left_by_base import left_by
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.stated_size import (
    sizing_fit,
    span_at_measured,
    stated_sizes,
)
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.thermal.refine import LAG
from frictioncli.effects.base import applicable
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG

TIME_CONSTANT = 90.0
"""Time constant up to which a sensor in a winding may lag. [s]"""


def with_slow_sensor(found: SearchResult) -> SearchResult:
    """Return a result whose lag of the gear may be larger by what a sensor hides of it.

    Behind a sensor that lags, a gear lags less, and data with both hardly tell how much: a sensor
    alone would have to lead. So it does not stand beside the base, and what is seen of the lag of
    the gear is what the sensor leaves of it.

    Parameters
    ----------
    found : SearchResult
        Result of a search.
    """
    known = found.step.precomputed
    causes = _behind_sensor(found.causes, found.measurement, known.problem, known.span)
    return replace(found, causes=causes)


def sizes_behind_sensor(
    causes: Sequence[Cause],
    extension: Extension,
    step: Step,
    measurement: Sequence[Cause],
    base: Problem,
) -> tuple[Cause, ...]:
    """Return named causes with their sizes in the extended model, a lag behind such a sensor.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named, in the order of the first effects of the extension.
    extension : Extension
        The extended model.
    step : Step
        Base and these causes, with the noise that suits them best.
    measurement : sequence of Cause
        Effects of the measurement beside the base.
    base : Problem
        The rows with the base model about the measured temperature, which takes torque from causes.
    """
    if all(one.fit.effect.measurement for one in causes):
        return tuple(causes)
    span = span_at_measured(base, measurement)
    weighted_fit = sizing_fit(step, measurement, extension.effects)
    stated = stated_sizes(causes, extension, step.problem, weighted_fit, span)
    return _behind_sensor(stated, measurement, step.problem, span)


def _behind_sensor(
    causes: Sequence[Cause], measurement: Sequence[Cause], problem: Problem, span: Array
) -> tuple[Cause, ...]:
    """Return causes of which a lag of the gear may be larger by what a sensor hides of it."""
    beside = {one.fit.effect.name for one in measurement}
    if SENSOR_LAG.name in beside or not applicable([SENSOR_LAG], problem.table):
        return tuple(causes)
    return tuple(
        _larger_by_chance(one, problem, span) if one.fit.effect.name == LAG else one
        for one in causes
    )


def _larger_by_chance(cause: Cause, problem: Problem, span: Array) -> Cause:
    """Return a lag whose interval holds what a slow sensor would hide of it."""
    fit = cause.fit
    lag = left_by(span, problem.basis(fit.effect, fit.shape)) @ fit.coefficients
    sensor = left_by(span, problem.basis(SENSOR_LAG, {}))[:, 0]
    with_sensor, alone = (
        float(np.linalg.norm(one)) / np.sqrt(len(one) / 2)
        for one in (lag - TIME_CONSTANT * sensor, lag)
    )
    low, high = cause.visible_interval
    above = float(np.hypot(high - cause.visible, max(with_sensor - alone, 0.0)))
    return replace(cause, visible_interval=(low, cause.visible + above))
