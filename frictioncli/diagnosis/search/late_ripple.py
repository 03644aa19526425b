r"""By how much the torque is late, from a ripple of friction that passes in that time.

Gravity varies so slowly with the angle that pairs tell the mean time *D* by which the torque is
late, and hardly the variance of that time. A ripple of order *N* turns by the angle :math:`N v D`
between position and torque, and a filter lets little of it pass at high speed
(:mod:`frictioncli.diagnosis.data.late_torque`): behind a response that is not that of the log it
looks like structure along the angle in both channels. Where it turns by a radian or more, the
response that explains most of it is estimated, with its order.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.late_torque import LateTorque
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import left_by, span_of
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.step import Step
from frictioncli.distributions import chi2_tail

_LEAST_TURN = 1.0
"""Angle by which a ripple must turn between position and torque to tell the response. [rad]"""

_MOST_DELAY = 2.0
"""Greatest delay, relative to the one that is known, to some hundredths of a second."""

_STARTS = tuple((delay, share) for delay in (0.8, 1.0, 1.2) for share in (0.1, 0.5, 0.9))
"""Delays relative to the one that is known, and shares of the filter in them, to start from."""

_PARAMETERS = 3
"""Number of parameters that are estimated: delay, filter, and the order anew."""

_EVALUATIONS = 150
"""Greatest number of responses that are tried from the best start."""


def shown_by_ripple(step: Step, measurement: Sequence[EffectFit]) -> LateTorque | None:
    """Return the response that a ripple shows, where it is surely not the one that is known.

    Of all rows alike it is the one that explains most; the likelihood, which knows how much noise
    the angles of a move share, decides whether it explains more than the one that is known.

    Parameters
    ----------
    step : Step
        Base and all effects that were accepted, late by what is known.
    measurement : sequence of EffectFit
        Effects of the measurement beside the base.

    Returns
    -------
    LateTorque or None
        None without a ripple that turns by enough, or where what is known is as good.
    """
    problem, accepted, late = step.problem, step.accepted, step.problem.late
    fastest = float(np.radians(problem.table.speed.max()))
    ripple = next((one for one in accepted if _first_order(one) > 0.0), None)
    if late is None or ripple is None or _first_order(ripple) * fastest * late.delay < _LEAST_TURN:
        return None
    others = [one for one in (*measurement, *accepted) if one is not ripple]
    beside = [problem.basis(one.effect, one.shape) for one in others]
    misfit_of = _misfit_beside(problem, ripple, span_of(problem, beside))
    name = next(iter(ripple.shape))
    order, delay = ripple.shape[name], late.delay

    def response(values: Array) -> LateTorque:
        whole = delay * float(np.clip(values[0], 0.0, _MOST_DELAY))
        return LateTorque(delay=whole, variance=(whole * float(np.clip(values[1], 0.0, 1.0))) ** 2)

    def objective(values: Array) -> float:
        return math.log(misfit_of(response(values), {name: order * values[2]}))

    starts = [np.array([*one, 1.0]) for one in _STARTS]
    first = min(starts, key=objective)
    best = minimize(
        objective,
        first,
        method="Nelder-Mead",
        options={
            "initial_simplex": first + np.vstack([np.zeros(3), np.diag([0.1, -0.1, 0.005])]),
            "maxfev": _EVALUATIONS,
            "xatol": 1e-3,
            "fatol": 1e-5,
        },
    )
    found = response(best.x)
    turned = replace(ripple, shape={name: order * float(best.x[2])})
    again = Step.of(
        replace(step.precomputed, problem=replace(problem, late=found)),
        [turned if one is ripple else one for one in accepted],
    )
    gained = max(step.fit.objective - again.fit.objective, 0.0)
    return found if chi2_tail(gained, _PARAMETERS) < BEYOND_DOUBT else None


def _first_order(one: EffectFit) -> float:
    """Return the least order of a ripple; 0 of another effect [1/turn]."""
    return 0.0 if one.effect.orders is None else min(one.effect.orders(**one.shape))


def _misfit_beside(
    problem: Problem, ripple: EffectFit, span: Array
) -> Callable[[LateTorque, dict[str, float]], float]:
    """Return a function: the squares that base, causes and a ripple behind a response leave."""
    misfit = np.concatenate([problem.friction_misfit, problem.load_misfit])
    misfit = misfit - span @ (span.T @ misfit)

    def left(late: LateTorque, shape: dict[str, float]) -> float:
        columns = left_by(span, replace(problem, late=late).basis(ripple.effect, shape))
        coefficients = np.linalg.lstsq(columns, misfit, rcond=None)[0]
        return float(np.sum(np.square(misfit - columns @ coefficients)))

    return left
