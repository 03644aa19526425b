"""Causes that are a decay of friction, of which one may be a part of the other.

No joint runs in exactly exponentially. In a single run what the form of one such cause misses falls
as well, and looks like another: a drift, a step to less friction, or friction after the first rest.
Nor is a gear that lags exactly one thermal body: what that misses decays as the gear warms, and is
back after a night.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.possible import is_seen_once
from frictioncli.diagnosis.search.understood import MOST_LEFT
from frictioncli.effects.drift import EFFECT as DRIFT
from frictioncli.effects.history import stretches
from frictioncli.effects.pair_series import pair_heads
from frictioncli.effects.rest_recovery import EFFECT as REST_RECOVERY
from frictioncli.effects.run_in import EFFECT as RUN_IN
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

SLOW = 1800.0
"""Motion after which grease has settled: what decays more slowly may be the gear that warms. [s]"""

_AS_SLOW = 0.5
"""Least ratio of its decay to the time constant of the gear."""

_WARMS = "it decays as slowly as the gear warms, which no single lag follows exactly"

_ONE_DECAY = "friction decays once, and the other cause need not decay exactly by its equation"


def with_one_decay(causes: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return causes of which only the largest keeps its name of those that are one decay.

    A smaller one that is a good part of it may be the cause as well, and joins its set; so does one
    that stands out and is too small for a name.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named or visible.
    problem : Problem
        The rows seen.
    """
    decaying = _decaying(causes, problem)
    named = [one for one in decaying if one.standing == "named"]
    if not named or len(decaying) < 2:
        return tuple(causes)
    largest = max(named, key=lambda one: one.visible)
    smaller = [one for one in decaying if one is not largest]
    rivals = [one for one in smaller if one.visible > MOST_LEFT * largest.visible]
    judged = {one.fit.effect.name: _lost(one) for one in named}
    judged[largest.fit.effect.name] = _in_set(largest, rivals)
    return tuple(judged.get(one.fit.effect.name, one) for one in causes)


def without_slow_recovery(causes: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return causes of which no friction after rests has a name that may be a part of a lag.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    problem : Problem
        The rows seen.
    """
    lags = any(one.fit.effect.name == THERMAL_LAG.name for one in causes)
    if not lags or problem.hidden is None:
        return tuple(causes)
    longest = max(SLOW, _AS_SLOW * problem.hidden.time_constant)
    return tuple(
        replace(one, standing="undetermined", reason=_WARMS)
        if one.fit.effect is REST_RECOVERY
        and one.fit.shape["pairs"] * _duration_of_pair(problem) > longest
        else one
        for one in causes
    )


def _duration_of_pair(problem: Problem) -> float:
    """Return the mean time from one pair to the next [s]."""
    table = problem.table
    first = pair_heads(table).first
    within = table.run[first][1:] == table.run[first][:-1]
    return float(np.mean(np.diff(table.clock[first])[within])) if np.any(within) else 0.0


def _decaying(causes: Sequence[Cause], problem: Problem) -> list[Cause]:
    """Return the causes that are a decay of which the others may be a part."""
    if len(problem.runs) > 1:
        return []
    decays = [one for one in causes if one.fit.effect is RUN_IN or is_seen_once(one.fit, problem)]
    return [*decays, *(one for one in causes if decays and _falls(one))]


def _falls(cause: Cause) -> bool:
    """Return whether a drift or a step that lasts lets friction fall."""
    fit = cause.fit
    lasts = fit.effect is STEP_CHANGE and len(stretches(fit.shape)) == 1
    return (fit.effect is DRIFT or lasts) and bool(fit.coefficients[0] < 0.0)


def _lost(cause: Cause) -> Cause:
    return replace(cause, standing="undetermined", reason=_ONE_DECAY)


def _in_set(cause: Cause, rivals: Sequence[Cause]) -> Cause:
    """Return a cause with rivals in its set, each as probable as it is large."""
    whole = cause.visible + sum(one.visible for one in rivals)
    probabilities: dict[str, float] = {}
    for one in (cause, *rivals):
        for name, share in one.probabilities.items():
            part = share * one.visible / whole
            probabilities[name] = probabilities.get(name, 0.0) + part
    effects = tuple(dict.fromkeys(name for one in (cause, *rivals) for name in one.effects))
    return replace(cause, effects=effects, probabilities=probabilities)
