"""The joint with a hidden gear: equation (16) of the gear, and what a motor temperature lacks."""

import numpy as np
import pytest

from frictioncli.simulator.network_joint import COPPER_LOSS
from frictioncli.simulator.run import joint_of, run_setup, simulate
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.fast_history import FastHistory
from tests.simulation.torque_table import simulate_torques

SETTINGS = SynthesisSettings(joint_kind="network", noise_scale=0.0, runs=1)


@pytest.fixture(scope="module")
def run():
    (simulated,) = simulate([run_setup(SETTINGS, 0, np.random.SeedSequence(0))], FastHistory)
    return simulated


def test_friction_is_equation_16_of_the_gear_temperature():
    joint = joint_of("network", 2.0, 0.5)
    at = {"motor sensor": 60.0, "gear": 45.0, "housing": 30.0}
    found = joint.friction(load=30.0, speed=64.0, temperatures=at)
    expected = 10.57 + 0.0014 * 900.0 + (3.48 + 15.66 * np.exp(-0.056 * 45.0)) * 8.0
    assert float(found) == pytest.approx(expected, rel=1e-12)


def test_copper_loss_enters_at_the_motor_and_friction_heat_in_its_shares(run):
    history = run.history
    moving = next(one.power for one in history.intervals() if one.power is not None)
    at = {"motor sensor": 40.0, "gear": 40.0, "housing": 30.0}
    copper, friction = moving.parts(at)
    motor, gear, housing = history.heat_per_node(moving, at)
    assert motor == pytest.approx(copper + 0.52 * friction)
    assert gear == pytest.approx(0.48 * 0.8 * friction)
    assert motor + gear + housing == pytest.approx(moving(at))
    # the square of 30 to 90 N·m
    assert COPPER_LOSS * 900.0 < float(copper) < COPPER_LOSS * 8100.0


def test_cycle_takes_about_as_long_as_in_the_paper(run):
    phases = [one.phase for one in run.series]
    heating = run.series[phases.index("cool-down")].start / 60.0
    assert 70.0 < heating < 130.0
    assert 120.0 < run.history.time / 60.0 - heating < 350.0


def test_no_mix_of_measured_temperatures_is_that_of_the_gear(run):
    times = run.trips.begin
    speed, temperatures = run.trips.speed, run.history.at(times)
    root = np.sqrt(speed)
    friction = (3.48 + 15.66 * np.exp(-0.056 * temperatures["gear"])) * root

    def misfit(temperature) -> float:
        return min(
            float(np.sqrt(np.mean(np.square(friction - columns @ solved))))
            for delta in np.linspace(0.01, 0.12, 45)
            for columns in [
                np.column_stack([np.ones(len(root)), root, root * np.exp(-delta * temperature)])
            ]
            for solved in [np.linalg.lstsq(columns, friction, rcond=None)[0]]
        )

    motor, housing = temperatures["motor sensor"], temperatures["housing"]
    assert misfit(temperatures["gear"]) < 0.1
    assert misfit(motor) > 3.0
    assert min(misfit(w * motor + (1.0 - w) * housing) for w in np.linspace(-1, 2, 13)) > 1.2


def test_a_slow_sensor_leaves_the_gear_in_its_place():
    table = simulate_torques(
        SynthesisSettings(joint_kind="network", runs=1, highest=35, nuisances=("sensor_lag:60",))
    )
    assert table["friction_torque"].mean() > 20.0
