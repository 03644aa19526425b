r"""A part of viscous friction is proportional to speed and independent of temperature.

.. math:: \Delta\tau = k_v v
"""

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable) -> Basis:
    """Return the speed, shape (rows, 1) [deg/s]."""
    return friction_only(table.speed)


EFFECT = Effect(
    name="linear_viscous",
    summary="Friction has a part proportional to speed.",
    equation="dtau = kv*v",
    source="Equation (5) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563",
    channel="friction",
    shape=(),
    coefficients=(
        Parameter(
            name="viscous_coefficient",
            symbol="kv",
            unit="torque/(deg/s)",
            lower=0.0,
            upper=0.2,
            description="Friction per speed, in addition to the square-root term",
        ),
    ),
    basis=basis,
    needs=("speed",),
    signature=Signature(
        axis="speed",
        claim="Friction curves upward with speed, equally when cold and when hot.",
    ),
    statement="Friction has a part proportional to speed, of {viscous_coefficient}.",
    confounders=("quadratic_drag", "velocity_exponent", "stribeck"),
    experiment=(
        "Measure at ten or more speeds up to the fastest, at two temperatures held constant,"
        " with three or more speeds in the upper half."
    ),
)
