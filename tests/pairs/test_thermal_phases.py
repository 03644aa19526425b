"""Phases follow the trend of the motor temperature."""

import numpy as np
import pandas as pd

from frictioncli.pairs import thermal_phases
from tests.found import pairs
from tests.moves import move_sequence, samples


def phases_of(temperature):
    found = thermal_phases.phases(temperature)
    return thermal_phases.phases_of(np.arange(len(temperature)), found)


def test_a_thermal_cycle_is_heat_up_then_cool_down():
    temperature = np.concatenate([np.arange(25, 66), np.arange(64, 24, -1)]).astype(float)
    phases = phases_of(temperature)
    assert set(phases[:41]) == {"heat-up"}
    assert set(phases[41:]) == {"cool-down"}


def test_staircase_noise_does_not_make_phases():
    generator = np.random.default_rng(0)
    temperature = np.linspace(25, 65, 200) + generator.uniform(-1, 1, 200)
    assert set(phases_of(temperature)) == {"heat-up"}


def test_two_cycles_are_four_phases():
    leg = np.linspace(25, 60, 30)
    phases = phases_of(np.concatenate([leg, leg[::-1], leg, leg[::-1]]))
    changes = [name for i, name in enumerate(phases) if i == 0 or name != phases[i - 1]]
    assert changes == ["heat-up", "cool-down", "heat-up", "cool-down"]


def test_steady_and_unknown_temperature_are_sweeps():
    assert set(phases_of(np.array([30.0, 31, 30, 32, 31]))) == {"sweep"}
    assert set(phases_of(np.full(4, np.nan))) == {"sweep"}
    assert set(phases_of(np.array([20.0]))) == {"sweep"}


def test_a_given_phase_wins():
    """Four recordings of a joint that warms up by 10 °C each; the manifest speaks of the first."""
    motion = move_sequence([0, 170] * 6, [40] * 11)
    number = np.minimum(4 * np.arange(len(motion)) // len(motion), 3)
    frame = samples(
        motion,
        friction=5.0,
        recording=np.array(["a", "b", "c", "d"], dtype=object)[number],
        motor_temperature=20.0 + 10 * number,
    )
    said = pd.Series({("day1", "a"): "sweep"}, dtype=object)
    heads = pairs(frame, phase=said).pairs.drop_duplicates("pair")
    assert (heads["motor_temperature"] == 20).any()
    expected = np.where(heads["motor_temperature"] == 20, "sweep", "heat-up")
    assert heads["phase"].tolist() == expected.tolist()
