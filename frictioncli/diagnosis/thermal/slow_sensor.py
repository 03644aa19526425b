"""What a temperature sensor that lags may hide of a lag of the gear."""

from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.fit.left_by_base import left_by
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.search_result import SearchResult
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
    problem = found.step.precomputed.problem
    beside = {one.fit.effect.name for one in found.measurement}
    if SENSOR_LAG.name in beside or not applicable([SENSOR_LAG], problem.table):
        return found
    causes = (
        _larger_by_chance(one, found) if one.fit.effect.name == LAG else one for one in found.causes
    )
    return replace(found, causes=tuple(causes))


def _larger_by_chance(cause: Cause, found: SearchResult) -> Cause:
    """Return a lag whose interval holds what a slow sensor would hide of it."""
    known, fit = found.step.precomputed, cause.fit
    lag = left_by(known.span, known.problem.basis(fit.effect, fit.shape)) @ fit.coefficients
    sensor = left_by(known.span, known.problem.basis(SENSOR_LAG, {}))[:, 0]
    with_sensor, alone = (
        float(np.linalg.norm(one)) / np.sqrt(len(one) / 2)
        for one in (lag - TIME_CONSTANT * sensor, lag)
    )
    low, high = cause.visible_interval
    above = np.hypot(high - cause.visible, max(with_sensor - alone, 0.0))
    return replace(cause, visible_interval=(low, cause.visible + float(above)))
