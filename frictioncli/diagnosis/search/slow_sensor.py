"""What a temperature sensor that lags may hide of a lag of the gear, or add to it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.left_by_base import left_by, rms_left, torque_left_by
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.effects.base import applicable
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

TIME_CONSTANT = 120.0
"""Time constant up to which a sensor in a winding may lag. [s]"""


def behind_sensor(
    causes: Sequence[Cause],
    measurement: Sequence[Cause],
    problem: Problem,
    base: Problem,
    span: Array,
) -> tuple[Cause, ...]:
    """Return causes of which a lag of the gear is known as well as what a sensor adds to it.

    Data with both hardly tell how much either lags: where that of the sensor came out impossible,
    or is in a set with that of the gear, it does not stand beside the base, and what is seen is the
    sum of both. A gear that follows the motor lags by more than is seen, one that friction warms
    more than the motor by less.

    Parameters
    ----------
    causes : sequence of Cause
        The causes.
    measurement : sequence of Cause
        Effects of the measurement beside the base.
    problem : Problem
        The rows, as the causes were found.
    base : Problem
        The rows about the measured temperature, after whose slope a sensor lags.
    span : ndarray, shape (2 * rows, rank)
        What can take torque from a cause.
    """
    beside = {one.fit.effect.name for one in measurement}
    if SENSOR_LAG.name in beside or not applicable([SENSOR_LAG], base.table):
        return tuple(causes)
    sensor = left_by(span, base.basis(SENSOR_LAG, {}))[:, 0]
    return tuple(
        _beside_any(sensor, one, problem, span) if one.fit.effect.name == THERMAL_LAG.name else one
        for one in causes
    )


def _beside_any(sensor: Array, cause: Cause, problem: Problem, span: Array) -> Cause:
    """Return a lag whose interval holds what is left of it beside any sensor of a winding."""
    both = torque_left_by(span, problem, cause.fit)
    nearest = float(both @ sensor) / max(float(sensor @ sensor), 1e-300)
    alone, slow, least = (
        rms_left(both - late * sensor)
        for late in (0.0, TIME_CONSTANT, np.clip(nearest, 0.0, TIME_CONSTANT))
    )
    low, high = cause.visible_interval
    below = float(np.hypot(cause.visible - low, alone - least))
    above = float(np.hypot(high - cause.visible, max(slow - alone, 0.0)))
    interval = max(cause.visible - below, 0.0), cause.visible + above
    return replace(cause, visible_interval=interval)
