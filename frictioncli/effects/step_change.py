r"""Friction is another for a while: a repair, new grease, damage, or what is done every day.

.. math:: \Delta\tau = d \quad \text{while it is there}

When it is there tells its history (:mod:`frictioncli.effects.history`): from a moment on, between
two moments, or in a part of every run.
"""

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.history import SHAPE, presence
from frictioncli.effects.history_search import histories
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, **shape: float) -> Basis:
    """Return 1 while the change is there and 0 elsewhere, shape (rows, 1). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    **shape : float
        Its history: ``moment`` and ``end``, and further stretches.
    """
    return friction_only(presence(table, shape))


EFFECT = Effect(
    name="step_change",
    summary="Friction stepped to another level, permanently or temporarily.",
    equation="dtau = d*(1 from m to e, else 0)",
    source="Step at an unknown moment, as in change-point detection",
    channel="friction",
    shape=SHAPE,
    coefficients=(
        Parameter(
            name="change",
            symbol="d",
            unit="torque",
            lower=-20.0,
            upper=20.0,
            description="Friction during the step minus friction at other times",
        ),
    ),
    basis=basis,
    moments=histories,
    needs=("clock",),
    signature=Signature(
        axis="clock",
        claim="Residuals jump from one level to another, and keep each level between two jumps.",
    ),
    confounders=("drift", "run_in", "payload_change"),
    experiment=(
        "Repeat a short sweep every day at the same temperature: a step leaves two levels,"
        " a drift none. Ask what was done to the joint at that moment."
    ),
    mirror="If the load torque jumps at the same moment, it is a change of payload.",
    statement="Friction stepped by {change}.",
)
