r"""Forms by which structure without a name may be described: what varies, how, and in which units.

A form has columns that are linear in its coefficients, once its shape parameters are given,

.. math:: f(x) = \sum_k a_k c_k(x; \theta) .

Its shape parameters stay between bounds that the data can tell apart: a peak can lie anywhere in
the range that was measured, and is as wide as a bin or two, or as a quarter of that range.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.empirical.form import Form, ShapeAxis
from frictioncli.diagnosis.empirical.form_columns import BUMP, UNEVEN_BUMP
from frictioncli.diagnosis.noise.cosine_series import Range

UNITS = {"position": "deg", "speed": "deg/s", "temperature": "°C", "load": "N·m"}
"""Units of the quantities."""

SYMBOLS = {"position": "q", "speed": "v", "temperature": "T", "load": "|L|"}
"""Symbols of the quantities in formulas; of the load its amount."""

_PEAKS = 24
"""Places of a peak that are tried over a range."""

_WIDTHS = 6
"""Widths of a peak that are tried."""

_NARROWEST = {"position": 0.012, "speed": 0.05, "temperature": 0.02, "load": 0.03}
_WIDEST = 0.25
"""Standard deviation of a peak as a share of the range."""

_STEEPNESS = {
    "position": (0.012, 0.04),
    "speed": (0.02, 0.08),
    "temperature": (0.02, 0.1),
    "load": (0.02, 0.06),
}
"""Least and greatest width of a step as a share of the range: wider ones look like the base, or
like any smooth function of the angle."""

_STEEPNESSES = 4
"""Widths of a step that are tried."""

_DISTANCES = {
    axis: "ln(v / centre)" if axis == "speed" else f"({symbol} - centre)"
    for axis, symbol in SYMBOLS.items()
}
"""Distances from the centre of a form, of the speed in its logarithm."""

_LAGS = (0.0, 0.025, 0.05, 0.075, 0.1)
"""Delays of a torque behind the angle. [s]"""

_SHIFTS = (-0.06, -0.04, -0.02, 0.02, 0.04, 0.06)
"""Changes of the logarithm of the speed of a peak with temperature. [1/°C]"""

_ORDERS = (1.0, 2.0, 3.0, 4.0)
"""Waves per turn of the joint."""

_EXPONENTS = (0.25, 0.5, 0.75, 1.25, 1.5, 2.0, 2.5, 3.0)
"""Powers of the load."""


def forms_of(ranges: Mapping[str, Range], sign: float = 1.0) -> list[Form]:
    """Return the forms that data can show, for the ranges that were measured.

    Parameters
    ----------
    ranges : mapping of str to (float, float)
        Ranges of ``position`` [deg], ``speed`` [deg/s], ``temperature`` [°C] and amount of the
        ``load`` [N·m], of those that vary.
    sign : float, optional
        Sign convention of the torques: +1 where forward is load plus friction, else -1.
    """
    found: list[Form] = []
    for axis, within in ranges.items():
        found.append(_peak(axis, "friction", within))
        if axis == "position":
            (plain,) = found
            late = replace(_late(plain), sign=sign)
            found = [late, _uneven(plain, late)]
        if axis != "load":
            of_load = _peak(axis, "load", within)
            at_angle = axis == "position"
            found.append(replace(_late(of_load), sign=sign) if at_angle else of_load)
        # what touches at an angle, as an end stop or a hose, may carry as well as rub
        channels = ("friction", "load") if axis == "position" else ("friction",)
        for channel in channels:
            found += [_bend(axis, way, channel, within) for way in ("above", "below")]
            found.append(_step(axis, channel, within))
    if "load" in ranges:
        found.append(
            Form(
                kind="lifting",
                axes=("load",),
                channel="load",
                shape=(ShapeAxis("exponent", "1", _EXPONENTS),),
                coefficients=("torque",),
                formula="torque sign(L) (|L| / 50)^exponent",
            )
        )
    if {"speed", "temperature"} <= ranges.keys():
        found.append(_moving_peak(ranges["speed"]))
    if {"position", "temperature"} <= ranges.keys():
        found.append(
            Form(
                kind="warm_wave",
                axes=("position", "temperature"),
                channel="friction",
                shape=(ShapeAxis("order", "1", _ORDERS),),
                coefficients=("cosine", "sine", "cosine_per_10K", "sine_per_10K"),
                formula="(cosine + cosine_per_10K (T - 40) / 10) cos(order q)"
                " + (sine + sine_per_10K (T - 40) / 10) sin(order q)",
            )
        )
    if {"position", "speed"} <= ranges.keys():
        speeds = tuple(np.geomspace(*ranges["speed"], 8)[1:-1].tolist())
        found.append(
            Form(
                kind="turning_wave",
                axes=("position", "speed"),
                channel="friction",
                shape=(
                    ShapeAxis("order", "1", _ORDERS),
                    ShapeAxis("turn", "deg/s", speeds, logarithmic=True),
                ),
                coefficients=("cosine", "sine"),
                formula="(cosine cos(order q) + sine sin(order q)) (v^2 - turn^2) / (v^2 + turn^2)",
            )
        )
    return found


def _peak(axis: str, channel: str, within: Range) -> Form:
    """Return a peak, or a dent, at one value of a quantity; of the speed in its logarithm."""
    return Form(
        kind="peak",
        axes=(axis,),
        channel=channel,
        shape=_centre_and_width(
            axis, within, _places(axis, within, _PEAKS), (_NARROWEST[axis], _WIDEST), _WIDTHS
        ),
        coefficients=("peak",),
        formula=f"peak exp(-({_DISTANCES[axis]} / width)^2 / 2)",
    )


def _places(axis: str, within: Range, count: int) -> Array:
    """Return places over a range, those of the speed in equal ratios."""
    return (np.geomspace if axis == "speed" else np.linspace)(*within, count)


def _centre_and_width(
    axis: str, within: Range, centres: Array, shares: Range, count: int
) -> tuple[ShapeAxis, ShapeAxis]:
    """Return place and width of a form, which is one of the logarithm of the speed.

    The width lies between two shares of the range.
    """
    low, high = within
    speed = axis == "speed"
    span = float(np.log(high / low)) if speed else high - low
    widths = span * np.geomspace(*shares, count)
    return (
        ShapeAxis("centre", UNITS[axis], tuple(centres.tolist()), logarithmic=speed),
        ShapeAxis("width", "1" if speed else UNITS[axis], tuple(widths.tolist()), True),
    )


def _late(plain: Form) -> Form:
    """Return a peak at one angle in a torque that is logged late."""
    return Form(
        kind=BUMP,
        axes=plain.axes,
        channel=plain.channel,
        shape=(*plain.shape, ShapeAxis("lag", "s", _LAGS)),
        coefficients=plain.coefficients,
        formula=f"{plain.formula}, at q - v lag forward and at q + v lag in reverse",
    )


def _uneven(plain: Form, late: Form) -> Form:
    """Return a peak at one angle that is not as high in both directions of motion.

    As of a tooth with one damaged flank.
    """
    return replace(
        late,
        kind=UNEVEN_BUMP,
        coefficients=("forward", "reverse"),
        formula=plain.formula.replace("peak", "height", 1)
        + ", height: forward at q - v lag in forward motion, reverse at q + v lag in reverse",
    )


def _bend(axis: str, way: str, channel: str, within: Range) -> Form:
    """Return torque that grows, or falls, linearly on one side of a value of a quantity."""
    inner = np.linspace(*within, _PEAKS + 2)[1:-1]
    beyond = f"{SYMBOLS[axis]} - start" if way == "above" else f"start - {SYMBOLS[axis]}"
    return Form(
        kind=f"bend_{way}",
        axes=(axis,),
        channel=channel,
        shape=(ShapeAxis("start", UNITS[axis], tuple(inner.tolist())),),
        coefficients=("per_10",),
        formula=f"per_10 max(0, {beyond}) / 10",
    )


def _step(axis: str, channel: str, within: Range) -> Form:
    """Return torque that is another one above a value of a quantity.

    As where a fan goes on, where a servo changes its gains, or where a hose touches.
    """
    inner = _places(axis, within, _PEAKS + 2)[1:-1]
    return Form(
        kind="step",
        axes=(axis,),
        channel=channel,
        shape=_centre_and_width(axis, within, inner, _STEEPNESS[axis], _STEEPNESSES),
        coefficients=("step",),
        formula=f"step Phi({_DISTANCES[axis]} / width), Phi: cumulative normal distribution",
    )


def _moving_peak(within: Range) -> Form:
    """Return a peak at a speed that goes with temperature."""
    low, high = within
    span = float(np.log(high / low))
    widths = np.geomspace(0.05 * span, _WIDEST * span, 4)
    return Form(
        kind="moving_peak",
        axes=("speed", "temperature"),
        channel="friction",
        shape=(
            ShapeAxis("centre", "deg/s", tuple(np.geomspace(low, high, 12).tolist()), True),
            ShapeAxis("width", "1", tuple(widths.tolist()), logarithmic=True),
            ShapeAxis("shift", "1/°C", _SHIFTS),
        ),
        coefficients=("peak",),
        formula="peak exp(-((ln(v / centre) - shift (T - 40)) / width)^2 / 2)",
    )
