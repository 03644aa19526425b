r"""After a reversal the contacts have to be bent over before full friction acts.

Friction builds up over some angle from the reversal, :math:`f = f_\infty - b\,e^{-|q - q_r|/s}`.
Forward moves reverse at the low end, reverse moves at the high end. In friction both lacks add,
:math:`-b (e_{lo} + e_{hi})/2`; in load they subtract, :math:`\mp b (e_{lo} - e_{hi})/2`, where the
sign is that with which the log counts friction. It is not known here, hence two coefficients, which
must be equal but for sign. Unlike inertia it does not grow with speed.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature
from frictioncli.effects.pairs import stroke_ends


def basis(table: EffectTable, *, distance: float) -> Basis:
    """Return the friction that is lacking near the ends, in friction and in load.

    The first column is zero in load, the second in friction.
    """
    low, high = stroke_ends(table, distance=distance)
    none = np.zeros_like(low)
    return Basis(
        np.column_stack([-(low + high) / 2, none]),
        np.column_stack([none, -(low - high) / 2]),
    )


EFFECT = Effect(
    name="reversal_transient",
    summary="Friction is not yet built up just after a reversal.",
    equation=(
        "dtau = -b*(exp(-(q - q_lo)/s) + exp(-(q_hi - q)/s))/2,"
        " dL = -c*(exp(-(q - q_lo)/s) - exp(-(q_hi - q)/s))/2, c = +b or -b"
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
            lower=0.1,
            upper=10.0,
            description="Angle from the reversal after which 37 % of the lack remain",
            search="logarithmic",
        ),
    ),
    coefficients=(
        Parameter(
            name="lack_in_friction",
            symbol="b",
            unit="torque",
            lower=0.0,
            upper=20.0,
            description="Friction lacking in the outermost bin",
        ),
        Parameter(
            name="lack_in_load",
            symbol="c",
            unit="torque",
            lower=-20.0,
            upper=20.0,
            description="The same as seen in the load torque",
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
