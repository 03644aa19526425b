r"""The load-dependent part of friction changes with speed.

.. math:: \Delta\tau = a_v (L/10)^2 \sqrt{v/100}
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return squared load times root of speed, shape (rows, 1); 1 at load 10 and 100 deg/s. [-]."""
    return friction_only(np.square(table.load / 10.0) * np.sqrt(table.speed / 100.0))


EFFECT = Effect(
    name="load_velocity",
    summary="The load-dependent part of friction differs from speed to speed.",
    equation="dtau = av*(L/10)^2*sqrt(v/100)",
    source=(
        "Product of the load and speed terms of equation (16) of Nevmerzhitskiy et al. 2019,"
        " doi:10.1155/2019/6931563"
    ),
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="load_speed_coefficient",
            symbol="av",
            unit="torque",
            lower=-0.5,
            upper=0.5,
            description="Added friction at load torque 10 and 100 deg/s",
            of_square_load=True,
        ),
    ),
    basis=basis,
    needs=("load", "speed"),
    signature=Signature(
        axis="load",
        claim="The parabola of friction over load opens differently at each speed.",
    ),
    statement=(
        "The load-dependent part of friction grows with speed, by {load_speed_coefficient} at"
        " load torque 10 and 100 deg/s."
    ),
    confounders=("inertia", "load_linear", "quadratic_drag"),
    experiment="Measure every speed with every one of two or more payloads at one temperature.",
)
