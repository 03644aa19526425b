"""Parameters of a cause with their intervals, from the fit of its effect or from the extension."""

from collections.abc import Mapping
from string import Formatter

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.documents.torque_units import TorqueUnits
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.fit.hypotheses import EffectFit, physical_bounds
from frictioncli.effects.base import Effect
from frictioncli.wording import quantity_text

Z95 = 1.96
"""Half-width of a 95 % interval in standard errors."""


_NO_SIZE = "These data determine the torque that it adds, but not its parameters."


def fitted_parameters(
    fit: EffectFit, problem: Problem, units: TorqueUnits
) -> dict[str, ParameterRecord]:
    """Return the parameters of an effect by its own fit, the shape without intervals.

    Intervals end at the physical bounds; that of an estimate beyond these says by how much.

    Parameters
    ----------
    fit : EffectFit
        The effect, fitted beside the causes.
    problem : Problem
        The joint's rows.
    units : TorqueUnits
        Units of torque.
    """
    reach = Z95 * np.sqrt(np.maximum(np.diag(np.atleast_2d(fit.covariance)), 0.0))
    interval = (fit.coefficients - reach, fit.coefficients + reach)
    return _shape(fit) | _coefficients(fit, _possible(fit, interval, problem), units)


def extension_parameters(
    extension: Extension, name: str, problem: Problem, units: TorqueUnits
) -> dict[str, ParameterRecord]:
    """Return the parameters of an effect of the extended model, all refitted together.

    What the data cannot tell of a shape spans its whole range, and what they cannot tell of a
    coefficient ends at its physical bounds.

    Parameters
    ----------
    extension : Extension
        The extended model.
    name : str
        Name of the effect.
    problem : Problem
        The joint's rows.
    units : TorqueUnits
        Units of torque.
    """
    number = [one.effect.name for one in extension.effects].index(name)
    return _shapes(extension, number) | extension_coefficients(extension, number, problem, units)


def extension_coefficients(
    extension: Extension, number: int, problem: Problem, units: TorqueUnits
) -> dict[str, ParameterRecord]:
    """Return the coefficients of one effect of the extended model.

    Parameters
    ----------
    extension : Extension
        The extended model.
    number : int
        Place of the effect, from 0.
    problem : Problem
        The joint's rows.
    units : TorqueUnits
        Units of torque.
    """
    fit = extension.effects[number]
    return _coefficients(fit, _possible(fit, extension.intervals(number), problem), units)


def statement(
    effect: Effect, parameters: Mapping[str, ParameterRecord], words: str | None = None
) -> str:
    """Return what is said of an effect that was found, with the values of its parameters.

    The torque of an effect may be certain where its coefficients are not, as they compensate its
    shape: no number is stated of coefficients that are not determined.

    Parameters
    ----------
    effect : Effect
        The effect.
    parameters : mapping of str to ParameterRecord
        Its parameters.
    words : str, optional
        The sentence, if it is not that of the effect.
    """
    values = {
        name: quantity_text(one.estimate, one.ci95, one.unit) for name, one in parameters.items()
    }
    text = words or effect.statement or effect.summary
    fields = {name for _, name, _, _ in Formatter().parse(text)}
    stated = [parameters[one.name] for one in effect.coefficients if one.name in fields]
    if stated and not any(one.ci95 is None or one.is_determined for one in stated):
        return f"{effect.summary} {_NO_SIZE}"
    return text.format_map(values)


def _possible(
    fit: EffectFit, interval: tuple[Array, Array], problem: Problem
) -> tuple[Array, Array]:
    """Return the intervals of coefficients that are possible, ended at their physical bounds."""
    (low, high), values = interval, fit.coefficients
    lower, upper = physical_bounds(fit.effect, problem)
    possible = (values >= lower) & (values <= upper)
    return (
        np.where(possible, np.maximum(low, lower), low),
        np.where(possible, np.minimum(high, upper), high),
    )


def _coefficients(
    fit: EffectFit, interval: tuple[Array, Array], units: TorqueUnits
) -> dict[str, ParameterRecord]:
    return {
        parameter.name: ParameterRecord(
            estimate=float(value),
            ci95=(float(low), float(high)),
            unit=units.of(fit.effect, parameter),
        )
        for parameter, value, low, high in zip(
            fit.effect.coefficients, fit.coefficients, *interval, strict=True
        )
    }


def _shapes(extension: Extension, number: int) -> dict[str, ParameterRecord]:
    """Return the shape of an effect of the extended model with intervals.

    The moments of a change have none: they are known to a pair.
    """
    start = sum(len(one.effect.shape) for one in extension.effects[:number])
    one = extension.effects[number]
    found = _shape(one)
    if one.effect.moments is not None:
        return found
    for axis, error in zip(one.effect.shape, extension.shape_errors[start:], strict=False):
        value = one.shape[axis.name]
        reach = Z95 * float(error) if error > 0 else np.inf
        interval = (max(value - reach, axis.lower), min(value + reach, axis.upper))
        found[axis.name] = ParameterRecord(estimate=value, ci95=interval, unit=axis.unit)
    return found


def _shape(fit: EffectFit) -> dict[str, ParameterRecord]:
    """Return the shape of an effect without intervals; a change has any number of moments."""
    units = {axis.name: axis.unit for axis in fit.effect.shape}
    first = next(iter(units.values()), "1")
    return {
        # further moments of a history have the unit of the first
        name: ParameterRecord(estimate=value, ci95=None, unit=units.get(name, first))
        for name, value in fit.shape.items()
    }
