r"""Stribeck effect: boundary friction rises towards standstill.

.. math:: \Delta\tau = t_s \exp\!\left[-(v/v_s)^k\right], \quad v_s = v_{s,40}\, e^{c (T - 40)}
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter

_REFERENCE = 40.0
"""Temperature at which the Stribeck velocity is stated. [°C]"""

EXTRAPOLATED = (
    "Boundary friction falls to 37 % at {velocity}, below the slowest move; extrapolated to"
    " standstill, it is {boundary_torque}."
)
"""What is said where boundary friction has largely vanished at all speeds measured."""


def basis(table: EffectTable, *, velocity: float, exponent: float, shift: float) -> Basis:
    """Return the share of the full boundary friction, shape (rows, 1). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    velocity : float
        Stribeck velocity at 40 °C. [deg/s]
    exponent : float
        Exponent k. [-]
    shift : float
        Growth of the Stribeck velocity with temperature. [1/°C]
    """
    stribeck_velocity = velocity * np.exp(shift * (table.temperature - _REFERENCE))
    return friction_only(np.exp(-((table.speed / stribeck_velocity) ** exponent)))


EFFECT = Effect(
    name="stribeck",
    summary="Boundary friction adds to the friction at low speed.",
    equation="dtau = ts*exp(-(v/vs)^k), vs = vs40*exp(c*(T - 40))",
    source=(
        "Equation (6) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563; form after"
        " Armstrong-Hélouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="velocity",
            symbol="vs40",
            unit="deg/s",
            lower=1.0,
            upper=20.0,
            description="Speed at which boundary friction has fallen to 37 %, at 40 °C",
            search="logarithmic",
            points=8,
        ),
        Parameter(
            name="exponent",
            symbol="k",
            unit="1",
            lower=0.7,
            upper=2.5,
            description="How abruptly it falls",
            points=4,
        ),
        Parameter(
            name="shift",
            symbol="c",
            unit="1/°C",
            lower=0.0,
            upper=0.03,
            description="Growth of the Stribeck velocity with temperature, as grease thins",
            points=2,
        ),
    ),
    coefficients=(
        Parameter(
            name="boundary_torque",
            symbol="ts",
            unit="torque",
            lower=0.0,
            upper=120.0,
            description="Boundary friction at standstill, above the Coulomb friction",
        ),
    ),
    basis=basis,
    needs=("speed",),
    uses=("temperature",),
    signature=Signature(
        axis="speed",
        claim="Friction is above the model only at the lowest speeds, more so at slower ones.",
    ),
    statement=(
        "Boundary friction is {boundary_torque} at standstill and falls to 37 % of that at"
        " {velocity}."
    ),
    confounders=("rest_recovery", "linear_viscous", "velocity_exponent"),
    experiment=(
        "Measure at six or more speeds below 20 deg/s, in random order, so that slow moves are not"
        " always the first after a rest."
    ),
)
