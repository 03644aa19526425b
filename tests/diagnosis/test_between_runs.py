"""Days that differ a little at random are no drift and no step; a drift within them is one."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.between_runs import size_within_runs
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.rules_of_names import keeps_the_rules
from tests.simulation.changed_table import hours
from tests.simulation.torque_table import simulate_torques

pytestmark = pytest.mark.slow


def diagnosed(seed, levels, rate=0.0, torques=None, late=0.0):
    """Diagnose days with so many per cent or N·m more friction each, and a drift [N·m/h].

    Near the end of the second day friction rises by a torque and stays there.
    """
    table = simulate_torques(SynthesisSettings(seed=seed, runs=len(levels), joint_kind="plain"))
    day = table["run"].astype(str).str.removeprefix("day").astype(int).to_numpy() - 1
    friction = table["friction_torque"].to_numpy(float)
    time = hours(table) + hours(table).max() * day
    added = friction * np.array(levels)[day] / 100 + rate * time
    if torques is not None:
        added = added + np.array(torques)[day]
    begun = np.quantile(hours(table)[day == 1], 0.9)
    added = added + late * ((day > 1) | ((day == 1) & (hours(table) > begun)))
    changed = table.assign(
        friction_torque=friction + added,
        torque_forward=table["torque_forward"] + added,
        torque_reverse=table["torque_reverse"] - added,
    )
    diagnosis = diagnose_joint(changed, "motor", "N·m", DiagnosisSettings())
    keeps_the_rules(diagnosis)
    return diagnosis


@pytest.mark.parametrize(
    ("seed", "levels", "name"),
    [
        pytest.param(17, [1.4, 0.4, -0.7, -1.6], "drift", id="by chance in order"),
        pytest.param(21, [0.5, 2.4, 0.1, 2.3], "step_change", id="one day higher"),
    ],
)
def test_days_that_differ_by_less_than_days_do_have_no_cause(seed, levels, name):
    diagnosis = diagnosed(seed, levels)
    assert diagnosis.causes == ()
    (cause,) = (one for one in diagnosis.visible if one.fit.effect.name == name)
    assert "from day to day" in cause.reason


def test_a_drift_that_shows_within_the_days_is_named():
    diagnosis = diagnosed(0, [0.1, 0.0, 0.3], rate=0.25)
    (cause,) = diagnosis.causes
    assert cause.fit.effect.name == "drift"
    assert cause.fit.coefficients == pytest.approx([0.25], abs=0.1)


def test_a_day_that_differs_by_more_than_days_do_has_a_step():
    diagnosis = diagnosed(21, np.zeros(4), torques=[0.0, -2.7, 0.0, 0.0])
    (cause,) = diagnosis.causes
    assert cause.fit.effect.name == "step_change"
    assert cause.holds_on_new_run is False


@pytest.mark.parametrize(("late", "is_named"), [(1.6, True), (0.3, False)])
def test_a_step_near_the_end_of_a_day_that_lasts_is_named(late, is_named):
    """A tenth of the day shows it, and the whole of the next one."""
    diagnosis = diagnosed(3, np.zeros(3), late=late)
    names = [one.fit.effect.name for one in diagnosis.causes]
    assert names == (["step_change"] if is_named else [])
    if is_named:
        (cause,) = diagnosis.causes
        assert cause.holds_on_new_run
        assert cause.fit.coefficients == pytest.approx([late], rel=0.3)


@pytest.fixture(scope="module")
def two_days():
    """Two days; the second is heated less, and so has other rates at the same temperatures."""
    table = simulate_torques(SynthesisSettings(seed=4, runs=3, joint_kind="plain"))
    less = (table["run"] == "day2") & (table["motor_temperature"] > 50)
    problem, _ = build_problems(table[~less], "motor", "day3")
    return problem


@pytest.mark.parametrize("name", ["sensor_lag", "thermal_lag"])
@pytest.mark.parametrize(("by_lag", "expected"), [(1.0, 1.0), (0.0, 0.0)])
def test_a_sensor_that_was_replaced_is_no_lag_within_the_days(two_days, name, by_lag, expected):
    """The torque of a lag on both days, or that of 1.2 °C by which the sensor of one is off."""
    effect, table = BY_NAME[name], two_days.table
    shape = {one.name: 1800.0 for one in effect.shape}
    columns = two_days.basis(effect, shape).friction
    coefficients = np.array([60.0] if name == "sensor_lag" else [0.9, 4.0, 0.0, 0.0])
    replaced = 1.2 * (two_days.layout.run[two_days.layout.row_pair] == 1)
    torque = columns @ coefficients if by_lag else replaced * table.temperature_slope
    simulated = two_days.friction - two_days.friction_misfit
    problem = replace(two_days, friction=simulated + torque)
    found = np.linalg.lstsq(columns, torque, rcond=None)[0]
    fit = EffectFit(effect, shape, found, np.eye(len(found)), 0.0)
    assert size_within_runs(fit, [], problem) == pytest.approx(expected, abs=0.02)
