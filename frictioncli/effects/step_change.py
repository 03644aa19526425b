r"""Friction changes once, at an unknown moment: a repair, new grease, damage.

.. math:: \Delta\tau = d \quad \text{from the moment on}

The moment is the share of all pairs measured before the change, in order of time: a moment within a
run is then resolved as well as one between two runs, however long the joint rested in between.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, friction_only
from frictioncli.effects.pair_series import measured_share, series_starts


def basis(table: EffectTable, *, moment: float) -> Basis:
    """Return 1 from the moment on, 0 before, shape (rows, 1). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    moment : float
        Share of all pairs measured before the change. [-]
    """
    return friction_only(np.where(measured_share(table) >= moment, 1.0, 0.0))


EFFECT = Effect(
    name="step_change",
    summary="Friction changed once and stayed.",
    equation="dtau = d*(1 from m on, 0 before)",
    source="Step at an unknown moment, as in change-point detection",
    channel="friction",
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
            name="change",
            symbol="d",
            unit="torque",
            lower=-20.0,
            upper=20.0,
            description="Friction after less friction before",
        ),
    ),
    basis=basis,
    moments=series_starts,
    needs=("clock",),
    signature=Signature(
        axis="clock",
        claim="Residuals jump at one moment and keep their level before and after.",
    ),
    confounders=("drift", "run_in", "payload_change"),
    experiment=(
        "Repeat a short sweep every day at the same temperature: a step leaves two levels,"
        " a drift none. Ask what was done to the joint at that moment."
    ),
    mirror="If the load torque jumps at the same moment, it is a change of payload.",
)
