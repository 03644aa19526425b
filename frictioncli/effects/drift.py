"""Friction changes steadily with time: wear, ageing grease, a drifting sensor."""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, friction_only


def basis(table: EffectTable) -> Basis:
    """Return the time since the first pair of all runs, in hours."""
    return friction_only((table.clock - np.min(table.clock)) / 3600.0)


EFFECT = Effect(
    name="drift",
    summary="Friction changes steadily with time over all runs.",
    equation="dtau = kw*(t - t0)/3600",
    source="Linear wear or ageing term; size is an engineering estimate",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="rate",
            symbol="kw",
            unit="torque/h",
            lower=-2.0,
            upper=2.0,
            description="Change of friction per hour",
        ),
    ),
    basis=basis,
    needs=("clock",),
    signature=Signature(
        axis="clock",
        claim=(
            "Residuals rise or fall steadily with time at equal temperature,"
            " and the change is still there on the next cold start."
        ),
    ),
    confounders=("run_in", "step_change", "thermal_lag"),
    experiment=(
        "Return to the start temperature and repeat the first pairs; repeat them on the next day."
        " One run alone cannot tell a drift from slow noise."
    ),
)
