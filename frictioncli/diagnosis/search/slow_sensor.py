"""What a temperature sensor that lags may hide of a lag of the gear."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.left_by_base import left_by
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.effects.base import applicable
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

TIME_CONSTANT = 90.0
"""Time constant up to which a sensor in a winding may lag. [s]"""


def behind_sensor(
    causes: Sequence[Cause], measurement: Sequence[Cause], problem: Problem, span: Array
) -> tuple[Cause, ...]:
    """Return causes of which a lag of the gear may be larger by what a sensor hides of it.

    Behind a sensor that lags, a gear lags less, and data with both hardly tell how much: a sensor
    alone would have to lead. So it does not stand beside the base, and what is seen of the lag of
    the gear is what the sensor leaves of it.

    Parameters
    ----------
    causes : sequence of Cause
        The causes.
    measurement : sequence of Cause
        Effects of the measurement beside the base.
    problem : Problem
        The rows.
    span : ndarray, shape (2 * rows, rank)
        What can take torque from a cause.
    """
    beside = {one.fit.effect.name for one in measurement}
    if SENSOR_LAG.name in beside or not applicable([SENSOR_LAG], problem.table):
        return tuple(causes)
    return tuple(
        _larger_by_chance(one, problem, span) if one.fit.effect.name == THERMAL_LAG.name else one
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
