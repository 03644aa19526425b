r"""Near the ends of the stroke the speed is not constant, and inertia adds to the torque.

Forward, the joint accelerates at the low end (:math:`\ddot q > 0`) and brakes at the high end
(:math:`\ddot q < 0`). In reverse it accelerates at the high end, towards lower angles
(:math:`\ddot q < 0`), and brakes at the low end (:math:`\ddot q > 0`). So :math:`J \ddot q` has the
same sign in both directions at each end: it adds to the load, plus at the low end and minus at the
high end, and cancels in friction. Only if the joint accelerates harder than it brakes does half the
difference remain in friction, with the same sign at both ends.

The distance from the end over which the speed still changes depends on the cause. A ramp cut off at
a fixed angle leaves the same distance at all speeds, and a torque that grows with :math:`v^2`. A
speed controller settles in a fixed time :math:`\theta`: the distance is :math:`v \theta`, and the
torque grows with :math:`v`. The shape parameter ``growth`` is 0 in the first case, 1 in the second.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.pair_series import stroke_ends
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, distance: float, growth: float) -> Basis:
    """Return the inertial torque near both ends, relative to that at 100 deg/s.

    The first column, of equal acceleration and braking, is zero in friction; the second, of half
    their difference, is zero in load.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float
        Distance from the end at which 37 % remain at 100 deg/s. [deg]
    growth : float
        Power of speed with which the distance grows. [-]
    """
    speed = table.speed / 100.0
    low, high = stroke_ends(table, distance=distance * speed**growth)
    torque = speed ** (2.0 - growth)
    zeros = np.zeros_like(torque)
    return Basis(
        np.column_stack([zeros, torque * (low + high)]),
        np.column_stack([torque * (low - high), zeros]),
    )


EFFECT = Effect(
    name="inertia",
    summary="Acceleration near the ends of the stroke enters the torques.",
    equation=(
        "dL = J*(v/100)^(2-g)*(exp(-(q - q_lo)/s) - exp(-(q_hi - q)/s)),"
        " dtau = D*(v/100)^(2-g)*(exp(-(q - q_lo)/s) + exp(-(q_hi - q)/s)), s = s100*(v/100)^g"
    ),
    source="Inertial term of equation (1) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563",
    channel="load",
    shape=(
        Parameter(
            name="distance",
            symbol="s100",
            unit="deg",
            lower=2.0,
            upper=60.0,
            description="Distance from the end at which 37 % remain at 100 deg/s",
            search="logarithmic",
        ),
        Parameter(
            name="growth",
            symbol="g",
            unit="1",
            lower=0.0,
            upper=1.0,
            description="Power of speed with which the distance grows",
            points=3,
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
            description="Half the difference between accelerating and braking torque, at 100 deg/s",
            within="inertial_torque",
        ),
    ),
    basis=basis,
    needs=("position", "speed"),
    signature=Signature(
        axis="position",
        claim="Near the ends of the stroke the load torque departs from gravity, more at high"
        " speed.",
    ),
    statement="Acceleration adds {inertial_torque} at the ends of the stroke at 100 deg/s.",
    confounders=("reversal_transient", "load_velocity", "dress_pack", "quadratic_drag"),
    experiment=(
        "Cut 30 deg off both ends instead of 10 deg, and repeat with half the acceleration:"
        " an effect of inertia disappears, that of a spring does not."
    ),
    mirror="Friction must not change if the joint brakes as hard as it accelerates.",
)
