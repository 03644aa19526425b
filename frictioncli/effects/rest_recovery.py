r"""After a rest friction is higher, until the first moves have displaced the grease again.

.. math:: \Delta\tau = A R\, e^{-n/n_0}, \quad \Delta L = B R\, e^{-n/n_0}, \quad R = 1 - e^{-r/r_0}

with the number *n* of the pair after a rest *r*.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, pairs: float, rest_time: float, at_start: float) -> Basis:
    """Return the remaining excess in friction and, of the first move of a pair, in load. [-].

    The log does not state the rest before the first series of a run: ``at_start`` is the share
    recovered by then. The first move of a pair has more of the excess than the move back, and half
    the difference appears as load.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    pairs : float
        Number of pairs after which 37 % of the excess remain.
    rest_time : float
        Rest in which 63 % of the excess recover. [s]
    at_start : float
        Share recovered before the first series of a run. [-]
    """
    known = np.isfinite(table.rest)
    recovered = np.where(known, -np.expm1(-np.where(known, table.rest, 0.0) / rest_time), at_start)
    excess = recovered * np.exp(-table.order / pairs)
    zeros = np.zeros_like(excess)
    return Basis(np.column_stack([excess, zeros]), np.column_stack([zeros, excess]))


EFFECT = Effect(
    name="rest_recovery",
    summary="The first pairs after a rest have more friction.",
    equation=(
        "dtau = A*R*exp(-n/n0), dL = B*R*exp(-n/n0),"
        " R = 1 - exp(-r/r0) after a rest r, r1 at the start of a run"
    ),
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
            points=6,
        ),
        Parameter(
            name="rest_time",
            symbol="r0",
            unit="s",
            lower=30.0,
            upper=7_200.0,
            description="Rest in which 63 % of the excess recover",
            search="logarithmic",
            points=5,
        ),
        Parameter(
            name="at_start",
            symbol="r1",
            unit="1",
            lower=0.0,
            upper=1.0,
            description="Share recovered before the run's first series",
            points=2,
        ),
    ),
    coefficients=(
        Parameter(
            name="excess",
            symbol="A",
            unit="torque",
            lower=0.0,
            upper=30.0,
            description="Friction above the model in the first pair after a long rest",
        ),
        Parameter(
            name="first_move",
            symbol="B",
            unit="torque",
            lower=-30.0,
            upper=30.0,
            description="Half the excess of the first move over the one back, as load torque",
            of_load=True,
        ),
    ),
    basis=basis,
    needs=("order",),
    uses=("rest",),
    signature=Signature(
        axis="order",
        claim="Friction is above the model in the first pairs after a rest and then settles.",
    ),
    statement="The first pair after a long rest has {excess} more friction.",
    confounders=("stribeck", "velocity_exponent", "run_in"),
    experiment=(
        "Measure the speeds in random order after rests of different, noted length: with one fixed"
        " order the first pair is always the same speed."
    ),
)
