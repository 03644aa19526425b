"""Every cause that is named keeps the rules of a name, whatever joint and log do."""

from itertools import combinations

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.quantities import TORQUE
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.torque_table import simulate_torques

WORLDS = {
    "clean": ((), ()),
    "lag": (("thermal_lag:1.2",), ()),
    "lag and ripple": (("thermal_lag:1.2", "position_ripple:1"), ()),
    "step": (("step_change:2.4",), ()),
    "unlisted": (("position_temperature:1.5",), ()),
    "nuisances": ((), ("all",)),
    "nuisances and Stribeck friction": (("stribeck:2.1",), ("all",)),
    "nuisances and a changed torque constant": (("torque_constant:2.4",), ("all",)),
    "nuisances and drift": (("drift:4",), ("all",)),
}
"""Effects hidden, and what joint and log do besides."""

QUICK = ("nuisances",)


def diagnosed(name, seed):
    return diagnosed_joint(*WORLDS[name], seed)


def diagnosed_joint(effects, nuisances, seed):
    settings = SynthesisSettings(
        seed=seed, joint_kind="plain", effects=effects, nuisances=nuisances
    )
    return diagnose_joint(simulate_torques(settings), "motor", "N·m", DiagnosisSettings())


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
        assert diagnosis.margin < whole * low
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


@pytest.mark.parametrize(
    "name",
    [one if one in QUICK else pytest.param(one, marks=pytest.mark.slow) for one in WORLDS],
)
def test_causes_named_keep_the_rules(name):
    keeps_the_rules(diagnosed(name, 31))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [32])
@pytest.mark.parametrize("name", WORLDS)
def test_causes_named_on_other_joints_keep_the_rules(name, seed):
    keeps_the_rules(diagnosed(name, seed))


@pytest.mark.slow
def test_joints_with_nothing_hidden_have_no_named_property_under_all_nuisances():
    """Eight joints, everything ordinary at once: one name at the most."""
    named = [
        [
            cause.effects
            for cause in diagnosed("nuisances", seed).causes
            if not cause.fit.effect.measurement
        ]
        for seed in range(40, 48)
    ]
    assert sum(map(bool, named)) <= 1, named


@pytest.mark.slow
def test_what_makes_the_prediction_of_a_new_day_worse_is_not_named():
    """Friction that has run in stays as it is; a drift would go on, which day 2 refutes."""
    diagnosis = diagnosed_joint(("run_in:5.66",), ("all",), 0)
    keeps_the_rules(diagnosis)
    drift = next(cause for cause in diagnosis.visible if cause.fit.effect.name == "drift")
    assert "misfit of the run that was held out" in drift.reason
    assert "run_in" in {cause.fit.effect.name for cause in diagnosis.causes}
    assert diagnosis.gain.after < 0.5 * diagnosis.gain.before
