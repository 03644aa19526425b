r"""Coulomb friction, constant in the base model, changes with temperature.

.. math:: \Delta\tau = c_T (T - 25) / 10
"""

from frictioncli.effects.base import (
    REFERENCE_TEMPERATURE,
    Basis,
    Effect,
    EffectTable,
    Signature,
    friction_only,
)
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return the temperature above 25 °C, shape (rows, 1). [10 °C]."""
    return friction_only((table.temperature - REFERENCE_TEMPERATURE) / 10.0)


EFFECT = Effect(
    name="coulomb_temperature",
    summary="Coulomb friction changes with temperature, not only viscous friction.",
    equation="dtau = ct*(T - 25)/10",
    source="Linear term added to equation (16) of Nevmerzhitskiy et al. 2019, "
    "doi:10.1155/2019/6931563",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="coulomb_slope",
            symbol="ct",
            unit="torque/(10 °C)",
            lower=-6.0,
            upper=3.0,
            description="Change of Coulomb friction per 10 °C; negative if it falls",
        ),
    ),
    basis=basis,
    needs=("temperature",),
    signature=Signature(
        axis="temperature",
        claim="Residuals change with temperature by the same torque at all speeds.",
    ),
    statement="Coulomb friction changes with temperature, by {coulomb_slope}.",
    confounders=("torque_constant", "load_temperature", "thermal_lag"),
    experiment=(
        "Measure at slow speed, where viscous friction is small, cold and hot, with a known"
        " payload: if the load torque changes by the same percentage, it is the motor's torque"
        " constant."
    ),
    mirror="The load torque must not change with temperature.",
)
