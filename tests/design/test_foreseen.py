"""What a programme is foreseen to give, against the simulator, which knows nothing of it."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from frictioncli.design.predicted_rows import PlannedJoint, constant_bins, foreseen, plain
from frictioncli.design.steps import HeatStep, RestStep, SeriesStep
from frictioncli.design.thermal_model import ThermalModel, thermal_model_of
from frictioncli.diagnosis.data.problem import build_problems
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.motion_programme import (
    MeasuredMoves,
    Standstill,
    UnrecordedMoves,
    simulate_programmes,
)

FASTEST = 101.2
SPEEDS = (19.1, 39.4, 67.5, FASTEST)


@pytest.fixture(scope="module")
def runs():
    """A thin experiment with heating and cooling, and another programme on the same joint."""
    series = MeasuredMoves(speeds=SPEEDS, low=0.0, high=180.0)
    heat = UnrecordedMoves(speed=FASTEST, low=0.0, high=180.0, seconds=300.0)
    first = [*[series, heat] * 8, *[Standstill(900.0), series] * 4]
    other = [series, *[heat] * 4, series, Standstill(1500.0), series]
    settings = SynthesisSettings(seed=11, joint_kind="plain", noise_scale=0.0)
    return simulate_programmes(settings, [first, other], 1)


@pytest.fixture(scope="module")
def joint(runs):
    problem, _ = build_problems(runs[0], "motor")
    return PlannedJoint(
        torques=plain(runs[0]),
        temperature="motor",
        parameters=problem.parameters,
        gravity=problem.gravity,
        warmth=thermal_model_of(runs[0]),
    )


@pytest.fixture(scope="module")
def planned(joint):
    series = SeriesStep(speeds=SPEEDS, low=0.0, high=180.0)
    heat = HeatStep(speed=FASTEST, low=0.0, high=180.0, seconds=1200.0, until=80.0)
    return foreseen(joint, [series, heat, series, RestStep(1500.0), series], "planned")


def test_motor_temperatures_are_foreseen(runs, planned):
    true = runs[1].groupby("pair")["motor_temperature"].first().to_numpy()
    table, _ = planned
    said = table.groupby("pair")["motor_temperature"].first().to_numpy()
    assert len(said) == len(true)
    assert np.ptp(true) > 10.0
    assert np.max(np.abs(said - true)) < 0.15 * np.ptp(true)


def test_friction_and_load_are_foreseen(runs, planned):
    true, said = (
        one.groupby("pair")[["friction_torque", "load_torque"]].mean()
        for one in (runs[1], planned[0])
    )
    away = (said - true).abs()
    # two degrees of a foreseen temperature are one or two N·m of friction
    assert away["friction_torque"].max() < 0.06 * true["friction_torque"].mean()
    assert away["load_torque"].max() < 3.0


def test_times_are_those_of_the_motion(runs, planned):
    true = runs[1].groupby("pair")["time"].first().to_numpy()
    said = planned[0].groupby("pair")["time"].first().to_numpy()
    assert said[-1] - said[0] == pytest.approx(true[-1] - true[0], rel=0.03)


def test_bins_are_those_that_have_constant_speed(runs, planned):
    """The simulated axis accelerates twice as hard: it loses no bin that the plan counts."""
    for speed in SPEEDS:
        true = set(runs[1].loc[runs[1]["speed"] == speed, "position"])
        said = set(constant_bins(speed, 0.0, 180.0, 5.0))
        assert said <= true
        assert len(said) >= 0.7 * len(true)


def test_moments_follow_each_other(planned):
    _, moments = planned
    assert moments[0].start == 0.0
    for before, after in pairwise(moments):
        assert after.start == before.end
        assert after.temperatures[0] == before.temperatures[1]


def test_a_known_thermal_law_is_found_again():
    """Temperatures from the law's closed form, stretch by stretch, heating and cooling."""
    law = ThermalModel(ambient=20.0, time_constant=4000.0, heating=1e-6, housing_share=0.6)
    speed, friction, low, high = 100.0, 60.0, 0.0, 150.0
    warm, rows = 20.0, []
    for number in range(400):
        moves = number < 250
        rows.append((5.0 * number, warm, speed if moves else 150.0 / 1e6, friction if moves else 0))
        warm = law.after(warm, 5.0, power=speed * friction * (2 * 150.0 / speed / 5.0) * moves)
    table = pd.DataFrame(
        [
            {
                "run": "a",
                "pair": number,
                "time": time,
                "speed": 100.0,
                "motor_temperature": motor,
                "housing_temperature": 20.0 + 0.6 * (motor - 20.0),
                "friction_torque": tau,
                "position": position,
            }
            for number, (time, motor, _, tau) in enumerate(rows)
            for position in (low, high)
        ]
    )
    found = thermal_model_of(table)
    assert found.ambient == 20.0
    assert found.time_constant == pytest.approx(4000.0, rel=0.15)
    assert found.heating == pytest.approx(1e-6, rel=0.1)
    assert found.housing_share == pytest.approx(0.6, rel=1e-6)


def test_a_motor_heats_to_balance_and_cools_to_ambient():
    law = ThermalModel(ambient=20.0, time_constant=4000.0, heating=1e-6, housing_share=0.6)
    assert law.after(20.0, 1e7, power=5000.0) == pytest.approx(20.0 + 1e-6 * 5000.0 * 4000.0)
    assert law.after(60.0, 4000.0) == pytest.approx(20.0 + 40.0 / np.e)


def test_without_a_temperature_there_is_no_thermal_law(runs):
    assert thermal_model_of(runs[0].assign(motor_temperature=np.nan)) is None


def test_unrecorded_heating_shows_in_the_way(runs):
    """Seven times 300 s at full speed (the eighth is followed by a pause and cannot be told), and
    11 series of round trips of 165, 155, 135 and 105 deg, the angles that have bins, before the
    last one."""
    hidden, known = 7 * 300.0 * FASTEST, 11 * 2 * (165.0 + 155.0 + 135.0 + 105.0)
    problem, _ = build_problems(runs[0], "motor")
    last = problem.table.travel[problem.table.order == 0][-1]
    assert last == pytest.approx(hidden + known, rel=0.05)
