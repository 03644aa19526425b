r"""Viscous friction grows with another power of speed than the square root.

The power law :math:`k v^p` is not linear in :math:`p`. Its tangent at :math:`p = 1/2` is:

.. math:: k \sqrt v\,(v/v_0)^{p - 1/2} \approx k \sqrt v\,[1 + (p - 1/2) \ln(v/v_0)]

The coefficient is the change of the exponent; :math:`v_0` is the geometric mean speed of the pairs,
where the refitted base model already holds. The tangent is within a tenth of the effect while
:math:`|p - 1/2|\,|\ln(v/v_0)| < 0.2`; beyond, the effect is still found but its exponent is
rough.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, friction_only
from frictioncli.effects.pairs import pair_heads


def basis(table: EffectTable) -> Basis:
    """Return the derivative of viscous friction by its exponent, in units of torque."""
    logarithm = np.log(table.speed)
    mean = np.mean(logarithm[pair_heads(table).first])
    return friction_only(table.viscous * np.sqrt(table.speed) * (logarithm - mean))


EFFECT = Effect(
    name="velocity_exponent",
    summary="Viscous friction grows with another power of speed than 1/2.",
    equation="dtau = dp*(beta + gamma*exp(-delta*T))*sqrt(v)*ln(v/v0), v0 = geometric mean speed",
    source=(
        "Equation (13) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563, where the exponent"
        " is fixed at 1/2"
    ),
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="exponent_change",
            symbol="dp",
            unit="1",
            lower=-0.2,
            upper=0.5,
            description="Exponent of speed less 1/2",
        ),
    ),
    basis=basis,
    needs=("speed",),
    uses=("viscous",),
    signature=Signature(
        axis="speed",
        claim=(
            "Over the logarithm of speed the residuals form an even bow,"
            " and the bow flattens as the joint warms."
        ),
    ),
    confounders=("linear_viscous", "quadratic_drag", "stribeck"),
    experiment=(
        "Sweep speeds from the slowest to the fastest at two temperatures held constant: the bow of"
        " an exponent shrinks with heat as viscous friction does, that of a constant term stays."
    ),
)
