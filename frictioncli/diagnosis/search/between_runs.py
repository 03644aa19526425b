"""Causes that show only in how the runs differ, as friction differs from day to day anyway.

A few days whose friction differs at random look like a drift, like running-in, or like a step that
happened between two of them. Such a cause has a name if it shows within the runs as well, beside a
level of friction of each run, or if the runs differ by more than days do. A sensor that was
replaced, or another oil, shifts the temperature at which friction is the same, and looks like a lag
where some runs are heated faster than others: a lag has a name if it shows within the runs, beside
a level and a shift of temperature of each.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import main_channel
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, span_of, torque_left_by
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.largest_structure import BETWEEN_DAYS
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis
from frictioncli.effects.drift import EFFECT as DRIFT
from frictioncli.effects.history import history, spans_with
from frictioncli.effects.pair_series import measured_share
from frictioncli.effects.run_in import EFFECT as RUN_IN
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

_LAGS = frozenset({SENSOR_LAG.name, THERMAL_LAG.name})
"""Effects of the history of the temperature."""

_WITHIN = 6.6
"""Twice the log likelihood ratio by which a cause shows within the runs: p = 0.01."""

_AT_END = 30.0
"""The same of a step that begins near the end of a run: p = 4e-8. A run that begins is not settled;
one that ends is, but its last pairs are few."""

_OF_RUN = 0.15
"""Share of the rows of a run, at its start or end, in which a change may be there without showing
within the run."""

_LEAST_WITHIN = 2 / 3
"""Least size of a lag within the runs, relative to its size in all."""

_DAYS_DIFFER = (
    "it shows only in how the runs differ, and by no more than friction may differ from day to day"
)


def without_differences_of_runs(
    causes: Sequence[Cause], step: Step, measured: Problem
) -> tuple[Cause, ...]:
    """Return causes of which none has a name that only days which differ show.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    step : Step
        The last step of the search.
    measured : Problem
        The rows about the measured temperature.
    """
    named = [one.fit for one in causes if one.standing == "named"]

    def only_between_runs(fit: EffectFit) -> bool:
        if fit.effect.name not in _LAGS:
            return differs_as_days_do(fit, step)
        others = [one for one in named if one.effect.name not in _LAGS]
        return size_within_runs(fit, others, measured) < _LEAST_WITHIN

    return tuple(
        replace(one, standing="undetermined", reason=_DAYS_DIFFER)
        if one.standing == "named" and only_between_runs(one.fit)
        else one
        for one in causes
    )


def size_within_runs(fit: EffectFit, others: Sequence[EffectFit], measured: Problem) -> float:
    """Return the size of a lag within the runs, relative to that with which it was found [1].

    Parameters
    ----------
    fit : EffectFit
        The lag.
    others : sequence of EffectFit
        Other effects that stand beside it.
    measured : Problem
        The rows about the measured temperature.
    """
    run = measured.layout.run[measured.layout.row_pair]
    later = np.unique(run)[1:]
    if not len(later):
        return 1.0
    there = (run[:, np.newaxis] == later).astype(float)
    columns = np.hstack([there, there * measured.table.temperature_slope[:, np.newaxis]])
    of_runs = Basis(columns, np.zeros_like(columns))
    span = span_of(measured, [*(measured.basis(one.effect, one.shape) for one in others), of_runs])
    torque = torque_left_by(span, measured, fit)
    misfit = Basis(measured.friction_misfit[:, np.newaxis], measured.load_misfit[:, np.newaxis])
    square = float(torque @ torque)
    return float(torque @ left_by(span, misfit)[:, 0]) / square if square > 0 else 0.0


def differs_as_days_do(
    fit: EffectFit, step: Step, planted: tuple[Basis, float] | None = None
) -> bool:
    """Return whether an effect is what days may differ by, and shows within no run.

    Parameters
    ----------
    fit : EffectFit
        The effect.
    step : Step
        Base and all that stands beside it, the effect itself or not.
    planted : (Basis, float), optional
        Torque that is added to the misfit, one column, and its coefficient.
    """
    problem = step.problem
    run = problem.layout.run[problem.layout.row_pair]
    runs = np.unique(run)
    if len(runs) == 1 or fit.effect not in (DRIFT, RUN_IN, STEP_CHANGE):
        return False
    torque = main_channel(problem.basis(fit.effect, fit.shape), fit.effect) @ fit.coefficients
    means = np.array([np.mean(torque[run == one]) for one in runs])
    relative = float(np.sqrt(fit.covariance[0, 0])) / abs(float(fit.coefficients[0]))
    least = float(np.ptp(means)) * (1.0 - Z95 * relative)
    if least >= BETWEEN_DAYS * float(np.mean(np.abs(problem.friction))):
        return False
    least = _WITHIN
    if fit.effect is STEP_CHANGE:
        # a pair or two at the start of a run are no evidence
        there = [torque[run == one] != 0 for one in runs]
        if any(_OF_RUN < float(np.mean(one)) < 1.0 - _OF_RUN for one in there):
            return False
        if not any(one[-1] and not one[0] for one in there):
            return True
        least = _AT_END
    others = [one for one in step.accepted if one.effect not in (fit.effect, STEP_CHANGE)]
    beside = Step.of(step.precomputed, [*others, *_levels(step)])
    if planted is not None:
        basis, size = planted
        beside = beside.planted(basis, np.array([size]))
    return beside.fitted(fit.effect, fit.shape).statistic <= least


def _levels(step: Step) -> list[EffectFit]:
    """Return a step at the start of each run but the first, of the runs seen."""
    problem = step.problem
    share = measured_share(problem.all_runs)[problem.rows]
    return [
        EffectFit(STEP_CHANGE, history([(begin, 1.0)]), np.ones(1), np.eye(1), 0.0)
        for begin, _ in spans_with(problem.all_runs, share)[1:]
    ]
