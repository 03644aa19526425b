"""Usual sizes of parameters, and the weak prior that follows from them."""

from collections.abc import Mapping

import numpy as np

from frictioncli.arrays import Array
from frictioncli.design.planned_joint import PlannedJoint
from frictioncli.design.rivals import OpenQuestions
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.model.document import PARAMETERS

_PRIOR_FACTOR = 10.0
"""Prior standard deviation of a parameter, relative to its usual size."""

_USUAL_DELTA = 0.05
"""Usual rate of the decay with temperature. [1/°C]"""


def usual_sizes(joint: PlannedJoint, problem: Problem) -> Mapping[str, float]:
    """Return what the parameters of the base model usually are in a joint of this friction.

    Parameters
    ----------
    joint : PlannedJoint
        The joint.
    problem : Problem
        Its observed rows.
    """
    friction = max(float(np.mean(np.abs(problem.table.friction))), 1e-6)
    viscous = friction / np.sqrt(float(np.mean(problem.table.speed)))
    return {
        "tau_c": friction,
        "alpha": friction / _greatest_load(problem) ** 2,
        "beta": viscous,
        "gamma": viscous * float(np.exp(_USUAL_DELTA * _mean_temperature(joint))),
        "delta": _USUAL_DELTA,
    }


def prior_precision(joint: PlannedJoint, open_questions: OpenQuestions, problem: Problem) -> Array:
    """Return the weak prior precision of all coefficients, which keeps every interval finite."""
    size = usual_sizes(joint, problem)
    load = _greatest_load(problem)
    usual = [*(size[name] for name in PARAMETERS), *(load for _ in problem.gravity)]
    bounds = [
        parameter.upper - parameter.lower
        for one in open_questions.causes
        for parameter in one.effect.coefficients
    ]
    deviations = np.array([*(_PRIOR_FACTOR * one for one in usual), *bounds])
    return np.asarray(1 / np.square(deviations))


def _greatest_load(problem: Problem) -> float:
    return max(float(np.max(np.abs(problem.load_base @ problem.gravity))), 1e-6)


def _mean_temperature(joint: PlannedJoint) -> float:
    """Return the mean observed motor temperature, 20 °C where it is not known [°C]."""
    mean = float(joint.torques["motor_temperature"].mean())
    return mean if np.isfinite(mean) else 20.0
