"""The load's part of friction depends on temperature."""

import numpy as np

from frictioncli.effects.base import (
    REFERENCE_TEMPERATURE,
    Basis,
    Effect,
    EffectTable,
    Parameter,
    Signature,
    friction_only,
)


def basis(table: EffectTable) -> Basis:
    """Return squared load times warming, 1 at load 10 and 35 °C."""
    warming = (table.temperature - REFERENCE_TEMPERATURE) / 10.0
    return friction_only(np.square(table.load / 10.0) * warming)


EFFECT = Effect(
    name="load_temperature",
    summary="The load's part of friction changes with temperature.",
    equation="dtau = aT*(L/10)^2*(T - 25)/10",
    source=(
        "Product of the load and temperature terms of equation (16) of Nevmerzhitskiy et al. 2019,"
        " doi:10.1155/2019/6931563; load and temperature together: Bittencourt and Gunnarsson 2012,"
        " J. Dyn. Syst. Meas. Control 134(5) 051013"
    ),
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="load_temperature_coefficient",
            symbol="aT",
            unit="torque/(10 °C)",
            lower=-0.3,
            upper=0.1,
            description="Added friction at load torque 10 per 10 °C; negative where it falls hot",
        ),
    ),
    basis=basis,
    needs=("load", "temperature"),
    signature=Signature(
        axis="temperature",
        claim="The parabola of friction over load is flatter when hot than when cold.",
    ),
    confounders=("torque_constant", "load_velocity", "coulomb_temperature"),
    experiment=(
        "Sweep two payloads at 30, 45 and 60 °C, each held constant: only the loaded angles change."
    ),
    mirror="The load torque must not change with temperature.",
)
