r"""The logged torque belongs to an earlier moment than the logged position.

At constant velocity :math:`\sigma v` the torque that a log of delay *d* shows at the angle *q* is
that of :math:`q - \sigma v d`. With torque :math:`u = \sigma \tau(L) + L(q)`, to first order

.. math::
    \Delta\tau = -d\, v\, \frac{dL}{dq}, \quad
    \Delta L = -d\, v\, \frac{\partial\tau}{\partial L} \frac{dL}{dq} .

A filter of the torque delays it as well, by its time constant: what is estimated is the whole
delay, and :mod:`frictioncli.effects.torque_filter` measures by how much it is more than a shift.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.parameter import Parameter

BESIDE_A_FILTER = (
    "The torque in these logs lags the position by {delay} and is smoothed by a filter with a"
    " time constant of"
    " {time_constant}."
)
"""What is said of a delay where the torque is filtered as well."""


def basis(table: EffectTable) -> Basis:
    """Return the change of both torques per delay, shapes (rows, 1) [N·m/s]."""
    column = (-table.speed * table.load_gradient)[:, np.newaxis]
    return Basis(column, column * table.load_slope[:, np.newaxis])


EFFECT = Effect(
    name="torque_delay",
    summary="The torque is logged later than the position.",
    equation="dtau = -d*v*dL/dq, dL = -d*v*dtau/dL*dL/dq",
    source="Taylor series of gravity over the angle travelled in the delay",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="delay",
            symbol="d",
            unit="s",
            # a filter of up to 0.2 s and a bus that is late by 0.1 s; or positions late by that
            lower=-0.1,
            upper=0.3,
            description="Delay of the logged torque against the logged position",
        ),
    ),
    basis=basis,
    measurement=True,
    needs=("speed", "load_gradient"),
    uses=("load_slope",),
    signature=Signature(
        axis="position",
        claim=(
            "Friction seems to grow with speed where gravity falls along the angle, and to fall"
            " where gravity grows."
        ),
    ),
    statement="The torque in these logs lags the position by {delay}.",
    confounders=("torque_filter", "backlash", "load_velocity", "position_ripple"),
    experiment=(
        "Reverse the motion where gravity is small, at high acceleration: the step of friction"
        " appears in the torque later than in the velocity, by the delay."
    ),
    mirror="The load torque must change by as much as the friction that it causes.",
)
