r"""The scale of the logged torque is another for a while: a motor, drive or calibration replaced.

.. math:: \Delta L = k L, \quad \Delta\tau = k \tau

while it is there: load and friction change by the same share at the same moment, as all torque does
that is worked out from a current. The load alone does not tell that from a mass where the arm is
heavy already.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.history import SHAPE, presence
from frictioncli.effects.history_search import histories
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, **shape: float) -> Basis:
    """Return a hundredth of both torques while the change is there, shape (rows, 1) [N·m].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    **shape : float
        Its history: ``moment`` and ``end``, and further stretches.
    """
    there = presence(table, shape) / 100.0
    return Basis((there * table.friction)[:, np.newaxis], (there * table.load)[:, np.newaxis])


EFFECT = Effect(
    name="torque_scale",
    summary="The scale of the logged torque changed, permanently or temporarily.",
    equation="dL = k/100*L*(1 from m to e, else 0), dtau = k/100*tau*(1 from m to e, else 0)",
    source="Torque is current times gear ratio and torque constant of the motor that is installed",
    channel="load",
    shape=SHAPE,
    coefficients=(
        Parameter(
            name="percent",
            symbol="k",
            unit="%",
            lower=-60.0,
            upper=60.0,
            description="Change of the logged torque while it is there",
        ),
    ),
    basis=basis,
    moments=histories,
    needs=("clock",),
    uses=("friction", "load"),
    signature=Signature(
        axis="clock",
        claim="For a while load torque and friction are greater or smaller by the same share.",
    ),
    statement="The logged torque changed by {percent}, load and friction alike.",
    confounders=("payload_change", "step_change", "torque_constant"),
    experiment=(
        "Ask whether motor, drive or calibration was changed at that moment; weigh the payload, or"
        " repeat one sweep where the load is zero: a payload leaves its friction as it was."
    ),
    mirror="Friction and load torque must change by the same percentage at the same moment.",
)
