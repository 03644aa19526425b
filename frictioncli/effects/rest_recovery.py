"""After a rest grease has flowed back, and the first moves push it away again."""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, friction_only


def basis(table: EffectTable, *, pairs: float, rest_time: float) -> Basis:
    """Return the recovered friction that is left; an unknown rest counts as a long one."""
    recovered = -np.expm1(-np.nan_to_num(table.rest, nan=np.inf, posinf=np.inf) / rest_time)
    return friction_only(recovered * np.exp(-table.order / pairs))


EFFECT = Effect(
    name="rest_recovery",
    summary="The first pairs after a rest have more friction.",
    equation="dtau = A*(1 - exp(-r/r0))*exp(-n/n0)",
    source="Redistribution of grease at rest; size is an engineering estimate",
    channel="friction",
    shape=(
        Parameter(
            name="pairs",
            symbol="n0",
            unit="pairs",
            lower=0.5,
            upper=20.0,
            description="Number of pairs after which 37 % of the excess remain",
            search="logarithmic",
        ),
        Parameter(
            name="rest_time",
            symbol="r0",
            unit="s",
            lower=30.0,
            upper=7_200.0,
            description="Rest in which 63 % of the excess recover",
            search="logarithmic",
            points=6,
        ),
    ),
    coefficients=(
        Parameter(
            name="excess",
            symbol="A",
            unit="torque",
            lower=0.0,
            upper=10.0,
            description="Friction above the model in the first pair after a long rest",
        ),
    ),
    basis=basis,
    needs=("order",),
    uses=("rest",),
    signature=Signature(
        axis="order",
        claim="Friction is above the model in the first pairs after a rest and settles with them.",
    ),
    confounders=("stribeck", "velocity_exponent", "run_in"),
    experiment=(
        "Measure the speeds in random order after rests of different, noted length: with one fixed"
        " order the first pair is always the same speed."
    ),
)
