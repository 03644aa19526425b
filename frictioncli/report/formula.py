"""Friction function of a joint as a formula with numbers and units."""

import re

from markupsafe import Markup, escape

from frictioncli.model.document import FrictionModel
from frictioncli.report.labels import TEMPERATURE_WORDS
from frictioncli.report.results import JointResults
from frictioncli.wording import number_text

_DIGITS = 4
_POWERS = {"^0.5": Markup("<sup>½</sup>"), "^2": Markup("²")}


def unit_markup(unit: str) -> Markup:
    """Return a unit with its powers as superscripts.

    Parameters
    ----------
    unit : str
        Unit as written in ``model.json``, such as ``N·m/(deg/s)^0.5``.
    """
    parts = re.split(r"(\^0\.5|\^2)", unit)
    return Markup("").join(_POWERS.get(part, escape(part)) for part in parts)


def friction_formula(model: FrictionModel) -> Markup:
    """Return equation (16) with a model's parameters; terms that are zero are left out.

    Parameters
    ----------
    model : FrictionModel
        The model.
    """
    values = model.friction

    def with_unit(name: str, sign: float = 1.0) -> Markup:
        parameter = model.parameters[name]
        unit = (
            parameter.unit.removeprefix("1")
            if parameter.unit.startswith("1/")
            else f" {parameter.unit}"
        )
        return Markup("<b>{}</b>{}").format(
            number_text(sign * parameter.estimate, _DIGITS), unit_markup(unit)
        )

    terms = []
    if values.tau_c:
        terms.append(with_unit("tau_c"))
    if values.alpha:
        terms.append(with_unit("alpha") + Markup(" · <i>L</i>²"))
    viscous = []
    if values.beta:
        viscous.append(with_unit("beta"))
    if values.gamma:
        exponential = Markup(" · e<sup>{} · <i>T</i></sup>").format(with_unit("delta", -1.0))
        viscous.append(with_unit("gamma") + exponential)
    if len(viscous) == 2:
        terms.append(Markup("({}) · √<i>v</i>").format(Markup(" + ").join(viscous)))
    elif viscous:
        terms.append(viscous[0] + Markup(" · √<i>v</i>"))
    terms_sum = Markup(" + ").join(Markup('<span class="term">{}</span>').format(t) for t in terms)
    return Markup("<i>τ</i> = {}").format(terms_sum or "0")


def formula_symbols(results: JointResults) -> str:
    """Return the meaning of the formula's symbols, with units.

    Parameters
    ----------
    results : JointResults
        The joint's results.
    """
    unit, side = results.unit, results.model.torque_side
    at = "" if unit == "A" else f", at the {side}'s side"
    warm = (
        f"; T: {TEMPERATURE_WORDS[results.model.temperature]} in °C"
        if results.model.knows_temperature
        else ""
    )
    return (
        f"τ: friction torque in {unit}{at}; L: load torque in {results.load_unit};"
        f" v: speed in deg/s{warm}. Equation (16)."
    )
