r"""The temperature sensor follows the part that it measures with a delay.

A sensor of time constant :math:`\theta_s` reads :math:`T - \theta_s \dot T`, and friction is that
of the true temperature,

.. math:: \Delta\tau = \frac{\partial\tau}{\partial T}\, \theta_s\, \dot T,

lower while heating and higher while cooling than the reading tells. The slope :math:`\dot T` is
that of a line through the readings of four minutes; where a pause leaves no others, through a pair
and its neighbours.
"""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.pair_series import pair_heads, starts
from frictioncli.effects.parameter import Parameter

_HALF_WINDOW = 120.0
"""Half the window of the line through the readings. [s]"""


_LEAST_PAIRS = 3
"""Least number of pairs in the window. A line across a pause, in which the joint may have warmed by
many degrees, tells nothing of the slope at its ends."""


def basis(table: EffectTable) -> Basis:
    """Return the change of friction per time constant of the sensor, shape (rows, 1) [N·m/s]."""
    heads = pair_heads(table)
    run, time = table.run[heads.first], table.time[heads.first]
    temperature = table.temperature[heads.first]
    slope = np.zeros_like(time)
    begins = np.flatnonzero(starts(run))
    for begin, end in zip(begins, np.append(begins[1:], len(time)), strict=True):
        slope[begin:end] = _slopes(time[begin:end], temperature[begin:end])
    return friction_only(table.temperature_slope * heads.spread(slope))


def _slopes(time: Array, value: Array) -> Array:
    """Return the slope of the line through the values around each time, 0 where there is none."""
    pairs = np.arange(len(time))
    low = np.searchsorted(time, time - _HALF_WINDOW, side="left")
    high = np.searchsorted(time, time + _HALF_WINDOW, side="right")
    few = high - low < _LEAST_PAIRS
    low = np.maximum(np.where(few, np.minimum(low, pairs - 1), low), 0)
    high = np.minimum(np.where(few, np.maximum(high, pairs + 2), high), len(time))
    count = high - low
    moved, raised = time - time.mean(), value - value.mean()

    def total(values: Array) -> Array:
        sums = np.concatenate([[0.0], np.cumsum(values)])
        return np.asarray(sums[high] - sums[low])

    middle = total(moved) / count
    spread = total(np.square(moved)) - count * np.square(middle)
    together = total(moved * raised) - middle * total(raised)
    known = spread > 1e-9 * np.maximum(np.square(np.ptp(time)), 1e-9)
    return np.divide(together, spread, out=np.zeros_like(together), where=known)


EFFECT = Effect(
    name="sensor_lag",
    summary="The temperature sensor lags behind the part that it measures.",
    equation="dtau = dtau/dT*theta_s*dT/dt",
    source="First-order response of a temperature sensor, linear in its time constant",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="time_constant",
            symbol="theta_s",
            unit="s",
            # seconds in the winding, minutes on a housing; more is heat on its way, thermal_lag
            lower=0.0,
            upper=300.0,
            description="Time constant with which the sensor follows",
        ),
    ),
    basis=basis,
    measurement=True,
    needs=("time", "temperature", "temperature_slope"),
    signature=Signature(
        axis="motor_temperature",
        claim=(
            "At the same reading friction is lower while heating than while cooling, in"
            " proportion to the rate of change of the reading."
        ),
    ),
    statement="The temperature sensor lags by {time_constant}.",
    confounders=("thermal_lag", "drift", "run_in"),
    experiment=(
        "Stop the joint while it heats and read the sensor every few seconds: a lagging sensor"
        " keeps rising at first."
    ),
)
