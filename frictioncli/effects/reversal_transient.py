r"""After a reversal friction builds up over an angle (presliding).

.. math:: f = f_\infty - b\,e^{-|q - q_r|/s}

with the angle :math:`q_r` of the reversal. Forward moves start at the low end, reverse moves at the
high end. In friction both deficits add, :math:`-b (e_{lo} + e_{hi})/2`; in load they subtract,
:math:`\mp b (e_{lo} - e_{hi})/2`, with the sign convention of the log. It is not known here, so
that both are tried, as the shape parameter ``side``. Unlike inertia the deficit does not grow with
speed, and it starts at the reversal, the same angle for slow and fast moves.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature
from frictioncli.effects.pair_series import turning_points
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, distance: float, side: float) -> Basis:
    """Return the deficit after the reversal in friction and in load, shape (rows, 1). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float
        Angle after which 37 % of the deficit remain. [deg]
    side : float
        Sign convention of the log: positive or negative.
    """
    low, high = turning_points(table, distance=distance)
    sign = 1.0 if side > 0 else -1.0
    return Basis(
        (-(low + high) / 2)[:, np.newaxis],
        (-sign * (low - high) / 2)[:, np.newaxis],
    )


EFFECT = Effect(
    name="reversal_transient",
    summary="Friction has not built up yet just after a reversal.",
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
            description="Distance from the reversal after which 37 % of the deficit remain",
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
            description="Friction deficit in the outermost bin",
        ),
    ),
    basis=basis,
    needs=("position",),
    uses=("angle",),
    signature=Signature(
        axis="position",
        claim="Friction is below the model just after each reversal, equally at all speeds.",
    ),
    statement=(
        "Just after a reversal friction is {lack} too low; 37 % of that remains after {distance}."
    ),
    confounders=("inertia", "position_ripple", "direction_asymmetry"),
    experiment=(
        "Approach the same angles from the same side after a longer distance, at the slowest"
        " speed: the deficit depends on the distance from the reversal, and inertia is negligible."
    ),
    mirror="The deficits in load torque and friction must be equal except for sign.",
)
