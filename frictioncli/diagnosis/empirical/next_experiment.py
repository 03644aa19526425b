"""What to measure next to learn what a form of structure without a name is."""

import math

from frictioncli.diagnosis.empirical.form_columns import LATE_BUMPS
from frictioncli.diagnosis.empirical.term import FormFunction
from frictioncli.wording import number_text


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
    if form.kind in ("peak", *LATE_BUMPS):
        centre, width = form.shape["centre"], form.shape["width"]
        if axis == "speed":
            low, high = (_text(centre * math.exp(way * 2 * width)) for way in (-1, 1))
        else:
            low, high = (_text(centre + way * 3 * width) for way in (-1, 1))
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


def _text(value: float) -> str:
    return number_text(value, 3)
