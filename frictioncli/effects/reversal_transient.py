r"""After a reversal the contacts have to be bent over before full friction acts.

Friction builds up over some angle from the reversal, :math:`f = f_\infty - b\,e^{-|q - q_r|/s}`.
Forward moves reverse at the low end, reverse moves at the high end. In friction both lacks add,
:math:`-b (e_{lo} + e_{hi})/2`; in load they subtract, :math:`\mp b (e_{lo} - e_{hi})/2`, where the
sign is that with which the log counts friction. It is not known here, so both are tried, as the
shape ``side``. Unlike inertia it does not grow with speed, and it starts where the joint turns, the
same angle for slow and fast moves.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature
from frictioncli.effects.pair_series import turning_points


def basis(table: EffectTable, *, distance: float, side: float) -> Basis:
    """Return the friction that is lacking after the turn, in friction and in load."""
    low, high = turning_points(table, distance=distance)
    sign = 1.0 if side > 0 else -1.0
    return Basis(
        (-(low + high) / 2)[:, np.newaxis],
        (-sign * (low - high) / 2)[:, np.newaxis],
    )


EFFECT = Effect(
    name="reversal_transient",
    summary="Friction is not yet built up just after a reversal.",
    equation=(
        "dtau = -b*(exp(-(q - q_lo)/s) + exp(-(q_hi - q)/s))/2,"
        " dL = -z*b*(exp(-(q - q_lo)/s) - exp(-(q_hi - q)/s))/2, z = +1 or -1"
    ),
    source=(
        "Presliding, first-order build-up after Dahl; survey: Armstrong-Hélouvry et al. 1994,"
        " doi:10.1016/0005-1098(94)90209-7"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="distance",
            symbol="s",
            unit="deg",
            lower=0.5,
            upper=30.0,
            description="Angle from the turn after which 37 % of the lack remain",
            search="logarithmic",
        ),
        Parameter(
            name="side",
            symbol="z",
            unit="1",
            lower=-1.0,
            upper=1.0,
            description="Sign with which the log counts friction",
            points=2,
        ),
    ),
    coefficients=(
        Parameter(
            name="lack",
            symbol="b",
            unit="torque",
            lower=0.0,
            upper=40.0,
            description="Friction lacking where the outermost bin is",
        ),
    ),
    basis=basis,
    needs=("position",),
    signature=Signature(
        axis="position",
        claim="Friction is below the model just after each reversal, equally at all speeds.",
    ),
    confounders=("inertia", "position_ripple", "direction_asymmetry"),
    experiment=(
        "Approach the same angles from the same side after a longer way, at the slowest speed:"
        " the lack goes with the reversal, inertia is then too small to matter."
    ),
    mirror="The lack in the load torque must equal that in friction, but for its sign.",
)
