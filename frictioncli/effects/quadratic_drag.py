r"""Drag of churned lubricant grows with the square of speed.

.. math:: \Delta\tau = k_d (v/100)^2
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter

REFERENCE_SPEED = 100.0
"""Speed at which the drag is stated. [deg/s]"""


def basis(table: EffectTable) -> Basis:
    """Return the squared speed, 1 at 100 deg/s, shape (rows, 1). [-]."""
    return friction_only(np.square(table.speed / REFERENCE_SPEED))


EFFECT = Effect(
    name="quadratic_drag",
    summary="Churned lubricant adds drag with the square of speed.",
    equation="dtau = kd*(v/100)^2",
    source="Drag of churned lubricant, turbulent limit; size is an engineering estimate",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="drag",
            symbol="kd",
            unit="torque",
            lower=0.0,
            upper=10.0,
            description="Drag at 100 deg/s",
        ),
    ),
    basis=basis,
    needs=("speed",),
    signature=Signature(
        axis="speed",
        claim="Friction is above the model only at the fastest speeds.",
    ),
    statement="Drag grows with the square of speed, to {drag} at 100 deg/s.",
    confounders=("linear_viscous", "velocity_exponent", "inertia"),
    experiment="Measure at three or more speeds above 150 deg/s, away from the ends of the stroke.",
)
