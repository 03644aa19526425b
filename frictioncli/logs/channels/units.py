"""Units: how logs spell them, the factor to deg, deg/s, s, N·m and °C, and temperatures.

A unit in a header is a claim; :mod:`frictioncli.logs.channels.unit_evidence` checks those of
motion.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # settings ask for names of units before there is work: numpy is imported where it is needed
    from frictioncli.arrays import Array

_TURN = 180.0 / math.pi
_TEMPERATURE_FACTORS = {"°C": 1.0, "K": 1.0, "°F": 5.0 / 9.0, "m°C": 1e-3, "mK": 1e-3}
_OFFSETS = {"K": -273.15, "°F": -32.0 * 5.0 / 9.0, "mK": -273.15}

FACTORS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
        "position": {"deg": 1.0, "rad": _TURN, "udeg": 1e-6},
        "velocity": {"deg/s": 1.0, "rad/s": _TURN, "rpm": 6.0, "mdeg/s": 1e-3},
        "torque": {"N·m": 1.0, "mN·m": 1e-3, "A": 1.0, "mA": 1e-3},
        "motor_temperature": _TEMPERATURE_FACTORS,
        "housing_temperature": _TEMPERATURE_FACTORS,
        "load": {"N·m": 1.0, "mN·m": 1e-3},
    }
)
"""Factor from each unit to the one used inside, by quantity."""

_SPELLINGS = {
    "s": "s sec sek second seconds sekunden sekunde",
    "ms": "ms msec millis milliseconds millisekunden",
    "us": "us µs μs usec microseconds mikrosekunden",
    "ns": "ns nsec nanoseconds",
    "min": "min minutes minuten",
    "deg": "deg ° degree degrees grad",
    "rad": "rad radian radians radiant",
    "udeg": "udeg µdeg μdeg µ° μ° u° microdeg microdegree microdegrees 1e-6deg",
    "deg/s": "deg/s °/s degree/s degrees/s grad/s deg/sec °/sec deg*s^-1 dps",
    "rad/s": "rad/s rad/sec rad*s^-1 radian/s",
    "mdeg/s": "mdeg/s m°/s millideg/s",
    "rpm": "rpm 1/min u/min min^-1 /min r/min",
    "N·m": "nm n·m n*m newtonmeter newtonmetre n.m",
    "mN·m": "mnm mn·m mn*m",
    "A": "a amp ampere amps arms",
    "mA": "ma milliampere",
    "%": "% percent prozent",
    "°C": "°c degc c celsius deg_c grad_c gradc degcelsius",
    "K": "k kelvin",
    "m°C": "m°c mdegc",
    "mK": "mk millikelvin",
    "°F": "°f degf f fahrenheit",
}
_CANONICAL = {text: unit for unit, texts in _SPELLINGS.items() for text in texts.split()}

_COLDEST, _HOTTEST = -30.0, 150.0  # [°C]


@dataclass(frozen=True, slots=True)
class UnitBelief:
    """What is believed of a channel: ``value = raw * factor + offset`` in the unit used inside.

    ``note`` says why where the belief is not simply what the header says, else it is "".
    """

    unit: str
    factor: float
    offset: float = 0.0
    note: str = ""


def canonical(text: str, quantity: str) -> str | None:
    """Return the unit that a text means for a quantity, None when it means none of its units.

    A degree sign broken by a wrong encoding is mended.
    """
    bare = text.strip().strip("[]()").lower().replace(" ", "")
    # "°", "Â°", "ï¿½" and "?" are all a degree sign once; "Â·" and "·" are both a dot
    tries = (bare, re.sub(r"[^\x00-\x7f]+|\?+", "°", bare), re.sub(r"[^\x00-\x7f]+", "", bare))
    for spelling in tries:
        unit = _CANONICAL.get(spelling)
        if unit in FACTORS[quantity] or (unit == "%" and quantity == "torque"):
            return unit
    return None


def plain(unit: str, quantity: str, note: str = "") -> UnitBelief:
    """Return the belief in a unit as it is named."""
    return UnitBelief(unit, FACTORS[quantity][unit], _OFFSETS.get(unit, 0.0), note)


def time_unit(times: "list[Array]", declared: str | None) -> str:
    """Return the unit of a time column: the header's, else from the size of epoch times, else s."""
    import numpy as np

    if declared is not None:
        return declared
    starts = [abs(float(t[0])) for t in times if len(t)]
    start = float(np.median(starts)) if starts else 0.0
    for limit, unit in ((1e17, "ns"), (1e14, "us"), (1e11, "ms")):
        if start > limit:
            return unit
    return "s"


def temperature(
    values: "Array", declared: str | None, forced: str | None, quantity: str
) -> UnitBelief | None:
    """Find the unit of a temperature channel.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Raw values without NaN.
    declared, forced : str or None
        Unit by the header; unit by the user, which wins.
    quantity : str
        ``motor_temperature`` or ``housing_temperature``.

    Returns
    -------
    Belief or None
        None where the channel cannot be a temperature: empty, always 0, or outside -30..150 °C.
    """
    import numpy as np

    if not len(values) or not np.any(values):
        return None
    middle = float(np.median(values))
    unit = forced or declared or "°C"
    note = ""
    if forced is None and unit not in ("m°C", "mK") and middle > 1000:
        # raw values that lack the scale of their native header
        unit = "mK" if middle > 1000 * _HOTTEST else "m°C"
        note = f"values of {middle:.0f} are read as {unit}"
    elif forced is None and unit in ("°C", "°F") and middle > 200:
        unit, note = "K", f"values of {middle:.0f} are read as K"
    elif forced is None and unit == "K" and middle < _HOTTEST:
        unit, note = "°C", f"values of {middle:.0f} cannot be K: read as °C"
    belief = plain(unit, quantity, note)
    inside = middle * belief.factor + belief.offset
    return belief if _COLDEST <= inside <= _HOTTEST else None


def plausible_temperature(values: "Array") -> "Array":
    """Return temperatures [°C] with those outside -30..150 °C replaced by NaN."""
    import numpy as np

    if len(values) and _COLDEST <= values.min() <= values.max() <= _HOTTEST:
        return values
    return np.where((values >= _COLDEST) & (values <= _HOTTEST), values, np.nan)
