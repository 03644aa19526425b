r"""The payload is another for a while: put on, taken off, or both, perhaps every day.

.. math:: \Delta L = P_c \cos q + P_s \sin q, \quad \Delta\tau = 2 \alpha L\, \Delta L

while it is there; when that is, tells its history (:mod:`frictioncli.effects.history`). The gravity
term has any phase, since the new mass may sit at any angle.
Friction changes with the load as the term :math:`\alpha L^2` of the base model, to first order.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.history import SHAPE, presence
from frictioncli.effects.history_search import histories
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, **shape: float) -> Basis:
    """Return cosine and sine of the angle while the payload is there, shape (rows, 2). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    **shape : float
        Its history: ``moment`` and ``end``, and further stretches.
    """
    there = presence(table, shape)
    angle = np.radians(table.angle)
    load = np.column_stack([there * np.cos(angle), there * np.sin(angle)])
    return Basis(table.load_slope[:, np.newaxis] * load, load)


EFFECT = Effect(
    name="payload_change",
    summary="The payload changed, permanently or temporarily.",
    equation="dL = (Pc*cos(q) + Ps*sin(q))*(1 from m to e, else 0), dtau = 2*alpha*L*dL",
    source="Gravity torque of a point mass; equation (3) of Nevmerzhitskiy et al. 2019, "
    "doi:10.1155/2019/6931563",
    channel="load",
    shape=SHAPE,
    coefficients=(
        Parameter(
            name="cosine",
            symbol="Pc",
            unit="torque",
            lower=-100.0,
            upper=100.0,
            description="Change of the gravity torque at 0 deg while it is there",
        ),
        Parameter(
            name="sine",
            symbol="Ps",
            unit="torque",
            lower=-100.0,
            upper=100.0,
            description="Change of the gravity torque at 90 deg while it is there",
        ),
    ),
    basis=basis,
    moments=histories,
    needs=("clock", "angle"),
    uses=("load_slope",),
    signature=Signature(
        axis="clock",
        claim="For a while the amplitude of the load torque over the angle is different.",
    ),
    confounders=("torque_constant", "dress_pack", "step_change"),
    experiment=(
        "Weigh the payload, see whether a joint that is not logged stands elsewhere, and repeat one"
        " slow sweep at the temperature of the first run: a changed mass stays, an effect of the"
        " torque constant changes with temperature."
    ),
    mirror="Friction must change only by what the base model gives for the new load.",
    statement=(
        "The payload changed the gravity torque by {cosine} at 0 deg and by {sine} at 90 deg."
    ),
)
