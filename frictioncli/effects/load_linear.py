r"""Friction grows with the absolute load torque, not only with its square.

.. math:: \Delta\tau = a_l |L|
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return the absolute load torque, shape (rows, 1) [N·m]."""
    return friction_only(np.abs(table.load))


EFFECT = Effect(
    name="load_linear",
    summary="Friction grows with the amount of load, with a kink at zero load.",
    equation="dtau = al*abs(L)",
    source=(
        "Equation (4) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563; load term of"
        " Bittencourt and Gunnarsson 2012, J. Dyn. Syst. Meas. Control 134(5) 051013"
    ),
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="load_share",
            symbol="al",
            unit="1",
            lower=0.0,
            upper=0.5,
            description="Friction torque per load torque",
        ),
    ),
    basis=basis,
    needs=("load",),
    signature=Signature(
        axis="load",
        claim="Residuals have a kink at zero load and rise on both sides of it.",
    ),
    statement="Friction grows with the amount of load, by a share of {load_share}.",
    confounders=("position_ripple", "load_velocity", "load_temperature"),
    experiment=(
        "Measure with three payloads, at angles on both sides of zero load: the kink stays at zero"
        " load, a ripple stays at its angle."
    ),
)
