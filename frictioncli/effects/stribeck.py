"""Friction rises towards standstill: the lubricant film is not yet complete."""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, friction_only


def basis(table: EffectTable, *, velocity: float, exponent: float) -> Basis:
    """Return the share of full boundary friction at each speed."""
    return friction_only(np.exp(-((table.speed / velocity) ** exponent)))


EFFECT = Effect(
    name="stribeck",
    summary="Boundary friction adds to the friction at low speed.",
    equation="dtau = ts*exp(-(v/vs)^k)",
    source=(
        "Equation (6) of Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563; form after"
        " Armstrong-Hélouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="velocity",
            symbol="vs",
            unit="deg/s",
            lower=1.0,
            upper=20.0,
            description="Speed at which boundary friction has fallen to 37 %",
            search="logarithmic",
        ),
        Parameter(
            name="exponent",
            symbol="k",
            unit="1",
            lower=0.5,
            upper=2.5,
            description="How abruptly it falls",
            points=5,
        ),
    ),
    coefficients=(
        Parameter(
            name="boundary_torque",
            symbol="ts",
            unit="torque",
            lower=0.0,
            upper=20.0,
            description="Boundary friction at standstill, above the Coulomb friction",
        ),
    ),
    basis=basis,
    needs=("speed",),
    signature=Signature(
        axis="speed",
        claim="Friction is above the model only at the lowest speeds, and the more the slower.",
    ),
    confounders=("rest_recovery", "linear_viscous", "velocity_exponent"),
    experiment=(
        "Measure at six or more speeds below 20 deg/s, in random order, so that slow moves are not"
        " always the first after a rest."
    ),
)
