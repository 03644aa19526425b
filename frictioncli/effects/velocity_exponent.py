r"""Viscous friction grows with another power of speed than the square root.

Where a share *s* of the viscous friction follows the power *p*, it differs from the base model by

.. math:: s\,(\beta + \gamma e^{-\delta T})\sqrt v\,[(v/v_0)^{p - 1/2} - 1]

with the geometric mean speed :math:`v_0` of the pairs, where the refitted base model holds. With
few speeds a small share of a distant exponent resembles a full share of one near 1/2: only the
product is well determined.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.pair_series import pair_heads
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, exponent: float) -> Basis:
    """Return the change of viscous friction if all of it has the exponent, shape (rows, 1) [N·m].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    exponent : float
        Exponent of speed p. [-]
    """
    logarithm = np.log(table.speed)
    mean = np.mean(logarithm[pair_heads(table).first])
    growth = np.expm1((exponent - 0.5) * (logarithm - mean))
    return friction_only(table.viscous * np.sqrt(table.speed) * growth)


EFFECT = Effect(
    name="velocity_exponent",
    summary="Viscous friction follows a power of speed other than 1/2.",
    equation="dtau = s*(beta + gamma*exp(-delta*T))*sqrt(v)*((v/v0)^(p - 1/2) - 1)",
    source=(
        "Equation (13) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563, where the exponent"
        " is fixed at 1/2"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="exponent",
            symbol="p",
            unit="1",
            lower=0.3,
            upper=1.0,
            description="Exponent of speed",
            points=6,
        ),
    ),
    coefficients=(
        Parameter(
            name="share",
            symbol="s",
            unit="1",
            lower=0.0,
            upper=2.0,
            description="Share of the viscous friction that follows it",
        ),
    ),
    basis=basis,
    needs=("speed",),
    uses=("viscous",),
    signature=Signature(
        axis="speed",
        claim=(
            "Over the logarithm of speed the residuals form a smooth"
            " arc, which flattens as the joint warms."
        ),
    ),
    statement=(
        "Viscous friction departs from the square root of speed {share} times as far as the power"
        " {exponent} would."
    ),
    confounders=("linear_viscous", "quadratic_drag", "stribeck"),
    experiment=(
        "Sweep speeds from the slowest to the fastest at two temperatures held constant: the"
        " curvature due to an exponent shrinks with temperature as viscous friction does, that"
        " of a constant term does not."
    ),
)
