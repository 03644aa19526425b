"""The search for causes where a lag of the gear may be one of them."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.special import ndtr

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.left_by_base import Z95, rms_left, torque_left_by
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.possible import standard_errors
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.slow_sensor import TIME_CONSTANT
from frictioncli.diagnosis.search.stated_size import span_at_measured
from frictioncli.diagnosis.thermal.estimate import MEASURED, ThermalEstimate
from frictioncli.diagnosis.thermal.refine import LAG, RefinedLag, refine_thermal
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import Effect
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG

_WITHOUT_SENSOR = tuple(one for one in MEASUREMENT_EFFECTS if one is not SENSOR_LAG)
"""What stands beside the base where the lag of a sensor is left out."""

_EVEN = 0.5
"""Least probability of the lag of the gear, where both are in a set: the data do not tell."""

_SURE = 0.95
"""Greatest probability of the lag of the gear, where both are in a set."""

_FAR_OFF = 0.02
"""Least RMS misfit of pair means, relative to the mean friction, of a lag that would look like
other effects as well."""

_ROUNDS = 2
"""Estimates of the hidden temperature beside the causes, and searches about it, in turn."""

_MOST = 0.7
"""A hidden temperature that leaves less than this share of the RMS misfit explains most of it."""


def search_with_lag(
    problem: Problem,
    new: Problem | None,
    effects: Sequence[Effect],
    search: Callable[..., SearchResult],
    margin: float = 0.0,
    measurement: Sequence[Effect] = (),
) -> tuple[SearchResult, RefinedLag | None]:
    """Search for causes; where a lag of the gear is one, about the temperature of the gear.

    A gear that friction warms more than the motor looks much like a sensor that lags: either has
    friction lower while heating. Where what a sensor leaves of it is not surely worth a name, or
    the sensor would have to be slower than any in a winding, the search is repeated without the
    sensor, and a lag of the gear that is then large enough is one of the two.

    Parameters
    ----------
    problem : Problem
        The rows, linear about the measured temperature.
    new : Problem or None
        Rows of the hold-out run.
    effects : sequence of Effect
        The catalogue.
    search : callable
        Searches a problem for causes among some effects, beside a base with those effects of the
        measurement that ``measurement`` names, all by default.
    margin : float, optional
        Smallest size worth a name: a lag that may be smaller is left linear. [N·m]
    measurement : sequence of Effect, optional
        Effects of the measurement that stand beside the base.

    Returns
    -------
    SearchResult, RefinedLag or None
        The causes, and the lag where it is one of them.
    """
    refine = partial(refine_thermal, problem, new, measurement=measurement)
    found, lag = _searched(problem, effects, search, refine, margin)
    if _left_of_lag(found, problem) > margin if _has_lag(found) else not _is_too_slow(found):
        return found, lag
    share = max(_share_of_lag(found, margin), _share_beyond(found))
    without = partial(search, measurement=_WITHOUT_SENSOR)
    again, refined = _searched(problem, effects, without, refine, margin)
    if refined is None or _left_of_lag(again, problem) <= margin:
        return found, lag
    causes = (_lag_or_sensor(one, share) if _is_lag(one) else one for one in again.causes)
    return replace(again, causes=tuple(causes)), refined


def _share_of_lag(found: SearchResult, margin: float) -> float:
    """Return the probability that beside the lag of a sensor one of the gear is worth a name."""
    if not _has_lag(found):
        return _EVEN
    cause = _lag_of(found)
    low, high = cause.visible_interval
    return _probability_above(margin, cause.visible, (high - low) / (2 * Z95))


def _share_beyond(found: SearchResult) -> float:
    """Return the probability that a sensor would have to lag by more than one does."""
    late, error = _sensor_lag(found)
    return _probability_above(TIME_CONSTANT, late, error)


def _is_too_slow(found: SearchResult) -> bool:
    """Return whether a sensor would surely have to lag by more than those in windings do."""
    late, error = _sensor_lag(found)
    return late - Z95 * error > TIME_CONSTANT


def _sensor_lag(found: SearchResult) -> tuple[float, float]:
    """Return by how much a sensor lags, and the standard error [s]; 0 where it does not."""
    sensor = next((one.fit for one in found.measurement if one.fit.effect is SENSOR_LAG), None)
    if sensor is None:
        return 0.0, 0.0
    return float(sensor.coefficients[0]), float(standard_errors(sensor)[0])


def _probability_above(limit: float, value: float, error: float) -> float:
    """Return the probability that a value is above a limit, no less than even."""
    return float(np.clip(ndtr((value - limit) / max(error, 1e-9)), _EVEN, _SURE))


def _lag_or_sensor(cause: Cause, share: float) -> Cause:
    """Return a lag of the gear that may as well be one of the sensor."""
    shares = {LAG: share, SENSOR_LAG.name: 1.0 - share}
    return replace(cause, effects=tuple(shares), probabilities=shares)


def _searched(
    problem: Problem,
    effects: Sequence[Effect],
    search: Callable[[Problem, Sequence[Effect]], SearchResult],
    refine: Callable[..., RefinedLag | None],
    margin: float,
) -> tuple[SearchResult, RefinedLag | None]:
    """Search for causes; where a lag of the gear is one, about the temperature of the gear.

    Where a hidden temperature explains most of the misfit, friction is linear about it from the
    start: about the measured one, a lag of many degrees would look like other effects as well. Else
    it is estimated beside the causes once the lag is one of them, and the search repeated. Where
    the measured temperature then explains friction as well, the lag is left out; where a lag
    was found about the first temperature and none about the second, the first one stays.
    """
    if LAG not in {one.name for one in effects}:
        return search(problem, effects), None
    first = refine() if _is_far_off(problem) else None
    if first is not None and _explains_most(first.estimate):
        found = search(first.problem, effects)
        if _has_lag(found) and len(found.causes) == 1:
            return _as_refined(found, first), first
        if not _has_lag(found):
            first, found = None, search(problem, effects)
    else:
        first = None
        found = search(problem, effects)
    if not _has_lag(found) or _lag_of(found).visible_interval[0] <= margin:
        return found, None
    for _ in range(_ROUNDS):
        refined = refine([cause.fit for cause in found.causes])
        again = None if refined is None else search(refined.problem, effects)
        if refined is None or again is None or not _has_lag(again):
            break
        known, found, first = found, _as_refined(again, refined), refined
        if _names(known) == _names(found):
            break
    if first is not None:
        # estimated beside a cause that looks like it, the temperature may be far off
        return _as_refined(found, first), first
    without = search(problem, [one for one in effects if one.name != LAG])
    dropped = without.dropped | {LAG: "the measured temperature explains friction as well"}
    return replace(without, dropped=dropped), None


def _names(found: SearchResult) -> set[str]:
    return {cause.fit.effect.name for cause in found.causes}


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
    return any(_is_lag(cause) for cause in found.causes)


def _is_lag(cause: Cause) -> bool:
    return cause.fit.effect.name == LAG


def _left_of_lag(found: SearchResult, measured: Problem) -> float:
    """Return the lower bound of what base and sensor leave of the lag [N·m].

    About the temperature of the gear a sensor that lags is another column, and leaves more.
    """
    cause = _lag_of(found)
    span = span_at_measured(measured, found.measurement)
    left = torque_left_by(span, found.step.problem, cause.fit)
    return cause.visible_interval[0] * min(rms_left(left) / max(cause.visible, 1e-300), 1.0)


def _lag_of(found: SearchResult) -> Cause:
    """Return the lag of a search that found one."""
    return next(cause for cause in found.causes if _is_lag(cause))


def _as_refined(found: SearchResult, refined: RefinedLag) -> SearchResult:
    """Return a result whose lag has the parts of the network that were found."""
    causes = [
        replace(cause, fit=replace(refined.fit, statistic=cause.fit.statistic))
        if _is_lag(cause)
        else cause
        for cause in found.causes
    ]
    return replace(found, causes=tuple(causes))
