"""Which fitted effects are physically possible, and determined by the data."""

from collections.abc import Iterator

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit, physical_bounds
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.effects.parameter import Parameter
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG
from frictioncli.quantities import TORQUE
from frictioncli.wording import in_words, number_text

_BEYOND = 0.25
"""How far a share may be below 0 or above 1."""

_EXCEEDING = 1.5
"""By how many times a coefficient may exceed one that it cannot exceed: no form is exactly true."""

_OF_UNIFORM = float(np.sqrt(12.0))
"""Range of a uniform distribution in standard deviations: physics alone tells that much."""

_POSITIONS_LATE = 0.03
"""By how much the positions of a log may be late: some cycles of a bus. [s]"""

_RETURNED = 0.2
"""Least share of what has decayed that must have come back to be seen to come back."""


def beyond_bounds(fit: EffectFit, problem: Problem, errors: float = Z95) -> str:
    """Return which coefficient of an effect is physically impossible; empty if none is.

    It may be beyond its bounds by its error; a share of 0 to 1 by a quarter besides, since no form
    is exactly true.

    Parameters
    ----------
    fit : EffectFit
        The effect.
    problem : Problem
        The joint's rows, with whose friction bounds in units of torque grow.
    errors : float, optional
        By how many standard errors it must be beyond them.
    """
    return beyond(fit, physical_bounds(fit.effect, problem), errors)


def beyond(fit: EffectFit, bounds: tuple[Array, Array], errors: float = Z95) -> str:
    """Return the same of bounds that are known.

    Parameters
    ----------
    fit : EffectFit
        The effect.
    bounds : (ndarray, ndarray), shape (coefficients,)
        Bounds of its coefficients.
    errors : float, optional
        By how many standard errors it must be beyond them.
    """
    lower, upper = bounds
    is_share = (lower == 0.0) & (upper == 1.0)
    reach = errors * standard_errors(fit) + np.where(is_share, _BEYOND, 0.0)
    beyond = (fit.coefficients < lower - reach) | (fit.coefficients > upper + reach)
    parameters = fit.effect.coefficients
    for parameter, value, outside in zip(parameters, fit.coefficients, beyond, strict=True):
        if outside:
            return _impossible_value(parameter, value)
    return _larger_than_whole(fit, errors)


def _impossible_value(parameter: Parameter, value: float) -> str:
    shown = with_unit(parameter, value)
    if parameter.unit.startswith("%"):
        return f"it would be {shown}, which is physically impossible"
    return f"its {parameter.in_words} would be {shown}, which is physically impossible"


def with_unit(parameter: Parameter, value: float) -> str:
    """Return the value of a parameter in words.

    Parameters
    ----------
    parameter : Parameter
        The parameter.
    value : float
        Its value, in the parameter's unit.
    """
    return number_text(value) + _unit(parameter)


def _unit(parameter: Parameter) -> str:
    """Return the unit behind a number; none of torque, which is that of the log."""
    return "" if parameter.unit == "1" or TORQUE in parameter.unit else f" {parameter.unit}"


def _larger_than_whole(fit: EffectFit, errors: float) -> str:
    """Return which coefficient surely exceeds one that it cannot exceed; empty if none does."""
    names = [one.name for one in fit.effect.coefficients]
    for number, parameter in enumerate(fit.effect.coefficients):
        if not parameter.within:
            continue
        whole = names.index(parameter.within)
        signs = np.zeros(len(names))
        signs[[number, whole]] = np.sign(fit.coefficients[[number, whole]]) * [1, -_EXCEEDING]
        excess = float(np.sum(signs * fit.coefficients))
        if excess > errors * float(np.sqrt(max(float(signs @ fit.covariance @ signs), 0.0))):
            return (
                f"its {parameter.in_words} would exceed its {in_words(parameter.within)},"
                " which is physically impossible"
            )
    return ""


def impossible(fit: EffectFit, problem: Problem) -> str:
    """Return which coefficient of an effect of the measurement is impossible; empty if none is.

    It is beyond its bounds by more than its error, or beyond them and surely not zero: what is left
    of it within them would be another estimate.

    Parameters
    ----------
    fit : EffectFit
        The effect, fitted beside the base.
    problem : Problem
        The joint's rows.
    """
    outside = (
        _impossible_value(parameter, value)
        for parameter, value, error, low, high in _coefficients(fit, problem)
        if not low <= value <= high and abs(value) > Z95 * error
    )
    return beyond_bounds(fit, problem) or next(outside, "")


def smoother_than_late(smeared: EffectFit, late: EffectFit, *, alone: bool = True) -> str:
    r"""Return why a filter cannot be told from a delay, or is none; empty if it may be there.

    A filter of time constant :math:`\theta` makes the torque late by as much, so that the mean
    lateness is :math:`D \ge \theta - \delta`, where positions are late by :math:`\delta`. The
    second moment is :math:`(\theta^2 + D^2) / 2`.

    Parameters
    ----------
    smeared, late : EffectFit
        Filter and delay, fitted together.
    alone : bool, optional
        Whether no property of the joint stands beside them. Else a filter that these data do not
        determine to that would take the torque of inertia.
    """
    lateness = float(late.coefficients[0])
    reach = Z95 * float(standard_errors(late)[0])
    time_constant = max(lateness + reach, 0.0) + _POSITIONS_LATE
    greatest = ((abs(lateness) + reach) ** 2 + time_constant**2) / 2
    value, error = float(smeared.coefficients[0]), float(standard_errors(smeared)[0])
    moment, delay = smeared.effect.coefficients[0], late.effect.coefficients[0]
    shown = with_unit(delay, lateness)
    if value - Z95 * error > greatest:
        return f"{_impossible_value(moment, value)} of a torque that is late by {shown} on average"
    if not alone and _OF_UNIFORM * error > greatest:
        return (
            f"these data determine its {moment.in_words} only to"
            f" ±{Z95 * error:.2g}{_unit(moment)}, and a torque that is late by {shown} has"
            f" {greatest:.2g}{_unit(moment)} at most"
        )
    return ""


def undetermined(fit: EffectFit, problem: Problem) -> str:
    """Return which coefficient of an effect of the measurement no data tell; empty if none.

    Its standard error is more than that of a value anywhere between its bounds: what is possible
    does nothing that these data would show.

    Parameters
    ----------
    fit : EffectFit
        The effect, fitted beside the base.
    problem : Problem
        The joint's rows.
    """
    unknown = (
        f"these data determine its {parameter.in_words} only to"
        f" ±{Z95 * error:.2g}{_unit(parameter)}; possible is {low:.3g} to"
        f" {high:.3g}{_unit(parameter)}"
        for parameter, _, error, low, high in _coefficients(fit, problem)
        if _OF_UNIFORM * error > high - low
    )
    return next(unknown, "")


def is_seen_once(fit: EffectFit, problem: Problem) -> bool:
    """Return whether what comes back after every rest has only decayed, once.

    Parameters
    ----------
    fit : EffectFit
        The effect, fitted beside the base.
    problem : Problem
        The joint's rows.
    """
    if not fit.effect.recurs or len(problem.runs) > 1:
        return False
    of_pairs = problem.layout.means(problem.basis(fit.effect, fit.shape).friction[:, :1])[:, 0]
    in_time = of_pairs[np.argsort(problem.layout.time, kind="stable")]
    returned = np.maximum(np.diff(in_time), 0.0).sum()
    return bool(returned < _RETURNED * np.ptp(in_time))


def times_its_range(fit: EffectFit, problem: Problem) -> float:
    """Return how many times its possible range a coefficient is, at most."""
    return max(abs(value) / (high - low) for _, value, _, low, high in _coefficients(fit, problem))


def _coefficients(
    fit: EffectFit, problem: Problem
) -> Iterator[tuple[Parameter, float, float, float, float]]:
    """Yield each coefficient with its value, standard error and bounds."""
    bounds = physical_bounds(fit.effect, problem)
    yield from zip(
        fit.effect.coefficients, fit.coefficients, standard_errors(fit), *bounds, strict=True
    )


ON_BOUND = "the fit lies on a bound of what is physically possible"
"""Why the size of an effect is not known of which a greater or smaller one may be there."""


def lies_on_bound(fit: EffectFit) -> bool:
    """Return whether bounds set all coefficients of an effect, so that no data determine them.

    All friction at a temperature that is measured is no bound that something else asks for.

    Parameters
    ----------
    fit : EffectFit
        The effect, fitted beside the base.
    """
    return not standard_errors(fit).any() and fit.effect.name != THERMAL_LAG.name


def standard_errors(fit: EffectFit) -> Array:
    """Return the standard errors of the coefficients of an effect, shape (coefficients,)."""
    return np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
