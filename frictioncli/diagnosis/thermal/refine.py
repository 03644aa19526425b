"""A problem made linear about the hidden temperature, once a lag of the gear has been accepted."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frictioncli.diagnosis.data.build_problem import at_temperature
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.thermal.estimate import MEASURED, ThermalEstimate, estimate_temperature
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

_MOST = 0.7
"""A hidden temperature that leaves less than this share of the RMS misfit explains most of it."""

_MOST_STEPS = 6
"""Greatest number of Gauss-Newton steps."""

_SETTLED = 1e-6
"""Changes of the parameters, as a share of their standard errors, at which they end."""

_LEAST_ERROR = 1e-9
"""Least standard error that counts."""


_FAR_OFF = 0.02
"""Least RMS misfit of pair means, relative to the mean friction, of a lag that would look like
other effects as well."""


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
    problem: Problem, new: Problem | None, accepted: Sequence[EffectFit] = ()
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
    for _ in range(_ROUNDS if others else 1):
        beside = [linear.basis(one.effect, one.shape) for one in others]
        estimate = estimate_temperature(problem, beside)
        if estimate.hidden is None:
            return None
        linear = at_temperature(problem, estimate.parameters, estimate.hidden)
    return RefinedLag(
        problem=linear,
        new=new and at_temperature(new, estimate.parameters, estimate.hidden),
        estimate=estimate,
        fit=lag_fit(estimate),
    )


def search_with_lag(
    problem: Problem,
    new: Problem | None,
    effects: Sequence[Effect],
    search: Callable[[Problem, Sequence[Effect]], SearchResult],
    margin: float = 0.0,
) -> tuple[SearchResult, RefinedLag | None]:
    """Search for causes; where a lag of the gear is one, about the temperature of the gear.

    Where a hidden temperature explains most of the misfit, friction is linear about it from the
    start: about the measured one, a lag of many degrees would look like other effects as well. Else
    it is estimated beside the causes once the lag is one of them, and the search repeated. Where
    the measured temperature then explains friction as well, the lag is left out; where a lag
    was found about the first temperature and none about the second, the first one stays.

    Parameters
    ----------
    problem : Problem
        The rows, linear about the measured temperature.
    new : Problem or None
        Rows of the hold-out run.
    effects : sequence of Effect
        The catalogue.
    search : callable
        Searches a problem for causes among some effects.
    margin : float, optional
        Smallest size worth a name: a lag that may be smaller is left linear. [N·m]

    Returns
    -------
    SearchResult, RefinedLag or None
        The causes, and the lag where it is one of them.
    """
    if LAG not in {one.name for one in effects}:
        return search(problem, effects), None
    first = refine_thermal(problem, new) if _is_far_off(problem) else None
    if first is not None and _explains_most(first.estimate):
        found = search(first.problem, effects)
        if _has_lag(found) and len(found.causes) == 1:
            return _as_refined(found, first), first
        if not _has_lag(found):
            first, found = None, search(problem, effects)
    else:
        first = None
        found = search(problem, effects)
    if not _has_lag(found) or _left_of_lag(found) <= margin:
        return found, None
    refined = refine_thermal(problem, new, [cause.fit for cause in found.causes])
    if refined is not None:
        again = search(refined.problem, effects)
        if _has_lag(again):
            return _as_refined(again, refined), refined
        if first is not None:
            # estimated beside a cause that looks like it, the temperature may be far off
            return _as_refined(found, first), first
    without = search(problem, [one for one in effects if one.name != LAG])
    dropped = without.dropped | {LAG: "the measured temperature explains friction as well"}
    return replace(without, dropped=dropped), None


def _is_far_off(problem: Problem) -> bool:
    """Return whether the base model misses the means of pairs by so much that a lag is large."""
    means = problem.layout.means(problem.friction_misfit[:, np.newaxis])
    missed = float(np.sqrt(np.mean(np.square(means - np.mean(means)))))
    return missed > _FAR_OFF * float(np.mean(np.abs(problem.friction)))


def _explains_most(estimate: ThermalEstimate) -> bool:
    """Return whether a hidden temperature explains most of the misfit of the pair means."""
    measured = next(one for one in estimate.rivals if one.structure is MEASURED)
    return estimate.chosen.left < _MOST * measured.left


def _has_lag(found: SearchResult) -> bool:
    return any(cause.fit.effect.name == LAG for cause in found.causes)


def _left_of_lag(found: SearchResult) -> float:
    """Return the lower bound of what the base leaves of the lag [N·m]."""
    return next(cause.visible_interval[0] for cause in found.causes if cause.fit.effect.name == LAG)


def _as_refined(found: SearchResult, refined: RefinedLag) -> SearchResult:
    """Return a result whose lag has the parts of the network that were found."""
    causes = [
        replace(cause, fit=replace(refined.fit, statistic=cause.fit.statistic))
        if cause.fit.effect.name == LAG
        else cause
        for cause in found.causes
    ]
    return replace(found, causes=tuple(causes))


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
    extend: Callable[[Problem, Sequence[EffectFit]], Extension],
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
    extend : callable
        Returns the extension of a problem by effects.
    """
    place = [one.effect.name for one in effects].index(LAG)
    others = [one for one in effects if one.effect.name != LAG]
    free = extend(refined.problem, effects)
    limit = _SETTLED * np.maximum(free.errors[: len(free.changes)], _LEAST_ERROR)
    for _ in range(_MOST_STEPS):
        held = extend(_with_lag_taken_off(refined.problem), others)
        refined = _moved(refined, held)
        if np.all(np.abs(held.changes) <= limit):
            break
    return refined, replace(
        free,
        changes=np.zeros_like(free.changes),
        gravity=held.gravity,
        effects=(*held.effects[:place], refined.fit, *held.effects[place:]),
    )


def _with_lag_taken_off(problem: Problem) -> Problem:
    """Return a problem whose measured friction has the torque of the lag taken off."""
    table = problem.table
    torque = table.temperature_slope * (table.temperature - table.measured_temperature)
    return replace(problem, friction=problem.friction - torque)


def _moved(refined: RefinedLag, extension: Extension) -> RefinedLag:
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
