"""Units in logs: their spellings and their conversion to deg, deg/s, s, N·m and °C.

The unit in a header may be wrong. :mod:`frictioncli.logs.channels.unit_evidence` checks those of
time, position and velocity against the values.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # settings import this module for unit names at start-up; numpy is imported where it is used
    from frictioncli.arrays import Array

_DEGREES_PER_RADIAN = 180.0 / math.pi
_TORQUE_FACTORS = {
    **{"N·m": 1.0, "mN·m": 1e-3, "N·cm": 1e-2, "kN·m": 1e3},
    **{"kgf·m": 9.80665, "kgf·cm": 0.0980665},
    **{"lbf·ft": 1.3558179483, "lbf·in": 0.1129848290, "ozf·in": 0.00706155181},
}
_ONLY_WRITTEN_POSITIONS = {"turn": 360.0, "mrad": _DEGREES_PER_RADIAN / 1e3}
_TEMPERATURE_FACTORS = {"°C": 1.0, "K": 1.0, "°F": 5.0 / 9.0, "m°C": 1e-3, "mK": 1e-3}
_OFFSETS = {"K": -273.15, "°F": -32.0 * 5.0 / 9.0, "mK": -273.15}

FACTORS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "100ns": 1e-7},
        "position": {
            "deg": 1.0,
            "rad": _DEGREES_PER_RADIAN,
            "udeg": 1e-6,
            **_ONLY_WRITTEN_POSITIONS,
        },
        "velocity": {
            **{"deg/s": 1.0, "rad/s": _DEGREES_PER_RADIAN, "rpm": 6.0, "mdeg/s": 1e-3},
            **{f"{unit}/s": factor for unit, factor in _ONLY_WRITTEN_POSITIONS.items()},
        },
        "torque": {**_TORQUE_FACTORS, "A": 1.0, "mA": 1e-3, "%": 1.0, "‰": 0.1},
        "motor_temperature": _TEMPERATURE_FACTORS,
        "housing_temperature": _TEMPERATURE_FACTORS,
        "load": _TORQUE_FACTORS,
        "payload": {"kg": 1.0, "g": 1e-3, "lb": 0.45359237},
    }
)
"""Factor from each unit to the internal unit, by quantity."""

ONLY_WRITTEN = frozenset(
    {*_ONLY_WRITTEN_POSITIONS, *(f"{unit}/s" for unit in _ONLY_WRITTEN_POSITIONS)}
)
"""Units that are taken only where they are written: by its values one in turn/s looks like rpm."""

_SPELLINGS = {
    "s": "s sec sek second seconds sekunden sekunde",
    "ms": "ms msec millis milliseconds millisekunden",
    "us": "us µs μs usec microseconds mikrosekunden",
    "ns": "ns nsec nanoseconds",
    "100ns": "100ns",
    "min": "min minutes minuten",
    "deg": "deg ° degree degrees grad grados gradi",
    "mrad": "mrad milliradian milliradians",
    "mrad/s": "mrad/s",
    "rad": "rad radian radians radiant",
    "udeg": "udeg µdeg μdeg µ° μ° u° microdeg microdegree microdegrees 1e-6deg",
    "turn": "turn turns rev revs rot rots revolution revolutions rotation rotations umdrehung"
    " umdrehungen",
    "turn/s": "turn/s turns/s rev/s revs/s rot/s rps hz",
    "deg/s": "deg/s °/s degree/s degrees/s degrees/sec grad/s grados/s gradi/s deg/sec °/sec"
    " deg*s^-1 dps degps deg_s degs degsec",
    "rad/s": "rad/s rad/sec rad*s^-1 radian/s radians/s radians/sec radps rad_s rads radsec",
    "mdeg/s": "mdeg/s m°/s millideg/s",
    "rpm": "rpm min-1 tr/min 1/min u/min min^-1 /min r/min",
    "N·m": "nm n·m n*m newtonmeter newtonmetre n.m n-m",
    "mN·m": "mnm mn·m mn*m",
    "N·cm": "ncm n·cm n*cm",
    "kN·m": "knm kn·m kn*m",
    "kgf·m": "kgf·m kgf*m kgfm kgf.m kg-m kg·m",
    "kgf·cm": "kgf·cm kgf*cm kgfcm kgf.cm kg-cm kg·cm",
    "lbf·ft": "lbf·ft lbf*ft lbfft lb-ft ft-lb ft·lbf",
    "lbf·in": "lbf·in lbf*in lbfin lb-in in-lb in·lbf",
    "ozf·in": "ozf·in ozf*in ozfin oz-in in-oz",
    "kg": "kg kilogram kilograms kilogramm",
    "g": "g gram grams gramm",
    "lb": "lb lbs pound pounds",
    "‰": "‰ permille permil perthousand ‰rated",
    "A": "a amp ampere amps arms",
    "mA": "ma milliampere",
    "%": "% percent pct prozent %rated %ofrated %nominal %ofnominal",
    "°C": "°c degc c celsius deg_c grad_c gradc degcelsius",
    "K": "k kelvin",
    "m°C": "m°c mdegc",
    "mK": "mk millikelvin",
    "°F": "°f degf f fahrenheit",
}
_CANONICAL = {text: unit for unit, texts in _SPELLINGS.items() for text in texts.split()}

_COUNTS = re.compile(
    r"(?:pulses?|puls|counts?|cts?|cnts?|ticks?|inc|incr|increments?|inkremente?|steps?|lsb|digits?)"
    r"(?:/s|/sec|/ms)?",
    re.I,
)
_NOT_READ = re.compile(r"[^\x00-\x7f]+|\?+")
_NOT_ASCII = re.compile(r"[^\x00-\x7f]+")

_LONGEST_PERIOD = 5.0
"""Longest usual period from row to row. [s]"""
_LOWEST_TEMPERATURE, _HIGHEST_TEMPERATURE = -30.0, 150.0  # [°C]


@dataclass(frozen=True, slots=True)
class UnitConversion:
    """Conversion of a channel's raw values: ``value = raw * factor + offset``.

    Attributes
    ----------
    unit : str
        Unit of the raw values.
    factor, offset : float
        Slope and intercept of the conversion to the internal unit.
    note : str
        Why the unit differs from the one in the header; "" where it does not.
    """

    unit: str
    factor: float
    offset: float = 0.0
    note: str = ""


def canonical(text: str, quantity: str) -> str | None:
    """Return the unit of a quantity that a text names, None where it names none.

    A degree sign that a wrong encoding has damaged is recognised.

    Parameters
    ----------
    text : str
        The unit as written in a log, with or without brackets.
    quantity : str
        A key of :data:`FACTORS`.

    Examples
    --------
    >>> canonical("[Nm]", "torque")
    'N·m'
    >>> canonical("?/s", "velocity")
    'deg/s'
    >>> canonical("furlong", "position") is None
    True
    """
    bare = text.strip().strip("[]()").lower().replace(" ", "")
    # "°", "Â°", "ï¿½" and "?" are all a degree sign once; "Â·" and "·" are both a dot
    tries = (bare, _NOT_READ.sub("°", bare), _NOT_ASCII.sub("", bare))
    for spelling in tries:
        unit = _CANONICAL.get(spelling)
        if unit in FACTORS[quantity]:
            return unit
    return None


def is_count(text: str) -> bool:
    """Return whether a unit counts pulses of an encoder or digits of a converter.

    Examples
    --------
    >>> is_count("[pulse]"), is_count("counts/s"), is_count("deg")
    (True, True, False)
    """
    return _COUNTS.fullmatch(text.strip().strip("[]()").replace(" ", "")) is not None


def conversion_from(unit: str, quantity: str, note: str = "") -> UnitConversion:
    """Return the conversion from a unit to the internal unit of its quantity.

    Examples
    --------
    >>> conversion_from("K", "motor_temperature").offset
    -273.15
    """
    return UnitConversion(unit, FACTORS[quantity][unit], _OFFSETS.get(unit, 0.0), note)


def infer_time_unit(times: "list[Array]", declared: str | None) -> str:
    """Return the unit of a time column.

    The header's unit is taken where it names one. Otherwise times since 1970 are recognised by
    their size, and whole numbers by steps that would be long in seconds; other times are taken as
    seconds.

    Parameters
    ----------
    times : list of ndarray, shape (n,)
        Raw times of each log.
    declared : str or None
        Unit in the header.

    Examples
    --------
    >>> import numpy as np
    >>> infer_time_unit([np.array([1.7e12, 1.7e12 + 4])], None)
    'ms'
    """
    import numpy as np

    if declared is not None:
        return declared
    # the first one of a log may be damaged
    sizes = [abs(float(np.median(t))) for t in times if len(t)]
    size = float(np.median(sizes)) if sizes else 0.0
    for limit, unit in ((1e17, "ns"), (1e14, "us"), (1e11, "ms")):
        if size > limit:
            return unit
    step = whole_step(times)
    if step is None or step <= _LONGEST_PERIOD:
        return "s"
    factors = FACTORS["time"]
    return next(
        u for u in ("ms", "us", "ns", "s") if step * factors[u] <= _LONGEST_PERIOD or u == "s"
    )


def whole_step(times: "list[Array]") -> float | None:
    """Return the median step of times that are whole numbers; None where they are not.

    Parameters
    ----------
    times : list of ndarray, shape (n,)
        Raw times of each log.

    Examples
    --------
    >>> import numpy as np
    >>> whole_step([np.array([0.0, 10.0, 20.0])]), whole_step([np.array([0.0, 0.5])])
    (10.0, None)
    """
    import numpy as np

    long = [t[np.isfinite(t)] for t in times]
    if not any(len(t) > 1 for t in long) or any(np.any(t != np.round(t)) for t in long):
        return None
    return float(np.median(np.concatenate([np.diff(t) for t in long])))


def infer_temperature_unit(
    values: "Array", declared: str | None, forced: str | None, quantity: str
) -> UnitConversion | None:
    """Find the unit of a temperature channel.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Raw values without NaN.
    declared : str or None
        Unit in the header.
    forced : str or None
        Unit given by the user, which takes precedence.
    quantity : str
        ``motor_temperature`` or ``housing_temperature``.

    Returns
    -------
    UnitConversion or None
        None where the channel cannot be a temperature: it is empty, always 0, or its median lies
        outside -30..150 °C.

    Examples
    --------
    >>> import numpy as np
    >>> infer_temperature_unit(np.array([300.0, 305.0]), "°C", None, "motor_temperature").unit
    'K'
    """
    import numpy as np

    if not len(values) or not np.any(values):
        return None
    middle = float(np.median(values))
    unit = forced or declared or "°C"
    note = ""
    if forced is None and unit not in ("m°C", "mK") and middle > 1000:
        # unscaled values: the scale of the native header is missing
        unit = "mK" if middle > 1000 * _HIGHEST_TEMPERATURE else "m°C"
        note = f"values of {middle:.0f} are read as {unit}"
    elif forced is None and unit in ("°C", "°F") and middle > 200:
        unit, note = "K", f"values of {middle:.0f} are read as K"
    elif forced is None and unit == "K" and middle < _HIGHEST_TEMPERATURE:
        unit, note = "°C", f"values of {middle:.0f} cannot be K: read as °C"
    conversion = conversion_from(unit, quantity, note)
    converted = middle * conversion.factor + conversion.offset
    return conversion if _LOWEST_TEMPERATURE <= converted <= _HIGHEST_TEMPERATURE else None


def plausible_temperature(values: "Array") -> "Array":
    """Return temperatures with those outside -30..150 °C replaced by NaN.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Temperatures. [°C]

    Returns
    -------
    ndarray, shape (n,)
        Temperatures. [°C]

    Examples
    --------
    >>> import numpy as np
    >>> plausible_temperature(np.array([25.0, 655.35]))
    array([25., nan])
    """
    import numpy as np

    if len(values) and _LOWEST_TEMPERATURE <= values.min() <= values.max() <= _HIGHEST_TEMPERATURE:
        return values
    return np.where(
        (values >= _LOWEST_TEMPERATURE) & (values <= _HIGHEST_TEMPERATURE), values, np.nan
    )
