r"""Cables and hoses along the arm act as a spring, as a counterbalance or any other spring does.

.. math:: \Delta L = k (x + c x^3), \quad x = q - q_\mathrm{mid} - q_0

A spring acts in the same way in both directions of motion and therefore shows in the load channel.
The rest angle of a linear spring cannot be distinguished from a constant offset; that of a
stiffening spring can. Cables and hoses pull the joint back to where they are relaxed. What pushes
it on from there is none of them: the spring of a counterbalance is fitted so, to take over load.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, load_only
from frictioncli.effects.parameter import Parameter

PUSHING = (
    "A spring of {stiffness} pushes the joint on, away from the middle of its stroke, as a"
    " counterbalance may; cables and hoses would pull it back."
)
"""What is said where the torque is certainly none that pulls back."""


def basis(table: EffectTable, *, rest: float, stiffening: float) -> Basis:
    """Return the spring torque per stiffness, shape (rows, 1) [rad].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    rest : float
        Rest angle from the middle of the angles. [deg]
    stiffening : float
        Coefficient of the cubic term. [1/rad²]
    """
    middle = (np.min(table.position) + np.max(table.position)) / 2
    angle = np.radians(table.angle - middle - rest)
    return load_only(angle * (1 + stiffening * np.square(angle)))


EFFECT = Effect(
    name="dress_pack",
    summary="A spring acts on the joint: cables and hoses, a counterbalance or another spring.",
    equation="dL = k*(x + c*x^3), x = q - (middle of the angles) - q0",
    source="Linear spring in parallel to the joint; size is an engineering estimate",
    channel="load",
    shape=(
        Parameter(
            name="rest",
            symbol="q0",
            unit="deg",
            lower=-90.0,
            upper=90.0,
            description="Angle at which the spring is relaxed, from the middle of the range",
            points=5,
        ),
        Parameter(
            name="stiffening",
            symbol="c",
            unit="1/rad^2",
            lower=0.0,
            upper=1.2,
            description="Growth of its stiffness with deflection",
            points=4,
        ),
    ),
    coefficients=(
        Parameter(
            name="stiffness",
            symbol="k",
            unit="torque/rad",
            lower=-15.0,
            upper=15.0,
            description="Stiffness at rest; its sign follows that of the logged torque",
        ),
    ),
    basis=basis,
    needs=("position",),
    uses=("angle",),
    signature=Signature(
        axis="position",
        claim="The load torque is not a pure sine of the angle: it has a linear part.",
    ),
    statement=(
        "A spring of {stiffness} acts on the joint: cables and hoses, a counterbalance or another"
        " spring."
    ),
    confounders=("payload_change", "direction_asymmetry", "inertia"),
    experiment=(
        "Sweep the whole angle range with two payloads: the spring stays, gravity scales."
        " Repeat with the cables loosened: what stays is a counterbalance or another spring."
    ),
    mirror="Friction must not change with the angle, except through the load.",
)
