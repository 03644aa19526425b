"""Forms that were found, in words and as formulas with numbers."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

from frictioncli.diagnosis.empirical.form_columns import (
    BUMP,
    MIDDLE_TEMPERATURE,
    UNEVEN_BUMP,
)
from frictioncli.diagnosis.empirical.term import FormFunction
from frictioncli.diagnosis.noise.cosine_series import Range
from frictioncli.wording import number_text

_PLACES = {
    "position": "at {} deg",
    "speed": "at {} deg/s",
    "temperature": "at {} °C",
    "load": "at a load of {} <load unit>",
}

_LOAD_UNIT = "<load unit>"
"""What stands in a text for the unit of load, which is that of the log."""

_UNITS = {"position": "deg", "speed": "deg/s", "temperature": "°C", "load": f"{_LOAD_UNIT} of load"}

_LEAST_LAG = 0.001
"""Delay from which on it is said. [s]"""


_OWN_DELAY = (
    " (by this form alone, without an interval; the delay or filter of the log is stated apart)"
)
"""What is said of the delay of a form where the delay of the log is stated, too."""

_MAY_BE_SHAPE = " (so near that it may be a part of the shape of the former)"
"""What is said of a form that may be what another one misses."""


_NEAR = 4.0
"""Distance from a form, in widths of it, up to which another one may be a part of its shape."""

_MOSTLY = 2.0
"""Ratio of load to friction from which on torque that differs in both directions is a load: where
that is larger, friction is, too."""

_ALIKE = 0.1
"""Ratio of load to friction up to which a bump is nearly the same in both directions."""

_NOTHING = 0.02
"""Share of the torque in one direction up to which that in the other is none."""

_NO_RANGES: Mapping[str, Range] = MappingProxyType({})


def described(
    form: FormFunction,
    unit: str,
    load_unit: str = "N·m",
    *,
    delay_is_stated: bool = False,
    ranges: Mapping[str, Range] = _NO_RANGES,
    beside: FormFunction | None = None,
) -> str:
    """Return a form in words, as "a bump of friction of 5.5 N·m at 86 deg, 6.8 deg wide".

    The width is the standard deviation of a peak that falls like a normal distribution.

    Parameters
    ----------
    form : FormFunction
        The form with its parameters.
    unit, load_unit : str
        Units of torque and of load.
    delay_is_stated : bool, optional
        Whether the delay of the log is stated besides, which is not that of a form.
    ranges : mapping of str to (float, float), optional
        Ranges that were measured: what a form is at a temperature or a load is said within these.
    beside : FormFunction, optional
        A larger form, of which this one may be what it misses of the shape of its law.

    Examples
    --------
    >>> from frictioncli.diagnosis.empirical.term import FormFunction
    >>> form = FormFunction(
    ...     kind="peak",
    ...     axes=("temperature",),
    ...     channel="friction",
    ...     shape={"centre": 45.3, "width": 1.9},
    ...     coefficients={"peak": -1.4},
    ...     formula="peak exp(-((T - centre) / width)^2 / 2)",
    ... )
    >>> described(form, "N·m")
    'a dent of friction of 1.4 N·m at 45.3 °C, 1.9 °C wide (standard deviation)'
    """
    since = f", since run {form.since}" if form.since else ""
    own = _OWN_DELAY if delay_is_stated and _is_late(form) else ""
    near = _MAY_BE_SHAPE if beside is not None and is_near(form, beside) else ""
    text = _WORDS[form.kind](form, unit, ranges).replace(_LOAD_UNIT, load_unit)
    return text + own + since + near


def is_near(form: FormFunction, other: FormFunction) -> bool:
    """Return whether a form may be what another one, of the same quantity, misses of its shape.

    No law has exactly the shape of a form, and what is left at the flanks looks like another one.

    Parameters
    ----------
    form, other : FormFunction
        The forms.
    """
    width, centre = other.shape.get("width"), other.shape.get("centre")
    place = form.shape.get("centre", form.shape.get("start"))
    alike = (form.axes, form.channel, form.since) == (other.axes, other.channel, other.since)
    if not alike or width is None or centre is None or place is None or len(form.axes) > 1:
        return False
    away = math.log(place / centre) if form.axes == ("speed",) else place - centre
    return abs(away) <= _NEAR * width


def _is_late(form: FormFunction) -> bool:
    return form.shape.get("lag", 0.0) > _LEAST_LAG


def formula_with_numbers(form: FormFunction) -> str:
    """Return a form's formula with its parameters: q in deg, v in deg/s, T in °C, L in N·m.

    Parameters
    ----------
    form : FormFunction
        The form with its parameters.
    """
    values = {**form.shape, **form.coefficients}
    since = f", from run {form.since} on" if form.since else ""
    numbers = ", ".join(f"{name} = {one:.5g}" for name, one in values.items())
    return f"{form.formula}; {numbers}{since}"


def _within(usual: float, axis: str, ranges: Mapping[str, Range]) -> float:
    """Return a usual value of a quantity, or the next one that was measured."""
    low, high = ranges.get(axis, (usual, usual))
    return min(max(usual, low), high)


def _of(form: FormFunction) -> str:
    return "friction" if form.channel == "friction" else "the load"


def _that(form: FormFunction) -> str:
    return "friction that" if form.channel == "friction" else "a load that"


def _size(value: float, unit: str) -> str:
    return f"{number_text(abs(value), 2)} {unit}"


def _number(value: float) -> str:
    return number_text(value, 3)


def _peak(form: FormFunction, unit: str, _: Mapping[str, Range]) -> str:
    (axis,), shape = form.axes, form.shape
    height = form.coefficients["peak"]
    what = "dent" if height < 0 else "bump" if axis == "position" else "peak"
    place = _PLACES[axis].format(_number(shape["centre"]))
    if axis == "speed":
        wide = f"a factor of {number_text(math.exp(shape['width']), 2)} wide (standard deviation)"
    else:
        wide = f"{number_text(shape['width'], 2)} {_UNITS[axis]} wide (standard deviation)"
    text = f"a {what} of {_of(form)} of {_size(height, unit)} {place}, {wide}"
    return text + _late(form)


def _late(form: FormFunction) -> str:
    """Return by how much a form's torque is late; empty if it is not."""
    late = (
        f", in a torque that is logged {number_text(1e3 * form.shape.get('lag', 0.0), 2)} ms late"
    )
    return late if _is_late(form) else ""


def _more(value: float, unit: str) -> str:
    return f"{_size(value, unit)} {'more' if value > 0 else 'less'}"


def _uneven_bump(form: FormFunction, unit: str, _: Mapping[str, Range]) -> str:
    shape = form.shape
    sizes = [form.coefficients[name] for name in ("forward", "reverse")]
    wide = f"{number_text(shape['width'], 2)} deg wide (standard deviation)"
    load, friction = form.sign * (sizes[0] - sizes[1]) / 2, sum(sizes) / 2
    if abs(load) > _MOSTLY * abs(friction):
        return (
            f"a {'bump' if load > 0 else 'dent'} of the load of {_size(load, unit)} at"
            f" {_number(shape['centre'])} deg, {wide}, where friction is"
            f" {_more(friction, unit)}{_late(form)}"
        )
    if abs(load) < _ALIKE * abs(friction):
        return (
            f"a {'bump' if friction > 0 else 'dent'} of friction of {_size(friction, unit)} at"
            f" {_number(shape['centre'])} deg, nearly the same in both directions,"
            f" {wide}{_late(form)}"
        )
    least = _NOTHING * max(abs(one) for one in sizes)
    forward, reverse = ("none" if abs(one) < least else _more(one, unit) for one in sizes)
    return (
        f"friction that is another one in each direction at {_number(shape['centre'])} deg:"
        f" {forward} in forward motion, {reverse} in reverse, {wide}{_late(form)}"
    )


def _bend(form: FormFunction, unit: str, _: Mapping[str, Range]) -> str:
    (axis,), above = form.axes, form.kind == "bend_above"
    slope = form.coefficients["per_10"]
    # below the bend a positive coefficient falls towards it
    way = "rises" if (slope > 0) == above else "falls"
    where = f"{'above' if above else 'below'} {_number(form.shape['start'])} {_UNITS[axis]}"
    return f"{_that(form)} {way} by {_size(slope, unit)} per 10 {_UNITS[axis]} {where}"


def _step(form: FormFunction, unit: str, _: Mapping[str, Range]) -> str:
    (axis,), step, width = form.axes, form.coefficients["step"], form.shape["width"]
    within = f"{number_text(4 * width, 2)} {_UNITS[axis]}"
    if axis == "speed":
        within = f"a factor of {number_text(math.exp(4 * width), 2)}"
    place = _PLACES[axis].format(_number(form.shape["centre"]))
    way = "rises" if step > 0 else "falls"
    return f"{_that(form)} {way} by {_size(step, unit)} {place}, within about {within}"


def _lifting(form: FormFunction, unit: str, ranges: Mapping[str, Range]) -> str:
    torque, exponent = form.coefficients["torque"], form.shape["exponent"]
    more = "more" if torque > 0 else "less"
    power, load = number_text(exponent, 2), _within(50.0, "load", ranges)
    at_load = torque * (load / 50.0) ** exponent
    return (
        f"lifting that takes {_size(at_load, unit)} {more} at a load of {load:.3g}"
        f" {_LOAD_UNIT}, and"
        f" lowering that gives as much less back, as the load to the power {power}"
    )


def _moving_peak(form: FormFunction, unit: str, ranges: Mapping[str, Range]) -> str:
    shape, height = form.shape, form.coefficients["peak"]
    warm = _within(MIDDLE_TEMPERATURE, "temperature", ranges)
    centre = shape["centre"] * math.exp(shape["shift"] * (warm - MIDDLE_TEMPERATURE))
    moves = 100 * math.expm1(shape["shift"])
    way = "up" if moves > 0 else "down"
    return (
        f"a {'dent' if height < 0 else 'peak'} of friction of {_size(height, unit)} at"
        f" {_number(centre)} deg/s (at {warm:.3g} °C), a factor of"
        f" {number_text(math.exp(shape['width']), 2)} wide (standard deviation), which moves {way}"
        f" by {number_text(abs(moves), 2)} % of its speed per °C"
    )


def _times(order: float) -> str:
    return "once" if order == 1 else f"{order:g} times"


def _warm_wave(form: FormFunction, unit: str, _: Mapping[str, Range]) -> str:
    growth = math.hypot(form.coefficients["cosine_per_10K"], form.coefficients["sine_per_10K"])
    return (
        f"friction that goes up and down {_times(form.shape['order'])} per turn, by an"
        f" amount that changes by {_size(growth, unit)} per 10 °C"
    )


def _turning_wave(form: FormFunction, unit: str, _: Mapping[str, Range]) -> str:
    size = math.hypot(form.coefficients["cosine"], form.coefficients["sine"])
    return (
        f"friction that goes up and down {_times(form.shape['order'])} per turn by up to"
        f" {_size(size, unit)}, with opposite signs below and above"
        f" {_number(form.shape['turn'])} deg/s"
    )


_WORDS: Mapping[str, Callable[[FormFunction, str, Mapping[str, Range]], str]] = {
    BUMP: _peak,
    UNEVEN_BUMP: _uneven_bump,
    "peak": _peak,
    "bend_above": _bend,
    "bend_below": _bend,
    "step": _step,
    "lifting": _lifting,
    "moving_peak": _moving_peak,
    "warm_wave": _warm_wave,
    "turning_wave": _turning_wave,
}
