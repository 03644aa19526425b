"""Numbers, counts and names as text, for messages, tables and figures."""

import math
import re
from collections.abc import Sequence

_MOST_NAMES = 5

_SPELLINGS = {
    "run_in": "run-in",
    "stribeck": "Stribeck friction",
    "coulomb": "Coulomb",
    # a moment is also a torque
    "moment": "start",
}
"""Identifiers, or their beginnings, that are written otherwise in a sentence."""

_SHORT = 0.5
"""Times below are stated in milliseconds. [s]"""

_NEAR_ZERO = 0.02
"""Least distance of an end of an interval from zero that shows, as a share of its half-width."""


def speed_text(speed: float) -> str:
    """Return a speed with its unit, with one decimal or, below 1 deg/s, with two digits.

    Parameters
    ----------
    speed : float
        Joint speed. [deg/s]

    Examples
    --------
    >>> speed_text(67.5), speed_text(0.123)
    ('67.5 deg/s', '0.12 deg/s')
    """
    shown = f"{speed:.1f}".removesuffix(".0") if speed >= 1.0 else f"{speed:.2g}"
    return f"{shown} deg/s"


def number_text(value: float | None, digits: int = 3) -> str:
    """Return a number with the given significant digits, or a dash if it is missing.

    Digits before the decimal point are never rounded.

    Parameters
    ----------
    value : float or None
        The number.
    digits : int
        Significant digits.

    Examples
    --------
    >>> number_text(0.06182), number_text(1234.5), number_text(None)
    ('0.0618', '1234', '–')
    """
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if magnitude < -4:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    shown = f"{value:.{max(digits - 1 - magnitude, 0)}f}"
    return shown.replace("-", "−")


def probability_text(share: float) -> str:
    """Return a probability in per cent; 99.5 % and more are written as "over 99 %".

    Parameters
    ----------
    share : float
        Probability, from 0 to 1.
    """
    if share >= 0.995:
        return "over 99 %"
    return f"{100 * share:.0f} %" if share >= 0.015 else f"{100 * share:.1f} %"


def in_words(name: str) -> str:
    """Return an identifier, such as an effect's name, as it is written in a sentence.

    Parameters
    ----------
    name : str
        The identifier, or a text with some.

    Examples
    --------
    >>> in_words("thermal_lag"), in_words("run_in"), in_words("coulomb_temperature")
    ('thermal lag', 'run-in', 'Coulomb temperature')
    >>> in_words("step_change: moment"), in_words("second_moment")
    ('step change: start', 'second moment')
    """
    for identifier, written in _SPELLINGS.items():
        name = re.sub(rf"\b{identifier}", written, name)
    return name.replace("_", " ")


def count_text(count: int, singular: str, plural: str = "") -> str:
    """Return a count with its noun.

    Parameters
    ----------
    count : int
        The count.
    singular, plural : str
        The noun; the default plural is the singular with an s.

    Examples
    --------
    >>> count_text(1, "pair"), count_text(2, "pair")
    ('1 pair', '2 pairs')
    """
    noun = singular if count == 1 else plural or singular + "s"
    return f"{thousands_text(count)} {noun}"


def thousands_text(count: int) -> str:
    """Return a count with commas between groups of three digits."""
    return f"{count:,}"


def duration_text(seconds: float) -> str:
    """Return a duration in minutes; in seconds below one, in hours and minutes from three hours on.

    Parameters
    ----------
    seconds : float
        The duration. [s]

    Examples
    --------
    >>> duration_text(23.0), duration_text(5490.0), duration_text(17490.0)
    ('23 s', '92 min', '4 h 52 min')
    """
    minutes = seconds / 60.0
    if minutes < 1.0:
        return f"{number_text(seconds, 2)} s"
    if minutes >= 180.0:
        hours, rest = divmod(round(minutes), 60)
        return f"{hours} h {rest:02d} min"
    return f"{minutes:.0f} min"


def list_text(names: Sequence[str]) -> str:
    """Return names as an enumeration in words, cut after five names.

    Parameters
    ----------
    names : sequence of str
        At least one name.

    Examples
    --------
    >>> list_text(["a", "b", "c"])
    'a, b and c'
    """
    shown = list(names[:_MOST_NAMES])
    if len(names) > _MOST_NAMES:
        shown.append(f"{len(names) - _MOST_NAMES} more")
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


def range_text(ascending: Sequence[str]) -> str:
    """Return the range of ascending values as text; one value if the ends read the same.

    Parameters
    ----------
    ascending : sequence of str
        At least one value, as text.

    Examples
    --------
    >>> range_text(["2", "4", "7"]), range_text(["2", "2"])
    ('2 to 7', '2')
    """
    first, last = ascending[0], ascending[-1]
    return first if first == last else f"{first} to {last}"


def interval_text(low: float, high: float) -> str:
    """Return an interval with as many decimals as its width deserves.

    Parameters
    ----------
    low, high : float
        Its ends.

    Examples
    --------
    >>> interval_text(0.0112, 0.0131), interval_text(1.52, 2.31), interval_text(-120.0, 940.0)
    ('0.0112 to 0.0131', '1.5 to 2.3', '−120 to 940')
    """
    return " to ".join(_alike((low, high), (low, high)))


def quantity_text(value: float, interval: tuple[float, float] | None, unit: str) -> str:
    """Return an estimate with its unit and, in brackets, its interval.

    Times below half a second are stated in milliseconds. An interval without width, of an estimate
    on a bound, is left out: it would say that the value is known exactly.

    Parameters
    ----------
    value : float
        The estimate. [unit]
    interval : (float, float) or None
        Its interval, if it is known. [unit]
    unit : str
        Its unit; ``1`` for a pure number.

    Examples
    --------
    >>> quantity_text(1.94, (1.52, 2.31), "N·m")
    '1.9 N·m (1.5 to 2.3)'
    >>> quantity_text(1.2, (0.4, 3.6), "N·m")
    '1.2 N·m (0.4 to 3.6)'
    >>> quantity_text(0.0121, (0.0112, 0.0131), "s"), quantity_text(0.254, None, "1")
    ('12.1 ms (11.2 to 13.1)', '0.25')
    >>> quantity_text(0.162, (0.162, 0.162), "N·m")
    '0.16 N·m'
    """
    known = (value, *(interval or ()))
    if unit == "s" and max(abs(one) for one in known) < _SHORT:
        return quantity_text(
            1000 * value,
            None if interval is None else (1000 * interval[0], 1000 * interval[1]),
            "ms",
        )
    noun = "" if unit == "1" else f" {unit}"
    finite = all(math.isfinite(one) for one in known)
    if interval is None or not finite or interval[0] == interval[1]:
        return f"{number_text(value, 2)}{noun}"
    estimate, low, high = _alike(known, interval)
    return f"{estimate}{noun} ({low} to {high})"


def change_text(value: float, interval: tuple[float, float], unit: str) -> str:
    """Return a change with signs, its unit and, in brackets, its interval.

    Parameters
    ----------
    value : float
        The change. [unit]
    interval : (float, float)
        Its interval. [unit]
    unit : str
        Its unit; empty where a heading has it.

    Examples
    --------
    >>> change_text(18.23, (16.04, 20.42), "%"), change_text(-0.3, (-0.6, 0.04), "")
    ('+18.2 % (+16.0 to +20.4)', '−0.30 (−0.60 to +0.04)')
    """
    # two digits of the half-width, whatever its first, show on which side of zero an end lies
    texts = _alike((value, *interval), (0.22 * interval[0], 0.22 * interval[1]))
    estimate, low, high = (
        f"+{text}" if any(digit in text for digit in "123456789") and text[0] != "−" else text
        for text in texts
    )
    return f"{estimate}{unit and ' '}{unit} ({low} to {high})"


def _alike(values: Sequence[float], interval: tuple[float, float]) -> list[str]:
    """Return values with the decimals that show an interval's half-width with one digit.

    Two digits where the first is 1: one would be off by up to half of the half-width.
    """
    half = (interval[1] - interval[0]) / 2
    if not math.isfinite(half) or not half >= 1e-5:
        return [number_text(value) for value in values]
    decimals = max(-math.floor(math.log10(half / 2)), 0)
    nearest = min(abs(interval[0]), abs(interval[1]))
    if interval[0] * interval[1] > 0 and nearest > _NEAR_ZERO * half:
        # an interval without zero does not read as one that begins there
        decimals = max(decimals, -math.floor(math.log10(nearest / 0.95)))
    rounded = [round(value, decimals) + 0.0 for value in values]
    return [f"{value:.{decimals}f}".replace("-", "−") for value in rounded]
