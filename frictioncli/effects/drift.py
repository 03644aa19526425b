r"""Friction changes steadily with time: wear, ageing grease, a drifting sensor.

.. math:: \Delta\tau = k_w\, t_h \left(1 - e^{-(t - t_0)/t_h}\right)
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, time_constant: float) -> Basis:
    """Return the time since the first pair of all runs, saturating, shape (rows, 1) [h].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    time_constant : float
        Time constant of the saturation. [h]
    """
    hours = (table.clock - np.min(table.clock)) / 3600.0
    return friction_only(-time_constant * np.expm1(-hours / time_constant))


EFFECT = Effect(
    name="drift",
    summary="Friction changes steadily with time over all runs.",
    equation="dtau = kw*th*(1 - exp(-(t - t0)/th))",
    source="Linear wear or ageing term; size is an engineering estimate",
    channel="friction",
    shape=(
        Parameter(
            name="time_constant",
            symbol="th",
            unit="h",
            lower=0.5,
            upper=200.0,
            description="Time after which 37 % of the first rate remain; long where it is steady",
            search="logarithmic",
            points=6,
        ),
    ),
    coefficients=(
        Parameter(
            name="rate",
            symbol="kw",
            unit="torque/h",
            lower=-2.0,
            upper=2.0,
            description="Change of friction per hour at the start",
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
    statement="Friction changes steadily with the time logged, by {rate} at the start.",
    confounders=("run_in", "step_change", "thermal_lag"),
    experiment=(
        "Return to the start temperature and repeat the first pairs; repeat them on the next day:"
        " slow noise of one run does not go on."
    ),
)
