r"""The zero of the logged position is another for a while: mastered anew, or the base tilted.

.. math:: \Delta L = -d \frac{dL}{dq}, \quad \Delta\tau = 2 \alpha L\, \Delta L

while it is there, with the fitted gravity *L*: gravity turns and keeps its amplitude. A mass that
is mounted across the direction of the arm adds the same torque.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.history import SHAPE, presence
from frictioncli.effects.history_search import histories
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, **shape: float) -> Basis:
    """Return minus the slope of gravity while the offset is there, shape (rows, 1) [N·m/deg].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    **shape : float
        Its history: ``moment`` and ``end``, and further stretches.
    """
    load = (-presence(table, shape) * table.load_gradient)[:, np.newaxis]
    return Basis(table.load_slope[:, np.newaxis] * load, load)


EFFECT = Effect(
    name="position_offset",
    summary="The zero of the logged position changed, or the base was tilted.",
    equation="dL = -d*dL/dq*(1 from m to e, else 0), dtau = 2*alpha*L*dL",
    source="First order of gravity at an angle that is off by d",
    channel="load",
    shape=SHAPE,
    coefficients=(
        Parameter(
            name="offset",
            symbol="d",
            unit="deg",
            lower=-20.0,
            upper=20.0,
            description="Logged position less the true one while it is there",
        ),
    ),
    basis=basis,
    moments=histories,
    needs=("clock", "load_gradient"),
    uses=("load_slope",),
    signature=Signature(
        axis="clock",
        claim="For a while the load torque over the angle is shifted along the angle.",
    ),
    statement=(
        "Gravity turned by {offset} against the logged position: the joint was mastered anew, or"
        " the base was tilted."
    ),
    confounders=("payload_change",),
    experiment=(
        "Ask whether the joint was mastered, its motor or encoder replaced, or the robot moved at"
        " that moment; move to the mastering mark and read the position, and measure the base with"
        " a spirit level: a payload changes neither."
    ),
    mirror="The load torque must keep its amplitude, and other joints turn alike if the base did.",
)
