r"""Friction differs between the two directions of motion.

With friction :math:`f_+` forward and :math:`f_-` in reverse, half the sum of the torques is the
load plus :math:`(f_+ - f_-)/2`, and half the difference is the mean of both: the asymmetry appears
in the load channel,

.. math::
    \Delta L = c_0 + \left[c_1 + c_2 (\beta + \gamma e^{-\delta T}) \sqrt{50}\right] (v/50)^p .

A constant asymmetry looks like an offset of the torque sensor, or like the constant of gravity that
the base has: only their sum is known.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, load_only
from frictioncli.effects.parameter import Parameter

_REFERENCE_SPEED = 50.0
"""Speed at which the viscous part is that of the base model. [deg/s]"""


def basis(table: EffectTable, *, exponent: float) -> Basis:
    """Return 1, a power of speed, and that times the viscous torque of the base model at 50 deg/s.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    exponent : float
        Power of speed p. [-]
    """
    power = (table.speed / _REFERENCE_SPEED) ** exponent
    viscous = table.viscous * np.sqrt(_REFERENCE_SPEED)
    return load_only(np.ones_like(power), power, viscous * power)


EFFECT = Effect(
    name="direction_asymmetry",
    summary="Friction is greater in one direction than in the other.",
    equation="dL = c0 + (c1 + c2*(beta + gamma*exp(-delta*T))*sqrt(50))*(v/50)^p",
    source=(
        "Odd part of equation (8) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563;"
        " directional friction: model M5 of Rhoban BAM, arXiv:2410.08650"
    ),
    channel="load",
    shape=(
        Parameter(
            name="exponent",
            symbol="p",
            unit="1",
            lower=0.3,
            upper=1.0,
            description="Power of speed of the viscous part",
            points=4,
        ),
    ),
    coefficients=(
        Parameter(
            name="offset",
            symbol="c0",
            unit="torque",
            lower=-5.0,
            upper=5.0,
            description="Half the difference of Coulomb friction, or an offset of the torque",
        ),
        Parameter(
            name="speed_asymmetry",
            symbol="c1",
            unit="torque",
            lower=-5.0,
            upper=5.0,
            description="Half the difference at 50 deg/s that does not change with temperature",
        ),
        Parameter(
            name="viscous_asymmetry",
            symbol="c2",
            unit="1",
            lower=-0.3,
            upper=0.3,
            description="Half the relative difference of viscous friction between directions",
        ),
    ),
    basis=basis,
    needs=("speed",),
    uses=("viscous",),
    signature=Signature(
        axis="speed",
        claim="The load torque, which gravity alone should set, shifts with speed.",
    ),
    statement=(
        "Half the difference of friction between the directions is {speed_asymmetry} more at 50"
        " deg/s than at standstill, where it looks like a constant of gravity."
    ),
    confounders=("dress_pack", "reversal_transient", "torque_constant"),
    experiment=(
        "Measure where gravity does not load the joint, or with the arm mounted the other way"
        " round: gravity changes its sign, asymmetry does not. The torque with the motors off is"
        " its zero."
    ),
)
