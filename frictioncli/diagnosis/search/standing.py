"""What may be said of a cause: named, visible, negligible or undetermined, with the reason."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import stats

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import main_channel
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.search.cause import CONVINCING, Cause
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.possible import (
    beyond_bounds,
    impossible,
    standard_errors,
    undetermined,
)
from frictioncli.effects.base import Effect

_OF_CHANGES = 0.02
"""Significance level of a change, relative to that of other effects: drift over a few dozen pairs
looks like a change at some moment or other much more often than p-values say."""

_SHOWN = 0.5
"""Least share of a cause that the residuals show at face value."""

_TOGETHER = 0.8
"""Rank correlation of temperature and time above which few data tell one from the other."""

GOES_WITH_TIME = (
    "temperature and time go together in these data: it could be an effect of the other"
)
"""Reason why an effect of temperature or time has no name."""

_GRADUAL = frozenset({"temperature", "motor_temperature", "clock", "travel"})
"""Inputs that change gradually with the temperature or with time."""

_CANCELLING = 0.5
"""Two causes cancel each other if their sum has less than this share of the smaller one's RMS."""


def with_standing(
    causes: Sequence[Cause], problem: Problem, margin: float, alpha: float
) -> tuple[Cause, ...]:
    """Return causes with their standing, in the same order.

    *Named* needs significance, a lower bound of what the base leaves above the margin, and a
    physically possible result; else a cause is *negligible* if the upper bound is below the margin,
    *undetermined* if the interval holds both the margin and next to nothing, and *visible*
    otherwise. Of an effect of the measurement its whole torque counts: what the base takes of it
    makes the base wrong.

    Parameters
    ----------
    causes : sequence of Cause
        Causes found.
    problem : Problem
        The rows.
    margin : float
        Smallest size worth a name. [N·m]
    alpha : float
        Significance level.
    """
    judged = [_judged(cause, problem, margin, alpha) for cause in causes]
    for weaker in sorted(range(len(judged)), key=lambda i: judged[i].test.statistic):
        for other in range(len(judged)):
            both = judged[weaker], judged[other]
            named = weaker != other and all(one.standing == "named" for one in both)
            if named and _cancel(problem, *both):
                judged[weaker] = replace(
                    judged[weaker],
                    standing="undetermined",
                    reason=f"it and {judged[other].fit.effect.name} cancel each other",
                )
    return tuple(judged)


def _judged(cause: Cause, problem: Problem, margin: float, alpha: float) -> Cause:
    low, high = cause.visible_interval
    margin = channel_margin(problem, cause.fit.effect.channel, margin)
    left = "the base leaves"
    if cause.fit.effect.measurement and cause.visible > 0:
        low, high = (cause.size / cause.visible * bound for bound in (low, high))
        left = "there is"
    alpha = level_of(cause.fit.effect, alpha)
    if not (cause.test.p_value < alpha and cause.test.log_bayes_factor > CONVINCING):
        return replace(cause, standing="undetermined", reason="noise may be the reason")
    doubt = _impossible(cause, problem)
    doubt = doubt or (GOES_WITH_TIME if goes_with_time(cause.fit.effect, problem) else "")
    if doubt:
        return replace(cause, standing="undetermined", reason=doubt)
    if low > margin:
        return replace(cause, standing="named", reason="")
    if high < margin:
        reason = f"{left} less of it than the margin of {margin:.2g}"
        return replace(cause, standing="negligible", reason=reason)
    reason = f"{left.replace('leaves', 'may leave').replace('is', 'may be')} less of it than"
    reason += f" the margin of {margin:.2g}"
    return replace(cause, standing="visible" if low > 0 else "undetermined", reason=reason)


def level_of(effect: Effect, alpha: float) -> float:
    """Return the significance level that a name of an effect needs.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    alpha : float
        Significance level of the other effects.
    """
    return alpha * _OF_CHANGES if effect.moments is not None else alpha


def _impossible(cause: Cause, problem: Problem) -> str:
    """Return why a cause is physically impossible or not determined; empty if it is not."""
    reason, errors = beyond_bounds(cause.fit, problem), standard_errors(cause.fit)
    if cause.fit.effect.measurement:
        reason = impossible(cause.fit, problem) or undetermined(cause.fit, problem)
    if reason:
        return reason
    if cause.shown < _SHOWN:
        return "the residuals alone do not show it: another effect would have to cancel it"
    if not errors.any():
        return "its coefficients lie on the bounds of what is physically possible"
    if len(errors) == 1 and abs(cause.fit.coefficients[0]) <= Z95 * errors[0]:
        return "its coefficient may be zero"
    return ""


def goes_with_time(effect: Effect, problem: Problem) -> bool:
    """Return whether an effect is of temperature or of time, which go together in these data.

    Where the joint mostly warms up, what goes with temperature goes with time as well: a drift
    looks like friction that depends on temperature. A change at a moment does not, nor does a lag,
    which shows at each speed by how friction falls with temperature there.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    problem : Problem
        The joint's rows.
    """
    if effect.measurement or effect.moments is not None or _GRADUAL.isdisjoint(effect.needs):
        return False
    if "temperature_slope" in effect.needs:
        return False
    table = problem.table
    known = np.column_stack([table.measured_temperature, table.clock])
    temperature, clock = problem.layout.means(known).T
    if not (np.ptp(temperature) > 0 and np.ptp(clock) > 0):
        return False
    return abs(float(stats.spearmanr(temperature, clock).statistic)) >= _TOGETHER


def _cancel(problem: Problem, one: Cause, other: Cause) -> bool:
    """Return whether two causes in one channel cancel each other."""
    if one.fit.effect.channel != other.fit.effect.channel:
        return False
    first, second = _torque(problem, one), _torque(problem, other)
    rms = [float(np.sqrt(np.mean(np.square(values)))) for values in (first, second, first + second)]
    return rms[2] < _CANCELLING * min(rms[0], rms[1])


def _torque(problem: Problem, cause: Cause) -> Array:
    basis = problem.basis(cause.fit.effect, cause.fit.shape)
    return np.asarray(main_channel(basis, cause.fit.effect) @ cause.fit.coefficients)
