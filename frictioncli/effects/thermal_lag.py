r"""The gear, where friction arises, has another temperature than the motor sensor.

The gear follows the motor, loses heat to surroundings at :math:`T_a` and is warmed by its own
friction power :math:`P`:

.. math:: \theta \dot T_g = a T_m + (1 - a) T_a - T_g + b\,P/P_0

To first order friction differs by :math:`\partial\tau/\partial T\,(T_g - T_m)`, and at fixed
:math:`\theta` the lag is a sum of known columns: a first-order lag of the motor temperature, the
filtered friction power, and the difference of housing and motor temperature. The remainder,
:math:`(1 - a)(T_a - T_m)`, depends on the motor temperature alone and is absorbed by delta of the
base model.

With a lag alone friction is higher while heating than while cooling. The hysteresis loop has the
opposite sense where the gear is warmer: by its friction power, or, with a negative share, because
it leads and the motor follows (a lag at small :math:`\theta` is :math:`-\theta \dot T_m`). At the
start of each run the gear is assumed to have the temperature of the motor.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, friction_only
from frictioncli.effects.pair_series import (
    first_order_lag,
    first_order_response,
    friction_power,
    pair_heads,
    starts,
)


def basis(table: EffectTable, *, time_constant: float) -> Basis:
    """Return the change of friction by lag, by friction heat and by the housing temperature.

    The first and the last column are torques [N·m], the second is torque per degree [N·m/°C]. The
    last is zero where the housing temperature is not known.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    time_constant : float
        Time constant of the gear. [s]
    """
    heads = pair_heads(table)
    time, motor = table.time[heads.first], table.motor_temperature[heads.first]
    restart = starts(table.run[heads.first])
    lag = first_order_lag(time=time, value=motor, restart=restart, time_constant=time_constant)
    heat = first_order_response(
        time=time,
        level=friction_power(table, heads),
        restart=restart,
        time_constant=time_constant,
    )
    housing = np.nan_to_num(table.housing_temperature - table.motor_temperature)
    slope = table.temperature_slope
    return friction_only(slope * heads.spread(lag), slope * heads.spread(heat), slope * housing)


EFFECT = Effect(
    name="thermal_lag",
    summary="The gear warms and cools at another pace than the sensor.",
    equation=(
        "dtau = dtau/dT*(a*(F(Tm) - Tm) + b*F(P/P0) + h*(Tc - Tm)),"
        " F: first-order filter with theta*dF(u)/dt = u - F(u), P0 = mean friction times 100 deg/s"
    ),
    source=(
        "Lumped heat balance of motor and gear; the loop is figures 5 and 6 of Nevmerzhitskiy"
        " et al. 2019, doi:10.1155/2019/6931563; hidden joint temperature: Simoni et al. 2017,"
        " doi:10.1017/S0263574717000509"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="time_constant",
            symbol="theta",
            unit="s",
            lower=120.0,
            upper=14_400.0,
            description="Time in which the gear closes 63 % of its distance to the motor",
            search="logarithmic",
        ),
    ),
    coefficients=(
        Parameter(
            name="lag_share",
            symbol="a",
            unit="1",
            lower=-5.0,
            upper=2.0,
            description=(
                "Share of the motor's course that the gear follows with delay; negative where the"
                " gear leads the motor, by |a|*theta"
            ),
        ),
        Parameter(
            name="friction_heating",
            symbol="b",
            unit="°C",
            lower=-60.0,
            upper=60.0,
            description=(
                "Gear above motor after long motion at 100 deg/s and mean friction; negative where"
                " the motion warms the motor more than the gear"
            ),
        ),
        Parameter(
            name="housing_share",
            symbol="h",
            unit="1",
            lower=-5.0,
            upper=5.0,
            description="How far the temperature of friction lies from motor towards housing",
        ),
    ),
    basis=basis,
    needs=("time", "motor_temperature", "temperature_slope"),
    uses=("friction", "speed", "travel", "housing_temperature"),
    signature=Signature(
        axis="motor_temperature",
        claim=(
            "At the same motor temperature friction differs between heating and cooling,"
            " more at high speed, and the difference fades at rest."
        ),
    ),
    confounders=("run_in", "drift", "rest_recovery", "coulomb_temperature"),
    experiment=(
        "Add a second cycle of heating and cooling with other heat: slow moves under load instead"
        " of fast ones without. Pause during cooling and measure a pair every few minutes."
    ),
    mirror="The load torque must not change with temperature.",
)
