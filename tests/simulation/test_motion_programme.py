"""The simulator's runs of any motion: the same joint, whatever it is asked to do next."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.motion_programme import (
    MeasuredMoves,
    Standstill,
    UnrecordedMoves,
    simulate_programmes,
)

SERIES = MeasuredMoves(speeds=(20.0, 60.0, 100.0), low=0.0, high=120.0)
HEAT = UnrecordedMoves(speed=100.0, low=0.0, high=120.0, seconds=600.0)


def test_what_comes_next_does_not_change_what_was():
    settings = SynthesisSettings(seed=4, joint_kind="plain", effects=("run_in:2",))
    first = [SERIES, HEAT, SERIES]
    (alone,) = simulate_programmes(settings, [first], 1)
    followed, _ = simulate_programmes(settings, [first, [HEAT, SERIES]], 1)
    for name in ("friction_torque", "load_torque", "motor_temperature"):
        np.testing.assert_array_equal(alone[name], followed[name])


def test_friction_is_equation_16_of_the_motor_temperature():
    settings = SynthesisSettings(joint_kind="plain", noise_scale=0.0)
    (table,) = simulate_programmes(settings, [[SERIES, HEAT, SERIES]], 1)
    load, speed, warm = (
        table[name].to_numpy() for name in ("load_torque", "speed", "motor_temperature")
    )
    viscous = 3.48 + 15.66 * np.exp(-0.056 * warm)
    expected = 10.57 + 0.0014 * load**2 + viscous * np.sqrt(speed)
    assert np.max(np.abs(table["friction_torque"] - expected)) < 0.35  # means over 5 deg, one pair


def test_payloads_and_angles_are_those_asked_for():
    settings = SynthesisSettings(joint_kind="plain", noise_scale=0.0, payload=1.0)
    heavy = MeasuredMoves(speeds=(50.0,), low=30.0, high=90.0, more=4.0)
    (table,) = simulate_programmes(settings, [[SERIES, heavy]], 1)
    last = table[table["pair"] == table["pair"].max()]
    assert set(last["payload"]) == {5.0}
    assert last["position"].between(30.0, 90.0).all()
    same = table[(table["speed"] == 60.0)].set_index("position")["load_torque"]
    more = last.set_index("position")["load_torque"] - same
    angle = np.radians(more.dropna().index.to_numpy())
    arm = 4.0 * 9.80665 * (0.85 * np.cos(angle) + 0.03 * np.sin(angle))
    np.testing.assert_allclose(more.dropna(), arm, atol=0.05)


def test_heating_ends_at_its_temperature_and_standing_cools():
    settings = SynthesisSettings(joint_kind="plain", noise_scale=0.0)
    until = UnrecordedMoves(speed=100.0, low=0.0, high=120.0, seconds=20_000.0, until=30.0)
    (table,) = simulate_programmes(
        settings, [[SERIES, until, SERIES, Standstill(3600.0), SERIES]], 1
    )
    warm = pd.Series(table.groupby("pair")["motor_temperature"].first())
    assert warm[3] == pytest.approx(30.0, abs=0.6)
    assert warm[6] < warm[5] - 1.0
