"""Corrections cure what they can: a constant offset, a drifting one; and failures are counted."""

import numpy as np
import pytest

from frictioncli import schemas
from frictioncli.correction.evaluation import epsilon, evaluate
from frictioncli.correction.replay import phase_data, replay, smoothed_friction
from frictioncli.correction.settings import (
    CorrectionSettings,
    EvaluationGrid,
    ScheduleSettings,
)
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.model.friction import PUBLISHED
from frictioncli.model.zero_load import friction_at_zero_load
from tests.correction.models import QUIET, published_model, shifted, simulated
from tests.equation_16 import torques


def test_a_constant_offset_is_found_exactly_by_the_first_correction():
    rows = simulated(shifted(7.0))
    np.testing.assert_allclose(rows["temperature_correction"], 7.0, atol=1e-6)
    np.testing.assert_allclose(rows["friction_predicted"], rows["friction_torque"], atol=1e-6)
    assert rows["corrected"].groupby(rows["phase"]).first().all()


def test_without_correction_the_offset_remains():
    """At 67.5 deg/s and 45 °C, 7 °C make 15.66 sqrt(67.5) (exp(-2.52) - exp(-2.128)) = -4.97."""
    rows = simulated(shifted(7.0), criterion="none")
    assert not rows["corrected"].any()
    assert (rows["temperature_correction"] == 0).all()
    row = rows[(rows["speed"] == 67.5) & np.isclose(rows["temperature_parameter"], 38.0)].iloc[0]
    error = row["friction_torque"] - row["friction_predicted"]
    assert error == pytest.approx(15.66 * np.sqrt(67.5) * (0.080460 - 0.119070), abs=0.01)


def test_rows_follow_the_schema():
    rows = simulated(shifted(0.0))
    assert set(schemas.SCHEDULE.names) == set(rows.columns)
    grid = EvaluationGrid(k=(2.0, 5.0), tmax=(1800.0,))
    found, _ = evaluate(torques(1), published_model(), CorrectionSettings(), grid)
    assert set(schemas.EVALUATION.names) == set(found.columns)
    # per phase: none, two k with three criteria, and every bound with equal spacing beside it
    assert len(found) == 2 * (1 + 2 * 3 + 2 * len(grid.bound))


def test_evaluation_agrees_with_simulation():
    table = torques(2)
    rows = simulated(table, k=3.0, tmax=1800.0)
    grid = EvaluationGrid(k=(3.0,), tmax=(1800.0,))
    found, _ = evaluate(table, published_model(), CorrectionSettings(), grid)
    for phase, part in rows.groupby("phase"):
        cell = found[(found["phase"] == phase) & (found["criterion"] == "first_degree")].iloc[0]
        assert cell["corrections"] == part["corrected"].sum()
        error = part["friction_predicted"] - part["friction_smoothed"]
        assert cell["epsilon"] == pytest.approx(np.sqrt(np.mean(error**2)))
        assert epsilon(part, "friction_smoothed") == pytest.approx(cell["epsilon"])


def test_equal_spacing_makes_as_many_corrections():
    grid = EvaluationGrid(k=(2.0, 5.0), tmax=(1800.0, 3600.0))
    found, _ = evaluate(torques(2), published_model(), CorrectionSettings(), grid)
    found, keys = found[found["bound"].isna()], ["phase", "k", "tmax"]
    counts = {
        name: found[found["criterion"] == name].set_index(keys)["corrections"]
        for name in ("first_degree", "equal")
    }
    assert counts["first_degree"].equals(counts["equal"])


def test_failed_inversions_keep_the_last_correction_and_are_counted():
    """In the middle of the cycle friction falls below what any temperature explains."""
    table = shifted(3.0)
    heating = table["phase"] == "heat-up"
    dead = heating & table["time"].between(2000, 4000)
    table.loc[dead, "friction_torque"] -= 200.0
    rows = simulated(table, k=2.0)
    failed = rows[rows["failed"]]
    assert len(failed) > 0
    assert failed["corrected"].all()
    np.testing.assert_allclose(rows["temperature_correction"], 3.0, atol=1e-6)


def test_corrections_use_the_pair_nearest_in_time_at_the_correction_speed():
    pairs = friction_at_zero_load(torques(0, **QUIET), PUBLISHED.alpha)
    heating = pairs[pairs["phase"] == "heat-up"]
    data = phase_data(heating, correction_speed=60.0, degree=3)
    assert (data.speed[data.correction_pair] == 67.5).all()
    distance = np.abs(data.time[data.correction_pair] - data.time)
    assert distance.max() <= 20.0 + 1e-9


def test_a_replay_without_corrections_predicts_from_the_motor_temperature():
    pairs = friction_at_zero_load(torques(0, **QUIET), PUBLISHED.alpha)
    data = phase_data(pairs[pairs["phase"] == "cool-down"], correction_speed=67.5, degree=3)
    result = replay(data, PUBLISHED, [])
    assert result.epsilon(data.friction) == pytest.approx(0.0, abs=1e-6)


def test_smoothing_keeps_a_cubic_and_removes_noise():
    temperature = np.linspace(25, 65, 200)
    cubic = 80 - 2 * temperature + 0.03 * temperature**2 - 1e-4 * temperature**3
    noise = np.random.default_rng(0).normal(0, 1.0, 200)
    smooth = smoothed_friction(
        temperature=temperature, speed=np.full(200, 50.0), friction=cubic + noise, degree=3
    )
    assert np.sqrt(np.mean((smooth - cubic) ** 2)) < 0.25


def test_two_pairs_of_a_speed_are_not_replaced_by_their_mean():
    """At 20 and 50 °C they differ by the fall with temperature, not by noise."""
    friction = np.array([60.0, 40.0, 80.0, 70.0, 60.0, 50.0])
    smooth = smoothed_friction(
        temperature=np.array([20.0, 50.0, 20.0, 30.0, 40.0, 50.0]),
        speed=np.array([10.0, 10.0, 50.0, 50.0, 50.0, 50.0]),
        friction=friction,
        degree=3,
    )
    np.testing.assert_allclose(smooth, friction, atol=1e-9)


def test_no_thermal_cycle_is_named():
    with pytest.raises(NotEnoughData, match="no heat-up or cool-down"):
        simulated(torques(0).assign(phase="sweep"))


def test_a_model_without_temperature_is_named():
    with pytest.raises(NotEnoughData, match="no dependence of friction on temperature"):
        simulated(torques(0), published_model(gamma=0.0, delta=0.0))


@pytest.mark.parametrize(
    "wrong", [{"criterion": "often"}, {"k": 0.0}, {"tmax": -1.0}, {"k": float("nan")}]
)
def test_senseless_schedules_are_refused(wrong):
    with pytest.raises(OptionError, match="expected"):
        ScheduleSettings(**wrong)


def test_an_empty_grid_is_refused():
    with pytest.raises(OptionError, match="nothing"):
        EvaluationGrid(k=())
