"""Magnets weaken when hot, and the torque computed from current is then too high.

The motor needs more current for the same torque, so friction and load grow in the log by the same
percentage: one coefficient for both channels. Ferrite magnets lose about 0.2 %/°C, neodymium ones
about 0.11 %/°C. A negative coefficient means a controller that corrects too much.
"""

import numpy as np

from frictioncli.effects.base import (
    REFERENCE_TEMPERATURE,
    Basis,
    Effect,
    EffectTable,
    Parameter,
    Signature,
)


def basis(table: EffectTable) -> Basis:
    """Return both torques times the motor's warming above 25 °C, in hundreds of °C."""
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
            description="Growth of the logged torque per degree of the motor",
        ),
    ),
    basis=basis,
    needs=("motor_temperature",),
    uses=("friction", "load"),
    signature=Signature(
        axis="motor_temperature",
        claim="Friction and load torque grow with motor temperature by the same percentage.",
    ),
    confounders=("coulomb_temperature", "load_temperature", "payload_change"),
    experiment=(
        "Hold a known payload still, or against a brake, cold and hot: gravity does not change, so"
        " a change of the logged torque is the motor's."
    ),
    mirror="Friction and load torque must change by the same percentage per degree.",
)
