r"""A constant of the load channel that does not load the gear.

The fitted gravity has a constant :math:`c`. The part of it that the gear carries (a counterbalance,
a tilted base) loads the teeth as gravity does; the part that it does not carry (an offset of the
torque sensor, an asymmetry of friction) leaves them alone. With :math:`c_0` not carried,

.. math:: \Delta\tau = \alpha (L - c_0)^2 - \alpha L^2 = -2 \alpha L\, c_0 + \alpha c_0^2

where the square of the constant is part of Coulomb friction. The share of the constant that the
gear carries is :math:`1 - c_0/c`.
"""

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return the change of friction per torque that does not load the gear, shape (rows, 1) [1]."""
    return friction_only(-table.load_slope)


EFFECT = Effect(
    name="load_offset",
    summary="A part of the constant load torque does not load the gear.",
    equation="dtau = -2*alpha*L*c0",
    source=(
        "Load term of equation (16) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563,"
        " to first order in a constant of the load"
    ),
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="not_carried",
            symbol="c0",
            unit="torque",
            lower=-30.0,
            upper=30.0,
            description="Part of the constant load torque that does not load the gear",
            of_load=True,
            noun="constant load torque that does not load the gear",
        ),
    ),
    basis=basis,
    measurement=True,
    needs=("load_slope",),
    signature=Signature(
        axis="load",
        claim="Friction is lowest at another load torque than zero.",
    ),
    statement="{not_carried} of the constant load torque do not load the gear.",
    confounders=("dress_pack", "payload_change", "load_linear", "backlash"),
    experiment=(
        "Read the torque with the motors off to find the zero of the sensor, and weigh or"
        " detach any balancer: an offset that remains with the motors off does not load the gear."
    ),
)
