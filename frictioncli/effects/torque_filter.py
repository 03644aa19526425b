r"""The logged torque has passed a low-pass filter.

A filter of first order, time constant :math:`\theta`, gives at constant velocity

.. math:: u - \theta \dot u + \theta^2 \ddot u - \theta^3 \dddot u + \dots

The first term is that of a delay :math:`\theta`, and stands in
:mod:`frictioncli.effects.torque_delay`. Here are the second and the third,

.. math::
    \Delta L = s_2\, v^2 \frac{d^2 L}{dq^2}, \quad
    \Delta\tau = s_2\, v^2 \frac{d^2 \tau}{dq^2} - s_3\, v^3 \frac{d^3 L}{dq^3},

where a filter behind a delay *d* has
:math:`s_2 = \theta^2 + \theta d + d^2/2` and a delay alone has half the square of the whole delay
*D*: the time constant is :math:`\theta = (2 s_2 - D^2)^{1/2}`. Gravity is a sine of the angle, so
that its third derivative is known from the first. The ratio :math:`s_3 / s_2` is a third of a delay
and the whole of a time constant. It is no parameter of its own: over a stroke on which gravity
grows all the way the third term is friction that grows with the cube of speed, and a free
coefficient would take it from any drag.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.parameter import Parameter

BY_TIME_CONSTANT = (
    "The torque in these logs is smoothed by a filter with a time constant of {time_constant}."
)
"""What is said of a filter whose time constant is known."""

_RADIANS = np.pi / 180

_RATIO = 0.03
"""Third moment relative to the second, of a filter of 30 ms. [s]"""


def basis(table: EffectTable) -> Basis:
    """Return the second term of both torques, with the third of friction, shape (rows, 1) [N·m/s²].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    """
    squared = np.square(table.speed)
    square = float(np.sum(np.square(table.load)))
    # friction is alpha*L^2 of the load: 2*alpha is the derivative of its slope
    twice_alpha = float(table.load_slope @ table.load) / square if square > 0 else 0.0
    bend = twice_alpha * np.square(table.load_gradient) + table.load_slope * table.load_curvature
    third = table.speed**3 * table.load_gradient * _RADIANS**2
    friction, load = squared * bend + _RATIO * third, squared * table.load_curvature
    return Basis(friction[:, np.newaxis], load[:, np.newaxis])


EFFECT = Effect(
    name="torque_filter",
    summary="The logged torque is smoothed by a filter.",
    equation="dL = s2*v^2*d2L/dq2, dtau = s2*v^2*d2tau/dq2 - 0.03*s2*v^3*d3L/dq3",
    source="Moments of the impulse response of a first-order filter after a delay",
    channel="load",
    shape=(),
    coefficients=(
        Parameter(
            name="second_moment",
            symbol="s2",
            unit="s²",
            lower=0.0,
            upper=0.1,
            description=(
                "Half the second moment of the filter's response in time: the square of the time"
                " constant for a filter alone, half the square of the delay for a delay alone"
            ),
        ),
    ),
    basis=basis,
    measurement=True,
    needs=("speed", "load_curvature"),
    uses=("load_gradient", "load_slope", "load"),
    signature=Signature(
        axis="position",
        claim="The amplitude of the load torque over the angle falls with the square of speed.",
    ),
    statement=(
        "The torque in these logs is smoothed by a filter, whose response has a second"
        " moment of {second_moment}."
    ),
    confounders=("torque_delay", "torque_constant", "direction_asymmetry", "inertia"),
    experiment=(
        "Reverse the motion at high acceleration and look at single samples of the torque: a delay"
        " shifts the step of friction, a filter smooths it."
    ),
    mirror="Friction must show a torque_delay of the filter's time constant or more.",
)
