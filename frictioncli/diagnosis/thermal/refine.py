"""A problem made linear about the hidden temperature, once a lag of the gear has been accepted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frictioncli.diagnosis.data.build_problem import at_temperature
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension, Refit, extend, refit, rms_misfit
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.thermal.estimate import ThermalEstimate, estimate_temperature
from frictioncli.effects.base import (
    Basis,
    Effect,
    EffectTable,
    friction_only,
    missing_columns,
)
from frictioncli.effects.thermal_lag import EFFECT

LAG = EFFECT.name
"""Name of the effect that a hidden temperature describes."""

_ROUNDS = 2
"""Estimates in turn with the columns of other effects, which depend on the temperature."""

_MOST_STEPS = 6
"""Greatest number of Gauss-Newton steps."""

_SETTLED = 1e-6
"""Changes of the parameters, as a share of their standard errors, at which they end."""

_NOT_BESIDE = frozenset({"sensor_lag", "torque_filter"})
"""Effects of the measurement that are not estimated beside the temperature: a rival of it, and one
of second order, which what the model lacks within pairs would decide."""

_LEAST_ERROR = 1e-9
"""Least standard error that counts."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinedLag:
    """A lag of the gear, estimated as a temperature.

    Attributes
    ----------
    problem, new : Problem, Problem or None
        The rows and those of the hold-out run, linear about the temperature of the gear.
    estimate : ThermalEstimate
        The temperature, and its rivals.
    fit : EffectFit
        The effect ``thermal_lag`` with the parts of the network that were found.
    """

    problem: Problem
    new: Problem | None
    estimate: ThermalEstimate
    fit: EffectFit


def refine_thermal(
    problem: Problem,
    new: Problem | None,
    accepted: Sequence[EffectFit] = (),
    measurement: Sequence[Effect] = (),
) -> RefinedLag | None:
    """Return a problem linear about the hidden temperature that explains a lag of the gear.

    Parameters
    ----------
    problem : Problem
        The rows, linear about the measured temperature.
    new : Problem or None
        Rows of the hold-out run.
    accepted : sequence of EffectFit, optional
        Effects that were accepted, the lag perhaps among them.
    measurement : sequence of Effect, optional
        Effects of the measurement that stand beside the base. Those of first order are estimated
        beside the temperature: over angles that are not symmetric to gravity, torque that is late
        looks like friction that grows with the speed.

    Returns
    -------
    RefinedLag or None
        None if the measured temperature explains friction as well, or if the data do not tell how
        friction falls with temperature.
    """
    if missing_columns(EFFECT, problem.table) or not {"gamma", "delta"} <= set(problem.names):
        return None
    others = [one for one in accepted if one.effect.name != LAG]
    linear = problem
    always = [problem.basis(one, {}) for one in measurement if one.name not in _NOT_BESIDE]
    for _ in range(_ROUNDS if others else 1):
        beside = [linear.basis(one.effect, one.shape) for one in others]
        estimate = estimate_temperature(problem, [*always, *beside])
        if estimate.hidden is None:
            return None
        linear = at_temperature(problem, estimate.parameters, estimate.hidden)
    return RefinedLag(
        problem=linear,
        new=new and at_temperature(new, estimate.parameters, estimate.hidden),
        estimate=estimate,
        fit=lag_fit(estimate),
    )


def lag_fit(estimate: ThermalEstimate) -> EffectFit:
    """Return the effect ``thermal_lag`` with the parts of the network that were found.

    Columns of other parts are zero, so that a fit of the effect leaves them out.
    """
    fit = estimate.chosen.fit
    parts = np.flatnonzero(fit.coefficients).tolist()
    errors = np.zeros(len(EFFECT.coefficients))
    for number, one in enumerate(EFFECT.coefficients):
        if one.name in estimate.estimates:
            stated = estimate.estimates[one.name]
            errors[number] = (stated.high - stated.low) / (2 * 1.96)
    return EffectFit(
        effect=restricted(parts),
        shape={"time_constant": fit.time_constant},
        coefficients=fit.coefficients,
        covariance=np.diag(np.square(errors)),
        statistic=0.0,
    )


def restricted(parts: Sequence[int]) -> Effect:
    """Return the effect ``thermal_lag`` with zeros in the columns of all but some parts."""
    return replace(EFFECT, basis=partial(_restricted_basis, tuple(parts)))


def _restricted_basis(parts: tuple[int, ...], table: EffectTable, **shape: float) -> Basis:
    friction = EFFECT.evaluate(table, shape).friction
    kept = np.isin(np.arange(friction.shape[1]), parts)
    return friction_only(*(friction * kept).T)


def settled(
    refined: RefinedLag,
    effects: Sequence[EffectFit],
    weighted_fit: WeightedFit,
) -> tuple[RefinedLag, Extension]:
    """Return an extension at the estimated temperature, and the problems linear about it.

    The network keeps the coefficients that were estimated within their bounds: one run hardly tells
    some of their combinations apart, and free ones would leave the range in which friction is
    linear. All other parameters are refitted beside it, the problem made linear about them in turn
    (Gauss-Newton steps). The errors are those with all parameters free.

    Parameters
    ----------
    refined : RefinedLag
        The problems at the estimated temperature.
    effects : sequence of EffectFit
        Effects of the extension, the lag among them.
    weighted_fit : WeightedFit
        Weights of the rows.
    """
    place = [one.effect.name for one in effects].index(LAG)
    others = [one for one in effects if one.effect.name != LAG]
    free = extend(refined.problem, weighted_fit, effects)
    limit = _SETTLED * np.maximum(free.errors[: len(free.changes)], _LEAST_ERROR)
    for _ in range(_MOST_STEPS):
        held = refit(_with_lag_taken_off(refined.problem), weighted_fit, others)
        refined = _moved(refined, held)
        if np.all(np.abs(held.changes) <= limit):
            break
    return refined, replace(
        free,
        changes=np.zeros_like(free.changes),
        gravity=held.gravity,
        effects=(*held.effects[:place], refined.fit, *held.effects[place:]),
    )


def missed_with_lag(
    refined: RefinedLag, weighted_fit: WeightedFit, effects: Sequence[EffectFit]
) -> float:
    """Return the RMS misfit of the hold-out run by the extension at the temperature [N·m].

    Parameters
    ----------
    refined : RefinedLag
        The problems at the estimated temperature.
    weighted_fit, effects
        As of :func:`settled`.

    Raises
    ------
    ValueError
        If there is no hold-out run.
    """
    about, extension = settled(refined, effects, weighted_fit)
    if about.new is None:
        raise ValueError("no run was held out")
    return rms_misfit(about.new, extension)


def _with_lag_taken_off(problem: Problem) -> Problem:
    """Return a problem whose measured friction has the torque of the lag taken off."""
    table = problem.table
    torque = table.temperature_slope * (table.temperature - table.measured_temperature)
    return replace(problem, friction=problem.friction - torque)


def _moved(refined: RefinedLag, extension: Refit) -> RefinedLag:
    """Return the problems at the parameters of an extension, at the same temperature."""
    problem, new = refined.problem, refined.new
    about = {
        name: getattr(problem.parameters, name) + float(change)
        for name, change in zip(extension.names, extension.changes, strict=True)
    }
    parameters = replace(problem.parameters, **about)
    return replace(
        refined,
        problem=at_temperature(problem, parameters, problem.hidden),
        new=new and at_temperature(new, parameters, problem.hidden),
    )
