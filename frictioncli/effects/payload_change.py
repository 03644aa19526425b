r"""The payload changes at an unknown moment.

.. math:: \Delta L = P_c \cos q + P_s \sin q, \quad \Delta\tau = 2 \alpha L\, \Delta L

from the moment on. The gravity term has any phase, since the new mass may sit at any angle.
Friction changes with the load as the term :math:`\alpha L^2` of the base model, to first order. The
moment is defined as in :mod:`frictioncli.effects.step_change`.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature
from frictioncli.effects.pair_series import measured_share, series_starts


def basis(table: EffectTable, *, moment: float) -> Basis:
    """Return cosine and sine of the angle from the moment on, 0 before, shape (rows, 2). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    moment : float
        Share of all pairs measured before the change. [-]
    """
    after = np.where(measured_share(table) >= moment, 1.0, 0.0)
    angle = np.radians(table.position)
    load = np.column_stack([after * np.cos(angle), after * np.sin(angle)])
    return Basis(table.load_slope[:, np.newaxis] * load, load)


EFFECT = Effect(
    name="payload_change",
    summary="The payload changed at one moment.",
    equation="dL = (Pc*cos(q) + Ps*sin(q))*(1 from m on, 0 before), dtau = 2*alpha*L*dL",
    source="Gravity torque of a point mass; equation (3) of Nevmerzhitskiy et al. 2019, "
    "doi:10.1155/2019/6931563",
    channel="load",
    shape=(
        Parameter(
            name="moment",
            symbol="m",
            unit="share of pairs",
            lower=0.0,
            upper=1.0,
            description="Share of all pairs measured before the change",
        ),
    ),
    coefficients=(
        Parameter(
            name="cosine",
            symbol="Pc",
            unit="torque",
            lower=-100.0,
            upper=100.0,
            description="Change of the gravity torque at 0 deg",
        ),
        Parameter(
            name="sine",
            symbol="Ps",
            unit="torque",
            lower=-100.0,
            upper=100.0,
            description="Change of the gravity torque at 90 deg",
        ),
    ),
    basis=basis,
    moments=series_starts,
    needs=("clock", "position"),
    uses=("load_slope",),
    signature=Signature(
        axis="clock",
        claim="From one moment on the load torque has another amplitude over the angle.",
    ),
    confounders=("torque_constant", "dress_pack", "step_change"),
    experiment=(
        "Weigh the payload and repeat one slow sweep at the temperature of the first run:"
        " a changed mass stays, a changed torque constant goes with the heat."
    ),
    mirror="Friction must change only by what the base model gives for the new load.",
)
