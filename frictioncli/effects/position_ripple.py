r"""Friction varies periodically with the angle: eccentric gears, bearings, a seal.

.. math:: \Delta\tau = A_s \sin N q + A_c \cos N q + B_s \sin 2 N q + B_c \cos 2 N q

Angle bins sample a ripple: an order above half their number per turn is aliased (Nyquist), so that
the search ends there. At order 2 a ripple resembles the load term of a joint under gravity.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.parameter import Parameter

_LEAST_PERIODS = 1.25
"""Over fewer periods a ripple cannot be distinguished from a load term."""

_LEAST_ANGLES = 10
"""Twice its parameters: over fewer angle bins they follow any function of the angle."""


def basis(table: EffectTable, *, order: float) -> Basis:
    """Return sine and cosine at the order and at twice the order, shape (rows, 4). [-].

    Columns are zero where the bins are too wide for the order, or fewer than 10, or the stroke is
    shorter than 1.25 periods. Of twice the order, the mean over a bin is what is left where the
    bins are wide for it.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    order : float
        Periods per turn of the joint. [1/turn]
    """
    angles = table.angles
    finest = float(np.min(np.diff(angles))) if len(angles) > 1 else 360.0
    long_enough = order * float(np.ptp(angles)) / 360.0 >= _LEAST_PERIODS
    enough = long_enough and len(angles) >= _LEAST_ANGLES
    resolved = 1.0 if enough and order <= 180.0 / finest else 0.0
    second = resolved
    if 2 * order > 180.0 / finest:
        # the centres of the bins do not show its order, but its phase is tied to the first
        second *= float(np.sinc(order * finest / 180.0))
    phase = order * np.radians(table.angle)
    sine, cosine = np.sin(phase), np.cos(phase)
    # sine and cosine of twice the phase
    return friction_only(
        resolved * sine,
        resolved * cosine,
        2 * second * sine * cosine,
        second * (1 - 2 * np.square(sine)),
    )


def orders(*, order: float) -> tuple[float, ...]:
    """Return the multiples of the angle, of which there are a sine and a cosine each [1/turn]."""
    return order, 2 * order


def periods_seen(table: EffectTable, *, order: float) -> float:
    """Return how many periods of a ripple the measured angles span.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    order : float
        Periods per turn. [1/turn]
    """
    return order * float(np.ptp(table.position)) / 360.0


EFFECT = Effect(
    name="position_ripple",
    summary="Friction varies periodically with the angle.",
    equation="dtau = As*sin(N*q) + Ac*cos(N*q) + Bs*sin(2*N*q) + Bc*cos(2*N*q)",
    source="Angle-periodic friction of gears and bearings; size is an engineering estimate",
    channel="friction",
    shape=(
        Parameter(
            name="order",
            symbol="N",
            unit="1/turn",
            lower=2.0,
            upper=30.0,
            description="Periods per turn of the joint",
            points=57,
        ),
    ),
    coefficients=(
        Parameter(
            name="sine",
            symbol="As",
            unit="torque",
            lower=-10.0,
            upper=10.0,
            description="Amplitude of the sine",
        ),
        Parameter(
            name="cosine",
            symbol="Ac",
            unit="torque",
            lower=-10.0,
            upper=10.0,
            description="Amplitude of the cosine",
        ),
        Parameter(
            name="second_sine",
            symbol="Bs",
            unit="torque",
            lower=-10.0,
            upper=10.0,
            description="Amplitude of the sine of twice the order",
        ),
        Parameter(
            name="second_cosine",
            symbol="Bc",
            unit="torque",
            lower=-10.0,
            upper=10.0,
            description="Amplitude of its cosine",
        ),
    ),
    basis=basis,
    orders=orders,
    needs=("position",),
    uses=("angle",),
    signature=Signature(
        axis="position",
        claim="Residuals repeat over the angle, with the same phase at all speeds.",
    ),
    statement="Friction varies periodically with the angle, of order {order}.",
    confounders=("load_linear", "reversal_transient", "inertia"),
    experiment=(
        "Sample the angle finely, without bins, at two speeds: a ripple of the gear keeps its"
        " angle, a vibration keeps its time. With another payload its angle stays too."
    ),
)
