"""Predicted rows, against the simulator, which shares no code with the prediction."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from frictioncli.design.planned_joint import PlannedJoint, planning_columns
from frictioncli.design.predicted_rows import constant_speed_bins, predict_rows
from frictioncli.design.steps import HeatStep, RestStep, SeriesStep
from frictioncli.design.thermal_model import thermal_model_of
from frictioncli.diagnosis.data.build_problem import build_problems
from tests.design.examples import FASTEST, SPEEDS, heating_runs


@pytest.fixture(scope="module")
def runs():
    return heating_runs()


@pytest.fixture(scope="module")
def joint(runs):
    problem, _ = build_problems(runs[0], "motor")
    return PlannedJoint(
        torques=planning_columns(runs[0]),
        temperature="motor",
        parameters=problem.parameters,
        gravity=problem.gravity,
        thermal_model=thermal_model_of(runs[0]),
    )


@pytest.fixture(scope="module")
def planned(joint):
    series = SeriesStep(speeds=SPEEDS, low=0.0, high=180.0)
    heat = HeatStep(speed=FASTEST, low=0.0, high=180.0, seconds=1200.0, until=80.0)
    return predict_rows(joint, [series, heat, series, RestStep(1500.0), series], "planned")


def test_motor_temperatures_are_predicted(runs, planned):
    true = runs[1].groupby("pair")["motor_temperature"].first().to_numpy()
    table, _ = planned
    predicted = table.groupby("pair")["motor_temperature"].first().to_numpy()
    assert len(predicted) == len(true)
    assert np.ptp(true) > 10.0
    assert np.max(np.abs(predicted - true)) < 0.15 * np.ptp(true)


def test_friction_and_load_are_predicted(runs, planned):
    true, predicted = (
        one.groupby("pair")[["friction_torque", "load_torque"]].mean()
        for one in (runs[1], planned[0])
    )
    away = (predicted - true).abs()
    # two degrees of a predicted temperature are one or two N·m of friction
    assert away["friction_torque"].max() < 0.06 * true["friction_torque"].mean()
    assert away["load_torque"].max() < 3.0


def test_times_are_those_of_the_motion(runs, planned):
    true = runs[1].groupby("pair")["time"].first().to_numpy()
    predicted = planned[0].groupby("pair")["time"].first().to_numpy()
    assert predicted[-1] - predicted[0] == pytest.approx(true[-1] - true[0], rel=0.03)


def test_bins_are_those_that_have_constant_speed(runs, planned):
    """The simulated axis accelerates twice as hard: it loses no bin that the plan counts."""
    for speed in SPEEDS:
        true = set(runs[1].loc[runs[1]["speed"] == speed, "position"])
        predicted = set(constant_speed_bins(speed, 0.0, 180.0, 5.0))
        assert predicted <= true
        assert len(predicted) >= 0.7 * len(true)


def test_timings_follow_each_other(planned):
    _, timings = planned
    assert timings[0].start == 0.0
    for before, after in pairwise(timings):
        assert after.start == before.end
        assert after.temperatures[0] == before.temperatures[1]


def test_unrecorded_heating_shows_in_the_travel(runs):
    """Eight times 300 s at full speed (the last is followed by a pause in which it cools), and
    11 series of round trips of 165, 155, 135 and 105 deg, the angles that have bins, before the
    last one."""
    hidden, known = 8 * 300.0 * FASTEST, 11 * 2 * (165.0 + 155.0 + 135.0 + 105.0)
    problem, _ = build_problems(runs[0], "motor")
    last = problem.table.travel[problem.table.order == 0][-1]
    assert last == pytest.approx(hidden + known, rel=0.05)


def test_moves_wait_while_the_motor_is_too_hot(joint):
    """A first-order body cools from 30 to 20 °C above ambient in ln 1.5 time constants."""
    model = joint.thermal_model
    warm = replace(joint, waiting=model.ambient + 20.0)
    heat = HeatStep(speed=FASTEST, low=0.0, high=180.0, seconds=36_000.0, until=model.ambient + 30)
    series = SeriesStep(speeds=(20.0,) * 3, low=0.0, high=180.0)
    table, timings = predict_rows(warm, [heat, series], "planned")
    _, unhindered = predict_rows(joint, [heat, series], "planned")
    hot = timings[0].temperatures[1] - model.ambient
    assert hot >= 30.0
    assert table["motor_temperature"].max() < warm.waiting + 0.5
    waited = timings[1].end - unhindered[1].end
    assert waited == pytest.approx(model.time_constant * np.log(hot / 20.0), rel=0.05)
