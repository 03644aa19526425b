r"""The torque constant falls as the magnets warm, and torque computed from current is too high.

.. math:: \Delta\tau = k_t \tau\, (T_m - 25)/100, \quad \Delta L = k_t L\, (T_m - 25)/100

The motor needs more current for the same torque, so that friction and load grow in the log by the
same percentage: one coefficient for both channels. Ferrite magnets lose about 0.2 %/°C, neodymium
magnets about 0.11 %/°C. A negative coefficient means that the controller overcompensates.
"""

import numpy as np

from frictioncli.effects.base import REFERENCE_TEMPERATURE, Basis, Effect, EffectTable, Signature
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return both torques times the motor temperature above 25 °C [N·m·100 °C]."""
    warming = (table.motor_temperature - REFERENCE_TEMPERATURE) / 100.0
    return Basis(
        np.column_stack([table.friction * warming]), np.column_stack([table.load * warming])
    )


EFFECT = Effect(
    name="torque_constant",
    summary="The motor's torque per current changes with its temperature.",
    equation="dtau = kt/100*tau*(Tm - 25), dL = kt/100*L*(Tm - 25)",
    source="Reversible temperature coefficient of permanent magnets; sizes from data sheets",
    channel="load",
    shape=(),
    coefficients=(
        Parameter(
            name="percent_per_degree",
            symbol="kt",
            unit="%/°C",
            lower=-0.3,
            upper=0.3,
            description="Growth of the logged torque per degree of motor temperature",
        ),
    ),
    basis=basis,
    needs=("motor_temperature",),
    uses=("friction", "load"),
    signature=Signature(
        axis="motor_temperature",
        claim="Friction and load torque grow with motor temperature by the same percentage.",
    ),
    statement="The logged torque grows by {percent_per_degree} with the motor's temperature.",
    confounders=("coulomb_temperature", "load_temperature", "payload_change"),
    experiment=(
        "Hold a known payload still, or against a brake, cold and hot: gravity does not change, so"
        " a change of the logged torque is the motor's."
    ),
    mirror="Friction and load torque must change by the same percentage per degree.",
)
