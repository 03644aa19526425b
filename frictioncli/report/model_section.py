"""Both models side by side: formulas, parameters with intervals, what is poorly determined."""

from dataclasses import dataclass

from markupsafe import Markup

from frictioncli.diagnosis.documents.extended_document import EffectRecord, ParameterRecord
from frictioncli.effects import BY_NAME
from frictioncli.model.document import PARAMETERS, FrictionModel
from frictioncli.report.formula import friction_formula, unit_markup
from frictioncli.report.labels import PARAMETER_SYMBOLS
from frictioncli.report.page_tables import TextTable
from frictioncli.report.results import JointResults
from frictioncli.wording import in_words, list_text, number_text

_IMPRECISE = 0.5
"""Half-width of an interval as a share of the estimate from which on it is said to be wide."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelCard:
    """One model as the page shows it.

    Attributes
    ----------
    name, use : str
        Its name, and how well it predicts.
    formula : Markup
        Friction function with numbers and units.
    terms : tuple of (str, str, str)
        Name, equation and parameters of each effect that it adds.
    text : str
        The formula as plain text, for other programs.
    """

    name: str
    use: str
    formula: Markup
    terms: tuple[tuple[str, str, str], ...]
    text: str


def model_cards(results: JointResults) -> list[ModelCard]:
    """Return the base model and, if there is one, the extended model.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    unit = results.unit
    gain = results.diagnosis.document.gain if results.diagnosis else None
    on = ""
    if gain is not None and results.diagnosis is not None:
        on = " on its own training data"
        if gain.basis == "new_run":
            on = f" on run {results.diagnosis.document.held_out}, not used for fitting"
    base_error = gain.rmse_before if gain else results.model.rmse
    cards = [
        ModelCard(
            name="Base model, equation (16)",
            use=f"RMS torque error {number_text(base_error)} {unit}{on}",
            formula=friction_formula(results.model),
            terms=(),
            text=formula_text(results.model),
        )
    ]
    extended = results.extended_model
    if extended is None or not extended.effects or results.diagnosis is None:
        return cards
    cards.append(
        ModelCard(
            name="Extended model",
            use=f"RMS torque error {number_text(gain.rmse_after)} {unit}{on}"
            if gain
            else "not tested on other data",
            formula=friction_formula(extended),
            terms=tuple(_term(effect) for effect in extended.effects),
            text="\n".join(
                [
                    formula_text(extended),
                    *(f"+ {effect.name}: {effect.equation}" for effect in extended.effects),
                    *(
                        f"  {name} = {value} {one}".rstrip()
                        for effect in extended.effects
                        for name, value, one in _values(effect)
                    ),
                ]
            ),
        )
    )
    return cards


def _values(effect: EffectRecord) -> list[tuple[str, str, str]]:
    """Return name, value and unit of each parameter of an effect; a number has no unit."""
    units = {axis.name: axis.unit for axis in BY_NAME[effect.name].shape}
    found = [(name, value, units.get(name, "")) for name, value in effect.shape.items()]
    found += [(name, one.estimate, one.unit) for name, one in effect.coefficients.items()]
    return [(name, f"{value:.5g}", "" if unit == "1" else unit) for name, value, unit in found]


def _term(effect: EffectRecord) -> tuple[str, str, str]:
    values = "; ".join(
        f"{in_words(name)} {number_text(float(value), 4)} {unit}".rstrip()
        for name, value, unit in _values(effect)
    )
    return in_words(effect.name), effect.equation, values


def formula_text(model: FrictionModel) -> str:
    """Return equation (16) with numbers as text that a program can read.

    Parameters
    ----------
    model : FrictionModel
        The model; speed v in deg/s, temperature T in °C.
    """
    p = model.friction
    return (
        f"tau = {p.tau_c:.6g} + {p.alpha:.6g}*L**2"
        f" + ({p.beta:.6g} + {p.gamma:.6g}*exp({-p.delta:.6g}*T))*sqrt(abs(v))"
    )


def parameters_table(results: JointResults) -> TextTable | None:
    """Return the parameters of both models side by side; None without an extended model.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    extended = results.extended_model
    if extended is None or not extended.effects or results.diagnosis is None:
        return None
    rows: list[tuple[str, ...]] = [
        (
            PARAMETER_SYMBOLS[name],
            *_cells(results.model.parameters[name]),
            *_cells(extended.parameters[name]),
            unit_markup(results.model.parameters[name].unit),
        )
        for name in PARAMETERS
    ]
    stated = {
        (effect, name): one
        for cause in results.diagnosis.document.modelled_causes
        for effect in cause.effects
        for name, one in cause.parameters.items()
    }
    for effect in extended.effects:
        for name, value, unit in _values(effect):
            one = stated.get((effect.name, name)) or effect.coefficients.get(name)
            cells = _cells(one) if one is not None else (value, "–")
            rows.append((f"{in_words(effect.name)}: {in_words(name)}", "–", "–", *cells, unit))
    return TextTable(
        title="Parameters of both models",
        groups=(("", 1), ("base model", 2), ("extended model", 2), ("", 1)),
        header=("parameter", "estimate", "95 % interval", "estimate", "95 % interval", "unit"),
        rows=tuple(rows),
    )


def undetermined_base(results: JointResults) -> str:
    """Return which parameters of equation (16) the extended model leaves open; empty if none.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    extended = results.extended_model
    if extended is None or not extended.effects or results.diagnosis is None:
        return ""
    # a parameter left out of the model has no interval
    open_ends = [
        PARAMETER_SYMBOLS[name]
        for name in PARAMETERS
        if (ci95 := extended.parameters[name].ci95) is not None and ci95[0] < 0 < ci95[1]
    ]
    if not open_ends:
        return ""
    return (
        f"In the extended model these data do not determine {list_text(open_ends)}, not even the"
        " sign: use it only within the measured ranges."
    )


def _cells(stated: object) -> tuple[str, str]:
    estimate, ci95 = getattr(stated, "estimate", None), getattr(stated, "ci95", None)
    if ci95 is None:
        return number_text(estimate, 4), "–"
    if ci95[0] == ci95[1]:
        return number_text(estimate, 4), "at its bound"
    if isinstance(stated, ParameterRecord) and stated.has_only_a_sign:
        return number_text(estimate, 4), "not determined"
    return number_text(estimate, 4), f"{number_text(ci95[0])} to {number_text(ci95[1])}"


def poorly_determined(parameters: dict[str, ParameterRecord]) -> str:
    """Return which parameters of a cause are not or hardly determined; empty if all are well.

    Parameters
    ----------
    parameters : dict of str to ParameterRecord
        Its parameters.

    Examples
    --------
    >>> wide = ParameterRecord(estimate=10.0, ci95=(2.0, 18.0), unit="s")
    >>> bound = ParameterRecord(estimate=0.0, ci95=(0.0, 0.0), unit="1")
    >>> poorly_determined({"time_constant": wide, "lag_share": bound})
    'time constant only to ±80 %; lag share at its bound'
    """
    wide, lost, bound = [], [], []
    for name, one in parameters.items():
        if one.ci95 is None:
            lost.append(in_words(name))
            continue
        low, high = one.ci95
        if low == high:
            bound.append(in_words(name))
        elif not one.is_determined:
            lost.append(in_words(name))
        elif high - low > 2 * _IMPRECISE * abs(one.estimate):
            percent = 50 * (high - low) / abs(one.estimate)
            wide.append(f"{in_words(name)} only to ±{percent:.0f} %")
    parts = list(wide)
    if lost:
        parts.append(f"{list_text(lost)} not determined")
    if bound:
        parts.append(f"{list_text(bound)} at {'its bound' if len(bound) == 1 else 'their bounds'}")
    return "; ".join(parts)
