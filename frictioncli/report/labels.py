"""Labels, and numbers and names as text, for figures and tables of the report."""

import math
from collections.abc import Sequence

from matplotlib.font_manager import FontProperties, findfont, get_font

from frictioncli.plain_text import without_control_characters

PARAMETER_SYMBOLS = {"tau_c": "τc", "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ"}

TEMPERATURE_LABELS = {
    "motor": "motor temperature Tm [°C]",
    "housing": "housing temperature Tc [°C]",
    "mean": "mean temperature T* = (Tm + Tc)/2 [°C]",
}

TEMPERATURE_SYMBOLS = {"motor": "Tm", "housing": "Tc", "mean": "T*"}

TEMPERATURE_WORDS = {
    "motor": "motor temperature Tm",
    "housing": "housing temperature Tc",
    "mean": "mean of motor and housing temperature T*",
}

CRITERION_WORDS = {
    "first_degree": "first degree",
    "latest_degree": "latest degree",
    "equal": "equally spaced",
    "none": "no correction",
    "uncertainty": "uncertainty",
}

_LONGEST_NAME = 32
_MOST_NAMES = 5


def figure_text(text: str) -> str:
    """Return a name as text that a figure shows unchanged, shortened to 32 characters.

    Dollar signs are escaped, since they would start a formula. Control characters and characters
    that the font lacks are replaced by question marks.

    Parameters
    ----------
    text : str
        Any text, such as the name of a run.
    """
    font = get_font(findfont(FontProperties(family=["sans-serif"])))
    shown = "".join(
        c if font.get_char_index(ord(c)) and without_control_characters(c) == c else "?"
        for c in text
    )
    if len(shown) > _LONGEST_NAME:
        shown = shown[: _LONGEST_NAME - 1] + "…"
    return shown.replace("$", r"\$")


def friction_label(unit: str) -> str:
    """Return the label of an axis of friction torque.

    Parameters
    ----------
    unit : str
        N·m or A.
    """
    return f"friction torque τ [{unit}]"


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
    """Return an identifier, such as an effect's name, with spaces for underscores.

    Parameters
    ----------
    name : str
        The identifier.
    """
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
    """Return a count with thin spaces between groups of three digits."""
    return f"{count:,}".replace(",", "\u202f")


def duration_text(seconds: float) -> str:
    """Return a duration in minutes, or in hours and minutes from three hours on.

    Parameters
    ----------
    seconds : float
        The duration. [s]

    Examples
    --------
    >>> duration_text(5490.0), duration_text(17490.0)
    ('92 min', '4 h 52 min')
    """
    minutes = seconds / 60.0
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
