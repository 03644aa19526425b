"""Levels of runs against what was put into them."""

import numpy as np
import pytest

from frictioncli.comparison.run_levels import (
    constant_and_viscous_components,
    constant_component,
    load_levels,
    plausible_noises,
    run_levels,
)
from frictioncli.diagnosis.data.build_problem import build_problems
from tests.equation_16 import daily_torques


def problem_of(table):
    return build_problems(table, "motor")[0]


def levels_of(problem, components, load_scale=None):
    scale = np.ones(len(problem.runs)) if load_scale is None else load_scale
    return run_levels(problem, components, plausible_noises(problem, scale), scale)


def differences(levels):
    return levels.coefficients[:, 0] - levels.coefficients[0, 0]


def test_offsets_come_back_without_noise():
    offset = [0.0, 0.5, -0.3, 1.2]
    problem = problem_of(daily_torques(4, offset=offset, noise=1e-4))
    found = levels_of(problem, constant_component(problem))
    assert found.comparable
    np.testing.assert_allclose(differences(found), offset, atol=2e-3)


@pytest.mark.long
def test_errors_are_what_the_spread_over_repetitions_shows():
    found = []
    for seed in range(8):
        problem = problem_of(daily_torques(3, seed=seed, noise=0.3))
        levels = levels_of(problem, constant_component(problem))
        covariance = levels.covariance
        variance = covariance[0, 0] + covariance[2, 2] - 2 * covariance[0, 2]
        found.append((differences(levels)[2], np.sqrt(variance)))
    spread, stated = np.std([one for one, _ in found]), np.mean([one for _, one in found])
    assert 0.5 < stated / spread < 2.5  # the spread of eight is known within a factor of 1.7


def test_other_temperatures_are_no_change():
    winter, summer = np.linspace(18, 40, 8), np.linspace(30, 55, 8)
    problem = problem_of(daily_torques(3, warmth=[winter, winter, summer], noise=1e-3))
    found = levels_of(problem, constant_component(problem))
    np.testing.assert_allclose(differences(found), 0.0, atol=0.1)


def test_the_viscous_part_is_told_from_the_constant_one():
    table = daily_torques(2, noise=1e-4)
    last = table["run"] == "d02"
    # 10 % more viscous friction in the second run, by the formula of the world
    viscous = (3 + 15 * np.exp(-0.05 * table["motor_temperature"])) * np.sqrt(table["speed"])
    table.loc[last, "friction_torque"] += 0.1 * viscous[last]
    problem = problem_of(table)
    found = levels_of(problem, constant_and_viscous_components(problem))
    change = found.coefficients[1] - found.coefficients[0]
    assert found.comparable
    assert change[0] == pytest.approx(0.0, abs=0.05)
    # against the mean of both runs, which have 5 % more than the first one
    assert change[1] == pytest.approx(0.1 / 1.05, abs=0.005)


def test_runs_at_temperatures_of_their_own_cannot_be_compared():
    table = daily_torques(3, warmth=[np.full(8, 20.0), np.full(8, 20.0), np.full(8, 45.0)])
    problem = problem_of(table[table["speed"] == 45.0])
    found = levels_of(problem, constant_and_viscous_components(problem))
    assert not found.comparable


def test_a_heavier_payload_is_seen_in_the_load_and_not_in_the_friction():
    problem = problem_of(daily_torques(4, carried=[0.0, 0.0, 0.3, 0.3], noise=0.01))
    scales, _ = load_levels(problem)
    assert (1 + scales[3] / 100) / (1 + scales[0] / 100) == pytest.approx(1.3, rel=1e-3)
    blind = levels_of(problem, constant_component(problem))
    seeing = levels_of(problem, constant_component(problem), 1 + scales / 100)
    assert abs(differences(blind)[3]) > 1.0  # alpha L² of a load greater by 30 %
    assert differences(seeing)[3] == pytest.approx(0.0, abs=0.1)


def test_a_joint_without_gravity_has_no_load_to_compare():
    table = daily_torques(2)
    assert load_levels(problem_of(table.assign(load_torque=0.01 * table["load_torque"]))) is None
