r"""The logged position differs between the two directions of motion.

With play *b* between the encoder and the link, or a step of the encoder's own, the link is at
:math:`q - \sigma b/2` where the log says *q*. To first order

.. math::
    \Delta\tau = -\frac{b}{2} \frac{dL}{dq}, \quad
    \Delta L = -\frac{b}{2} \frac{\partial\tau}{\partial L} \frac{dL}{dq},

at all speeds alike, other than a delay of the torque, which grows with speed.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return the change of both torques per offset of the position, shapes (rows, 1) [N·m/deg]."""
    column = (-table.load_gradient / 2)[:, np.newaxis]
    return Basis(column, column * table.load_slope[:, np.newaxis])


EFFECT = Effect(
    name="backlash",
    summary="The logged position depends on the direction of motion.",
    equation="dtau = -b/2*dL/dq, dL = -b/2*dtau/dL*dL/dq",
    source="Taylor series of gravity over the play between encoder and link",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="play",
            symbol="b",
            unit="deg",
            # robot gears are specified in minutes of arc; a degree is one that is worn out
            lower=-1.0,
            upper=1.0,
            description="Logged position forward less that in reverse, at the same true position",
        ),
    ),
    basis=basis,
    measurement=True,
    needs=("load_gradient",),
    uses=("load_slope",),
    signature=Signature(
        axis="position",
        claim="Friction follows the slope of gravity over the angle, at all speeds alike.",
    ),
    statement="At the same true position logged positions forward and in reverse differ by {play}.",
    confounders=("torque_delay", "load_offset", "position_ripple", "load_linear"),
    experiment=(
        "Approach the same angle from both sides against a dial gauge: what the gauge shows beyond"
        " the log is the play."
    ),
    mirror="The load torque must change by as much as the friction that it causes.",
)
