"""Labels for figures and tables of the report."""

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
