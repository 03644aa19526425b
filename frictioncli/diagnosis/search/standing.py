"""What may be said of a cause: named, visible, negligible or undetermined, with the reason."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import main_channel
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.search.cause import CONVINCING, Cause
from frictioncli.diagnosis.search.changes_at_turns import without_changes_at_turns
from frictioncli.diagnosis.search.confounded import (
    confounded,
    hardly_repeats,
    without_forms_of_ends,
    without_forms_of_others,
)
from frictioncli.diagnosis.search.doubtful_steps import doubtful_change
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.possible import (
    ON_BOUND,
    beyond_bounds,
    impossible,
    lies_on_bound,
    standard_errors,
    undetermined,
)
from frictioncli.diagnosis.search.simpler_laws import simpler_law
from frictioncli.effects.base import Effect
from frictioncli.effects.position_ripple import EFFECT as POSITION_RIPPLE
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

_OF_CHANGES = 0.02
"""Significance level of a change, relative to that of other effects: drift over a few dozen pairs
looks like a change at some moment or other much more often than p-values say."""

_SHOWN = 0.5
"""Least share of a cause that the residuals show at face value."""

_SHOWN_OF_MEASUREMENT = 0.25
"""The same of an effect of the measurement, which stands there before what else the model lacks: of
a delay beside structure along the angle they may show a half."""

_TOO_FINE = (
    "slower moves do not show it, and a ripple that is too fine for the samples of fast moves, or a"
    " vibration, would look the same"
)
_ONE_DIRECTION = (
    "friction changes as much, as by torque in one direction of motion only: a brake that drags"
    " after a stop would look the same"
)

_LINEAR = "no temperature of the gear was found that explains it"

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
    told = without_forms_of_others(without_forms_of_ends(judged, problem))
    return without_changes_at_turns(told, problem)


def without_cancelling(causes: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return causes of which none that is named cancels another one, in the same order.

    Of two that cancel each other the weaker is not named: together they may stand for a third that
    is as small as their sum. Both are if both hold on the run that was kept out, where they went
    on by themselves.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    problem : Problem
        The rows.
    """
    judged = list(causes)
    for weaker in sorted(range(len(judged)), key=lambda i: judged[i].test.statistic):
        for other in range(len(judged)):
            both = judged[weaker], judged[other]
            named = weaker != other and all(one.standing == "named" for one in both)
            held = all(one.holds_on_new_run for one in both)
            if named and not held and _cancel(problem, *both):
                judged[weaker] = replace(
                    judged[weaker],
                    standing="undetermined",
                    reason=f"it and {judged[other].fit.effect.name} cancel each other",
                )
    return tuple(judged)


def without_linear_lag(causes: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return causes of which no lag of the gear has a name that was not estimated as a temperature.

    Its linear form knows no bounds of heat and shares. A lag that may be below the margin stays
    linear, and may seem larger beside fewer causes.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    problem : Problem
        The rows, about the temperature of the gear where one was found.
    """
    return tuple(
        replace(one, standing="visible", reason=_LINEAR)
        if one.fit.effect.name == THERMAL_LAG.name
        and one.standing == "named"
        and problem.hidden is None
        else one
        for one in causes
    )


def _judged(cause: Cause, problem: Problem, margin: float, alpha: float) -> Cause:
    low, high = cause.visible_interval
    margin = channel_margin(problem, cause.fit.effect.channel, margin)
    is_less, may_be_less = "the base model leaves less than", "the base model may leave less than"
    if cause.fit.effect.measurement and cause.visible > 0:
        low, high = (cause.size / cause.visible * bound for bound in (low, high))
        is_less, may_be_less = "it is below", "it may be below"
    alpha = level_of(cause.fit.effect, alpha)
    if not (cause.test.p_value < alpha and cause.test.log_bayes_factor > CONVINCING):
        return replace(cause, standing="undetermined", reason="it may be noise")
    doubt = _impossible(cause, problem)
    doubt = doubt or confounded(cause.fit.effect, problem)
    doubt = doubt or doubtful_change(cause.fit, problem)
    doubt = doubt or simpler_law(cause.fit, problem) or hardly_repeats(cause.fit, problem)
    if doubt:
        return replace(cause, standing="undetermined", reason=doubt)
    if low > margin:
        return replace(cause, standing="named", reason="")
    if high < margin:
        reason = f"{is_less} the margin of {margin:.2g}"
        return replace(cause, standing="negligible", reason=reason)
    reason = f"{may_be_less} the margin of {margin:.2g}"
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
    least = _SHOWN_OF_MEASUREMENT if cause.fit.effect.measurement else _SHOWN
    if cause.shown.share < least:
        return "the residuals do not show an effect of this size"
    if cause.fit.effect is POSITION_RIPPLE and cause.shown.slower < _SHOWN:
        return _TOO_FINE
    if cause.shown.one_direction:
        return _ONE_DIRECTION
    if lies_on_bound(cause.fit):
        return ON_BOUND
    if len(errors) == 1 and abs(cause.fit.coefficients[0]) <= Z95 * errors[0]:
        return "its coefficient may be zero"
    return ""


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
