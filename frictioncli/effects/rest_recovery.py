r"""After a rest friction is higher, until enough moves have displaced the grease again.

.. math:: \Delta\tau = A x, \quad \Delta L = B x

The excess *x*, between 0 and 1, decays with every pair that the joint moves and recovers at rest:

.. math::
    x \to x\, e^{-1/n_0} \text{ in a pair}, \quad
    x \to 1 - (1 - x)\, e^{-r/r_0} \text{ in a rest } r .

It is the structure parameter of a thixotropic grease [1]_, broken down by strokes instead of time.

References
----------
.. [1] J. Mewis and N. J. Wagner, "Thixotropy," Adv. Colloid Interface Sci. 147-148, 2009,
   doi:10.1016/j.cis.2008.09.005.
"""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.pair_series import linear_recursion, pair_heads, starts
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, pairs: float, rest_time: float, at_start: float) -> Basis:
    """Return the remaining excess in friction and, of the first move of a pair, in load. [-].

    The log does not state the rest before the first series of a run: ``at_start`` is the excess
    there. Unrecorded motion counts as well, as far as the motor warmed in it. The first move of a
    pair has more of the excess than the move back, and half the difference appears as load.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    pairs : float
        Number of pairs after which 37 % of the excess remain.
    rest_time : float
        Rest in which 63 % of the excess recover. [s]
    at_start : float
        Excess in the first pair of a run. [-]
    """
    heads = pair_heads(table)
    first = heads.first
    rest = np.where(table.order[first] == 0, table.rest[first], 0.0)
    kept = np.exp(-np.where(np.isfinite(rest), rest, 0.0) / rest_time)
    decay = np.exp(-_pairs_moved(table.travel[first]) / pairs) * kept[1:]
    excess = heads.spread(
        linear_recursion(
            decay=decay, gain=1 - kept[1:], restart=starts(table.run[first]), first=at_start
        )
    )
    zeros = np.zeros_like(excess)
    return Basis(np.column_stack([excess, zeros]), np.column_stack([zeros, excess]))


def _pairs_moved(travel: Array) -> Array:
    """Return the motion from each pair to the next, relative to that of a usual pair."""
    moved = np.maximum(np.diff(travel), 0.0)
    usual = float(np.median(moved[moved > 0])) if np.any(moved > 0) else 1.0
    return moved / usual


EFFECT = Effect(
    name="rest_recovery",
    summary="The first pairs after a rest have more friction.",
    equation=(
        "dtau = A*x, dL = B*x; x -> x*exp(-1/n0) in a pair, 1 - (1 - x)*exp(-r/r0) in a rest r;"
        " x = r1 at the start of a run"
    ),
    source="Structure parameter of thixotropic grease: Mewis & Wagner 2009,"
    " doi:10.1016/j.cis.2008.09.005; size is an engineering estimate",
    channel="friction",
    shape=(
        Parameter(
            name="pairs",
            symbol="n0",
            unit="pairs",
            lower=0.5,
            upper=500.0,
            description="Number of pairs after which 37 % of the excess remain",
            search="logarithmic",
            points=8,
        ),
        Parameter(
            name="rest_time",
            symbol="r0",
            unit="s",
            lower=30.0,
            upper=86_400.0,
            description="Rest in which 63 % of the excess recover",
            search="logarithmic",
            points=6,
        ),
        Parameter(
            name="at_start",
            symbol="r1",
            unit="1",
            lower=0.0,
            upper=1.0,
            description="Excess in the first pair of a run, relative to that after a long rest",
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
    needs=("travel", "order"),
    uses=("rest",),
    recurs=True,
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
