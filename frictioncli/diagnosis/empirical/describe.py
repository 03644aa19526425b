"""Forms that were found, in words and as formulas with numbers."""

import math
from collections.abc import Callable, Mapping

from frictioncli.diagnosis.empirical.form_columns import BUMP, UNEVEN_BUMP
from frictioncli.diagnosis.empirical.term import FormFunction
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


def described(
    form: FormFunction, unit: str, load_unit: str = "N·m", *, delay_is_stated: bool = False
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
    return _WORDS[form.kind](form, unit).replace(_LOAD_UNIT, load_unit) + own + since


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
    return f"{form.formula}; {', '.join(f'{name} = {one:.5g}' for name, one in values.items())}"


def experiment(form: FormFunction, load_unit: str = "N·m") -> str:
    """Return what to measure next to learn what a form is.

    Parameters
    ----------
    form : FormFunction
        The form with its parameters.
    load_unit : str, optional
        Unit of load.
    """
    axis = form.axes[0]
    if form.kind in ("peak", BUMP, UNEVEN_BUMP):
        centre, width = form.shape["centre"], form.shape["width"]
        if axis == "speed":
            low, high = (_number(centre * math.exp(way * 2 * width)) for way in (-1, 1))
        else:
            low, high = (_number(centre + way * 3 * width) for way in (-1, 1))
        bins = number_text(width / 2, 2)
        return _AROUND[axis].format(low=low, high=high, bins=bins, load=load_unit)
    return _AT_STEP[axis] if form.kind == "step" else _NEXT[form.kind]


_AROUND = {
    "position": "Move through {low} to {high} deg at three speeds, some of them slow, cold and"
    " warm, with and without a payload, in bins of {bins} deg or less: damage of gear or bearing"
    " stays at its angle at all speeds; an effect of load grows with the load; what a gripper"
    " carries on some moves only is told apart where the log has a column payload.",
    "speed": "Measure at six speeds or more from {low} to {high} deg/s in random order, cold and"
    " warm: a resonance stays at its speed; a change of lubrication shifts with temperature.",
    "temperature": "Go through {low} to {high} °C twice, heating and cooling, at another rate and"
    " on another day: an effect of temperature returns at the same temperature; an effect of time"
    " does not.",
    "load": "Measure with another payload, or in another pose, so that loads of {low} to {high}"
    " {load} occur at other angles: an effect of load moves with them.",
}
"""What to measure around a peak."""

_AT_STEP = {
    "position": "Move across this angle at three speeds, some of them slow, cold and warm, with and"
    " without a payload, and with anything that may touch there (a hose, a cover) taken off.",
    "speed": "Measure at six speeds or more on both sides of this one, in random order, cold and"
    " warm, with other gains of the servo if these change there.",
    "temperature": "Go through this temperature twice, heating and cooling, at another rate and on"
    " another day, with anything that switches there (a fan, a heater) once on and once off.",
    "load": "Measure with another payload, or in another pose, so that this load occurs at another"
    " angle: an effect of load moves with it.",
}
"""What to measure about a step."""

_BEND = "Measure more values on both sides of the bend, in random order, on another day."

_NEXT = {
    "bend_above": _BEND,
    "bend_below": _BEND,
    "lifting": "Measure with two payloads: a loss in lifting grows with the load to its power;"
    " an error of the mass grows in proportion.",
    "moving_peak": "Measure at six speeds or more around the peak, at three constant temperatures.",
    "warm_wave": "Move through the whole stroke at one slow speed, at three constant temperatures.",
    "turning_wave": "Move through the whole stroke at six speeds or more, in random order, at one"
    " temperature.",
}
"""What to measure about other forms."""


def _of(form: FormFunction) -> str:
    return "friction" if form.channel == "friction" else "the load"


def _that(form: FormFunction) -> str:
    return "friction that" if form.channel == "friction" else "a load that"


def _size(value: float, unit: str) -> str:
    return f"{number_text(abs(value), 2)} {unit}"


def _number(value: float) -> str:
    return number_text(value, 3)


def _peak(form: FormFunction, unit: str) -> str:
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


def _uneven_bump(form: FormFunction, unit: str) -> str:
    shape = form.shape
    sizes = [form.coefficients[name] for name in ("forward", "reverse")]
    forward, reverse = (f"{_size(one, unit)} {'more' if one > 0 else 'less'}" for one in sizes)
    wide = f"{number_text(shape['width'], 2)} deg wide (standard deviation)"
    return (
        f"friction that is another one in each direction at {_number(shape['centre'])} deg:"
        f" {forward} in forward motion, {reverse} in reverse, {wide}{_late(form)}"
    )


def _bend(form: FormFunction, unit: str) -> str:
    (axis,), above = form.axes, form.kind == "bend_above"
    slope = form.coefficients["per_10"]
    # below the bend a positive coefficient falls towards it
    way = "rises" if (slope > 0) == above else "falls"
    where = f"{'above' if above else 'below'} {_number(form.shape['start'])} {_UNITS[axis]}"
    return f"{_that(form)} {way} by {_size(slope, unit)} per 10 {_UNITS[axis]} {where}"


def _step(form: FormFunction, unit: str) -> str:
    (axis,), step, width = form.axes, form.coefficients["step"], form.shape["width"]
    within = f"{number_text(4 * width, 2)} {_UNITS[axis]}"
    if axis == "speed":
        within = f"a factor of {number_text(math.exp(4 * width), 2)}"
    place = _PLACES[axis].format(_number(form.shape["centre"]))
    way = "rises" if step > 0 else "falls"
    return f"{_that(form)} {way} by {_size(step, unit)} {place}, within about {within}"


def _lifting(form: FormFunction, unit: str) -> str:
    torque, exponent = form.coefficients["torque"], form.shape["exponent"]
    more = "more" if torque > 0 else "less"
    power = number_text(exponent, 2)
    return (
        f"lifting that takes {_size(torque, unit)} {more} at a load of 50 {_LOAD_UNIT}, and"
        f" lowering that gives as much less back, as the load to the power {power}"
    )


def _moving_peak(form: FormFunction, unit: str) -> str:
    shape, height = form.shape, form.coefficients["peak"]
    moves = 100 * math.expm1(shape["shift"])
    way = "up" if moves > 0 else "down"
    return (
        f"a {'dent' if height < 0 else 'peak'} of friction of {_size(height, unit)} at"
        f" {_number(shape['centre'])} deg/s (at 40 °C), a factor of"
        f" {number_text(math.exp(shape['width']), 2)} wide (standard deviation), which moves {way}"
        f" by {number_text(abs(moves), 2)} % of its speed per °C"
    )


def _times(order: float) -> str:
    return "once" if order == 1 else f"{order:g} times"


def _warm_wave(form: FormFunction, unit: str) -> str:
    growth = math.hypot(form.coefficients["cosine_per_10K"], form.coefficients["sine_per_10K"])
    return (
        f"friction that goes up and down {_times(form.shape['order'])} per turn, by an"
        f" amount that changes by {_size(growth, unit)} per 10 °C"
    )


def _turning_wave(form: FormFunction, unit: str) -> str:
    size = math.hypot(form.coefficients["cosine"], form.coefficients["sine"])
    return (
        f"friction that goes up and down {_times(form.shape['order'])} per turn by up to"
        f" {_size(size, unit)}, with opposite signs below and above"
        f" {_number(form.shape['turn'])} deg/s"
    )


_WORDS: Mapping[str, Callable[[FormFunction, str], str]] = {
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
