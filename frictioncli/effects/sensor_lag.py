r"""The temperature sensor follows the part that it measures with a delay.

A sensor of time constant :math:`\theta_s` reads :math:`T - \theta_s \dot T`, and friction is that
of the true temperature,

.. math:: \Delta\tau = \frac{\partial\tau}{\partial T}\, \theta_s\, \dot T,

lower while heating and higher while cooling than the reading tells. The slope :math:`\dot T` is
that of :func:`frictioncli.effects.reading_slope.reading_slope`.
"""

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.pair_series import pair_heads
from frictioncli.effects.parameter import Parameter
from frictioncli.effects.reading_slope import reading_slope


def basis(table: EffectTable) -> Basis:
    """Return the change of friction per time constant of the sensor, shape (rows, 1) [N·m/s]."""
    slope = pair_heads(table).spread(table.once(reading_slope))
    return friction_only(table.temperature_slope * slope)


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
    uses=("friction_power", "speed", "position", "order", "moved"),
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
