r"""Speed is not constant near the ends of the stroke, and acceleration costs torque.

Forward, the joint accelerates at the low end (:math:`\ddot q > 0`) and brakes at the high end
(:math:`\ddot q < 0`). In reverse it accelerates at the high end, towards lower angles
(:math:`\ddot q < 0`), and brakes at the low end (:math:`\ddot q > 0`). So :math:`J \ddot q` has the
same sign in both directions at each end: it adds to the load, plus at the low end and minus at the
high end, and cancels in friction. Only if the joint accelerates harder than it brakes does half the
difference remain in friction, with the same sign at both ends. An angle bin of fixed width sees the
gain of kinetic energy in it, which grows with :math:`v^2`.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature
from frictioncli.effects.pairs import stroke_ends


def basis(table: EffectTable, *, distance: float) -> Basis:
    """Return the inertial torque near both ends: equal in both moves, and unequal; 1 at 100 deg/s.

    The first column is zero in friction, the second in load.
    """
    low, high = stroke_ends(table, distance=distance)
    square = np.square(table.speed / 100.0)
    none = np.zeros_like(square)
    return Basis(
        np.column_stack([none, square * (low + high)]),
        np.column_stack([square * (low - high), none]),
    )


EFFECT = Effect(
    name="inertia",
    summary="Acceleration near the ends of the stroke enters the torques.",
    equation=(
        "dL = J*(v/100)^2*(exp(-(q - q_lo)/s) - exp(-(q_hi - q)/s)),"
        " dtau = D*(v/100)^2*(exp(-(q - q_lo)/s) + exp(-(q_hi - q)/s))"
    ),
    source="Inertial term of equation (1) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563",
    channel="load",
    shape=(
        Parameter(
            name="distance",
            symbol="s",
            unit="deg",
            lower=2.0,
            upper=30.0,
            description="Distance from the end at which 37 % remain",
            search="logarithmic",
        ),
    ),
    coefficients=(
        Parameter(
            name="inertial_torque",
            symbol="J",
            unit="torque",
            lower=-20.0,
            upper=20.0,
            description="Inertial torque at the ends at 100 deg/s; signed as the logged torque",
        ),
        Parameter(
            name="unequal_braking",
            symbol="D",
            unit="torque",
            lower=-20.0,
            upper=20.0,
            description="Half of what accelerating takes more than braking, at 100 deg/s",
        ),
    ),
    basis=basis,
    needs=("position", "speed"),
    signature=Signature(
        axis="position",
        claim="Near the ends of the stroke the load torque bends away, more at high speed.",
    ),
    confounders=("reversal_transient", "load_velocity", "dress_pack", "quadratic_drag"),
    experiment=(
        "Cut 30 deg off both ends instead of 10 deg, and repeat with half the acceleration:"
        " inertia goes away, a spring does not."
    ),
    mirror="Friction must stay as it is if the joint brakes as hard as it accelerates.",
)
