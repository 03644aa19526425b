r"""The load-dependent part of friction changes with temperature.

.. math:: \Delta\tau = a_T (L/10)^2\, \frac{1 - e^{-b (T - 25)}}{10\, b}
"""

import numpy as np

from frictioncli.effects.base import (
    REFERENCE_TEMPERATURE,
    Basis,
    Effect,
    EffectTable,
    Signature,
    friction_only,
)
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, bend: float) -> Basis:
    """Return squared load times warming, shape (rows, 1); 1 at load 10 and near 35 °C. [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    bend : float
        Rate at which the change decays with warming; 0 where it is linear. [1/°C]
    """
    excess = table.temperature - REFERENCE_TEMPERATURE
    # in the limit of b = 0, (1 - exp(-b x)) / b is x
    warming = excess / 10.0 if abs(bend) < 1e-9 else -np.expm1(-bend * excess) / (10.0 * bend)
    return friction_only(np.square(table.load / 10.0) * warming)


EFFECT = Effect(
    name="load_temperature",
    summary="The load-dependent part of friction changes with temperature.",
    equation="dtau = aT*(L/10)^2*(1 - exp(-b*(T - 25)))/(10*b)",
    source=(
        "Product of the load and temperature terms of equation (16) of Nevmerzhitskiy et al. 2019,"
        " doi:10.1155/2019/6931563; load and temperature together: Bittencourt and Gunnarsson 2012,"
        " J. Dyn. Syst. Meas. Control 134(5) 051013"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="bend",
            symbol="b",
            unit="1/°C",
            lower=-0.04,
            upper=0.08,
            description="How fast the change fades as it warms; 0 where it is even",
            points=4,
        ),
    ),
    coefficients=(
        Parameter(
            name="load_temperature_coefficient",
            symbol="aT",
            unit="torque/(10 °C)",
            lower=-0.3,
            upper=0.1,
            description="Added friction at load torque 10 per 10 °C; negative if it falls",
            of_square_load=True,
        ),
    ),
    basis=basis,
    needs=("load", "temperature"),
    signature=Signature(
        axis="temperature",
        claim="The parabola of friction over load is flatter when hot than when cold.",
    ),
    statement=(
        "The load-dependent part of friction changes with temperature, by"
        " {load_temperature_coefficient} at load torque 10."
    ),
    confounders=("torque_constant", "load_velocity", "coulomb_temperature"),
    experiment=(
        "Sweep two payloads at 30, 45 and 60 °C, each held constant: only the loaded angles change."
    ),
    mirror="The load torque must not change with temperature.",
)
