"""Changes that come as the joint turns from warming up to cooling down, and their likes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.data.temperature_direction import temperature_direction
from frictioncli.diagnosis.fit.columns import RANK, base_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.effects.history import present
from frictioncli.effects.pair_series import first_order_lag, measured_share, starts
from frictioncli.effects.rest_recovery import EFFECT as REST_RECOVERY
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG
from frictioncli.linear_algebra import least_squares_residual
from frictioncli.wording import in_words

_AT_TURN = 0.9
"""Share of the pairs in which a change is there as the joint cools down, and not as it warms up, or
the other way round, from which it comes with the turn. The gear turns later than the motor."""

_PART_OF_OTHER = 1 / 3
"""Size of such a change, relative to a cause that differs between warming up and cooling down, up
to which it may be what the form of that cause misses."""

_COMES_WITH_TURN = (
    "it comes as the joint turns from warming up to cooling down, where errors in the form of"
    " {other} may look the same"
)

_IS_HYSTERESIS = (
    "it comes as the joint turns from warming up to cooling down, and friction that follows"
    " gradually how fast the joint warms or cools would look the same"
)

_TIME_CONSTANTS = (600.0, 1800.0, 5400.0)
"""Times over which friction may follow the change of the temperature. [s]"""


def without_changes_at_turns(causes: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return causes of which no change has a name that may be another thing at the turn.

    A lag of the gear changes its sign there, and rests between moves begin there or end: what the
    form of another cause misses may look like a small change. Friction after a rest shows in the
    load as well, as it decays between the two directions of a pair. A step of friction may be a
    hysteresis over the temperature.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    problem : Problem
        The joint's rows.
    """
    judged = list(causes)
    named = [one for one in causes if one.standing == "named"]
    for number, change in enumerate(judged):
        is_change = change.standing == "named" and change.fit.effect.moments is not None
        if not is_change or not _comes_with_turn(change.fit, problem):
            continue
        others = [one for one in named if one is not change]
        reason = _form_of_others(change, others) or hysteresis_in(
            change.fit, [one.fit for one in others], problem
        )
        if reason:
            judged[number] = replace(change, standing="undetermined", reason=reason)
    return tuple(judged)


def _form_of_others(change: Cause, others: Sequence[Cause]) -> str:
    """Return why a change at the turn may be what the form of another cause misses."""
    in_friction = change.fit.effect.channel == "friction"
    for other in others:
        may_miss = other.fit.effect is REST_RECOVERY or (
            other.fit.effect.name == THERMAL_LAG.name and in_friction
        )
        if may_miss and change.visible < _PART_OF_OTHER * other.visible:
            return _COMES_WITH_TURN.format(other=in_words(other.fit.effect.name))
    return ""


def hysteresis_in(fit: EffectFit, others: Sequence[EffectFit], problem: Problem) -> str:
    r"""Return why a step of friction at the turn may be a hysteresis; empty if not.

    Friction in proportion to how far the temperature is from its mean over the last minutes,
    :math:`T - F_\theta(T)`, explains no less than the step does. Stresses of parts that warm at
    different rates change the preload of a bearing so.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its history.
    others : sequence of EffectFit
        Effects that stand beside it.
    problem : Problem
        The joint's rows.
    """
    if fit.effect is not STEP_CHANGE:
        return ""
    layout = problem.layout
    rows = np.column_stack(
        [problem.friction_misfit, problem.table.measured_temperature, problem.table.viscous]
    )
    misfit, temperature, viscous = layout.means(rows).T
    levels = layout.run[:, np.newaxis] == np.unique(layout.run)
    columns = [base_rows(problem)[0], *(problem.basis(one.effect, one.shape)[0] for one in others)]
    beside = np.hstack([layout.means(np.hstack(columns)), levels])
    step, _ = problem.basis(fit.effect, fit.shape)

    def left_by(column: Array) -> float:
        design = np.column_stack([beside, column])
        return float(np.sum(np.square(least_squares_residual(design, misfit, tolerance=RANK))))

    late = [
        first_order_lag(
            time=layout.time,
            value=temperature,
            restart=starts(layout.run),
            time_constant=one,
        )
        for one in _TIME_CONSTANTS
    ]
    least = min(left_by(factor * one) for one in late for factor in (1.0, viscous))
    return _IS_HYSTERESIS if least <= left_by(layout.means(step)) else ""


def _comes_with_turn(fit: EffectFit, problem: Problem) -> bool:
    """Return whether a change is there as the joint cools down, or only as it warms up."""
    there = present(measured_share(problem.all_runs)[problem.rows], fit.shape)
    direction = temperature_direction(problem.table)
    known = direction != 0.0
    if not known.any():
        return False
    cooling = float(np.mean(there[known] == (direction[known] < 0.0)))
    return max(cooling, 1.0 - cooling) >= _AT_TURN
