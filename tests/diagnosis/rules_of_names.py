"""The rules that every cause which is named keeps, whatever joint and log do."""

from itertools import combinations

import numpy as np

from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.effects import BY_NAME
from frictioncli.quantities import TORQUE


def torque(problem, fit):
    """Return the torque of a fitted effect in both channels, one above the other."""
    basis = problem.basis(fit.effect, fit.shape)
    return np.concatenate([basis.friction @ fit.coefficients, basis.load @ fit.coefficients])


def within_its_bounds(problem, fit):
    """Whether no coefficient misses its bounds by more than two standard errors.

    Bounds in torque are for joints of 20 N·m of friction, and grow with more.
    """
    factor = max(np.mean(np.abs(problem.friction)) / 20.0, 1.0)
    for parameter, value, variance in zip(
        fit.effect.coefficients, fit.coefficients, np.diag(fit.covariance), strict=True
    ):
        scale = factor if TORQUE in parameter.unit else 1.0
        away = 2 * np.sqrt(variance) + 1e-9
        if not scale * parameter.lower - away <= value <= scale * parameter.upper + away:
            return False
    return True


def left_on_new_run(diagnosis, cause):
    """Return what a base fitted to the runs seen leaves of a change that goes on on a new run."""
    if cause.fit.effect.moments is None or not cause.holds_on_new_run:
        return 0.0
    seen, new = diagnosis.base, diagnosis.judged
    base = np.vstack(base_rows(seen))
    change = np.linalg.lstsq(base, torque(seen, cause.fit), rcond=None)[0]
    left = torque(new, cause.fit) - np.vstack(base_rows(new)) @ change
    friction, load = np.split(left, 2)
    own = friction if cause.fit.effect.channel == "friction" else load
    return np.sqrt(np.mean(np.square(own)))


def keeps_the_rules(diagnosis):
    problem = diagnosis.base
    for cause in diagnosis.causes:
        fit, (low, high) = cause.fit, cause.visible_interval
        assert cause.standing == "named"
        assert cause.reason == ""
        assert cause.test.p_value < 0.05
        assert low <= cause.visible <= high
        # of the measurement the whole torque counts, of other causes what the base leaves
        whole = cause.size / cause.visible if fit.effect.measurement else 1.0
        # or the search found more, and the model surely has some
        found = [one for one in diagnosis.search.causes if one.fit.effect is fit.effect]
        assert low > 0.0
        sizes = [whole * low, *(one.visible_interval[0] for one in found)]
        assert diagnosis.margin < max([*sizes, left_on_new_run(diagnosis, cause)])
        assert within_its_bounds(problem, fit), fit
        assert np.diag(fit.covariance).any()
        assert fit.effect.name in cause.effects
        assert set(cause.effects) <= set(BY_NAME)
        assert 0.95 - 1e-9 <= sum(cause.probabilities[name] for name in cause.effects) <= 1 + 1e-9
        if fit.effect.name == "thermal_lag":
            for parameter, value in zip(fit.effect.coefficients, fit.coefficients, strict=True):
                if parameter.lower == 0.0:
                    assert value >= -1e-9
        if len(fit.coefficients) == 1:
            assert abs(fit.coefficients[0]) > 1.96 * np.sqrt(fit.covariance[0, 0])
    for one, other in combinations(diagnosis.causes, 2):
        first, second = torque(problem, one.fit), torque(problem, other.fit)
        left = min(np.linalg.norm(first), np.linalg.norm(second))
        assert np.linalg.norm(first + second) > 0.5 * left
    for cause in diagnosis.visible:
        assert cause.standing in ("visible", "negligible", "undetermined")
        assert cause.reason
        if cause.standing == "negligible":
            whole = cause.size / cause.visible if cause.fit.effect.measurement else 1.0
            assert whole * cause.visible_interval[1] < diagnosis.margin
    names = [cause.fit.effect.name for cause in (*diagnosis.causes, *diagnosis.visible)]
    assert len(set(names)) == len(names)
    if diagnosis.verdict == "no_evidence":
        assert diagnosis.causes == ()
        assert diagnosis.structure is None
