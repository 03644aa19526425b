"""The temperature of friction, estimated in joints that are thermal networks.

The networks are integrated by a solver of differential equations (tests.diagnosis.thermal_joint);
the last day is kept out.
"""

import functools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.data.build_problem import at_temperature, build_problems
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.thermal.estimate import (
    MEASURED,
    WITH_HOUSING,
    ThermalEstimate,
    estimate_temperature,
    simplest_as_good,
)
from frictioncli.diagnosis.thermal.refine import refine_thermal
from frictioncli.diagnosis.thermal.statement import temperature_statement
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import Basis
from frictioncli.model.friction import FrictionParameters
from tests.diagnosis.thermal_joint import BINS, DELTA, GRAVITY, Network, friction, torques

NOISE = 0.25
FLOOR = NOISE * np.sqrt(1 + 1 / 4)
"""Standard deviation of a bin: its own noise, and half as much that its pair shares. [N·m]"""

NETWORKS = {
    "conduction": Network(motor_heat=1.0),
    "heated": Network(motor_heat=0.3),
    "housing": Network(node="housing", gear_housing=6.0, housing_ambient=0.8),
    "motor": Network(node="motor"),
}


@functools.cache
def logged(name: str) -> tuple[pd.DataFrame, np.ndarray]:
    """Two days of a joint, and the temperature of its gear in each pair."""
    return torques(NETWORKS[name])


@functools.cache
def days(name: str, housing: bool = True) -> tuple[Problem, Problem]:
    rows, _ = logged(name)
    rows = rows if housing else rows.assign(housing_temperature=np.nan)
    problem, new = build_problems(rows, "motor", "day1")
    assert new is not None
    return problem, new


@functools.cache
def estimated(name: str, housing: bool = True) -> ThermalEstimate:
    return estimate_temperature(days(name, housing)[0])


def left(problem: Problem, estimate: ThermalEstimate) -> float:
    """Return the RMS that equation (16) at the estimated temperature misses of friction."""
    warm = at_temperature(problem, estimate.parameters, estimate.hidden)
    return float(np.sqrt(np.mean(np.square(warm.friction - warm.table.friction))))


@pytest.mark.parametrize("name", ["conduction", pytest.param("heated", marks=pytest.mark.long)])
def test_a_hidden_gear_predicts_the_day_kept_out(name):
    """Within 1.25 of the noise where the measured temperature misses many times as much."""
    estimate, (_, new) = estimated(name), days(name)
    assert estimate.chosen.structure.name == "one_node"
    assert left(new, estimate) < 1.25 * FLOOR
    assert np.sqrt(np.mean(np.square(new.friction_misfit))) > 2 * FLOOR


@pytest.mark.parametrize(("name", "most"), [("conduction", 2.0), ("heated", 1.25)])
def test_so_does_one_without_a_measured_housing(name, most):
    """Where the gear is heated through the motor, the other day's ambient shows: it is 2 °C off."""
    estimate, (_, new) = estimated(name, housing=False), days(name, housing=False)
    assert estimate.chosen.structure.name in ("one_node", "two_nodes")
    assert left(new, estimate) < most * FLOOR


def test_time_constant_and_shares_are_those_of_the_network():
    """A gear of 7500 J/K at 3 W/K to the motor and 1.5 W/K to the housing, heated by no more."""
    found = estimated("conduction").estimates
    for parameter, truth in (
        ("time_constant", 7500 / 4.5),
        ("lag_share", 3 / 4.5),
        ("housing_lag_share", 1.5 / 4.5),
    ):
        assert found[parameter].low < truth < found[parameter].high, parameter
    assert found["time_constant"].high < 2 * found["time_constant"].low
    assert estimated("conduction").parameters.delta == pytest.approx(DELTA, rel=0.1)


def test_the_temperature_of_the_gear_is_that_of_the_network():
    """In the motor's temperature alone it would be off by many degrees."""
    table, gear = logged("conduction")
    found = estimated("conduction").temperature
    assert np.sqrt(np.mean(np.square(found - gear))) < 1.0
    motor = table.groupby(["run", "pair"])["motor_temperature"].first().to_numpy()
    assert np.sqrt(np.mean(np.square(motor - gear))) > 5.0


def test_torque_that_is_late_does_not_move_the_temperature():
    """By 50 ms, it adds 0.05 v dL/dq: 3 N·m at 100 deg/s over these angles."""
    table, gear = logged("conduction")
    slope = np.gradient(GRAVITY, BINS)[np.searchsorted(BINS, table["position"])]
    late = table.assign(friction_torque=table["friction_torque"] - 0.05 * table["speed"] * slope)
    problem, new = build_problems(late, "motor", "day1")
    refined = refine_thermal(problem, new, measurement=MEASUREMENT_EFFECTS)
    assert np.sqrt(np.mean(np.square(refined.estimate.temperature - gear))) < 1.0
    assert refined.estimate.parameters.delta == pytest.approx(DELTA, rel=0.1)
    ignored = refine_thermal(problem, new).estimate
    assert refined.estimate.chosen.criterion < ignored.chosen.criterion - 50.0


def test_friction_at_the_housing_is_told_as_an_option():
    estimate, (_, new) = estimated("housing"), days("housing")
    assert estimate.chosen.structure.name == "housing"
    assert left(new, estimate) < 1.25 * FLOOR
    assert "use --temperature housing" in temperature_statement(estimate, "N·m")


@pytest.mark.parametrize("housing", [True, False])
def test_friction_at_the_motor_needs_no_hidden_temperature(housing):
    assert estimated("motor", housing).hidden is None
    problem, new = days("motor", housing)
    assert refine_thermal(problem, new) is None


@pytest.mark.parametrize("name", ["stribeck", "linear_viscous", "drift", "step", "coulomb"])
def test_other_effects_at_the_motor_are_no_hidden_temperature(name):
    """1 N·m RMS and more of another cause, whose column stands beside the base."""
    problem, _ = days("motor")
    table = problem.table
    column = {
        "stribeck": 5.0 * np.exp(-((table.speed / 25.0) ** 2)),
        "linear_viscous": 0.05 * table.speed,
        "drift": 4.0 * table.time / table.time.max(),
        "step": 3.0 * (table.time > 0.4 * table.time.max()),
        "coulomb": -1.0 * (table.motor_temperature - 25.0) / 10.0,
    }[name]
    changed = logged("motor")[0].copy()
    rows = changed.sort_values(["run", "time", "pair", "position"]).index
    first = np.flatnonzero((changed["run"] == "day0").to_numpy()[rows])
    more = np.zeros(len(changed))
    more[rows[first]] = column
    changed["friction_torque"] += more
    other, _ = build_problems(changed, "motor", "day1")
    basis = Basis((column / column.max())[:, np.newaxis], np.zeros((len(column), 1)))
    assert estimate_temperature(other, [basis]).hidden is None


def test_a_statement_gives_time_shares_and_what_a_mix_would_leave():
    text = temperature_statement(estimated("conduction"), "N·m")
    assert text.startswith("The gear follows the motor (")
    assert "the housing (" in text
    assert " min (" in text


def test_what_the_gear_follows_is_not_stated_where_both_shares_may_be_any():
    found = estimated("conduction")
    shares = ("lag_share", "housing_lag_share")
    unknown = {name: replace(found.estimates[name], low=0.0, high=1.0) for name in shares}
    known = temperature_statement(found, "N·m")
    text = temperature_statement(replace(found, estimates={**found.estimates, **unknown}), "N·m")
    assert text.startswith("The gear follows the motor, the housing or both (these data")
    assert "%)" not in text.split(".")[0]
    assert text.partition("with a time")[2] == known.partition("with a time")[2]


def test_friction_is_simulated_at_the_hidden_temperature():
    """By hand: equation (16) at T + E, carried back along the slope to the measured T."""
    problem, _ = days("heated")
    parameters = FrictionParameters(tau_c=10.6, alpha=0.0014, beta=3.5, gamma=15.7, delta=0.056)
    half = HiddenTemperature.of(600.0, np.array([0.0, 0.0, 0.5, 0.0]), problem.reference_power)
    warm = at_temperature(problem, parameters, half)
    table = problem.table
    between = (table.motor_temperature + table.housing_temperature) / 2
    np.testing.assert_allclose(warm.table.temperature, between)
    expected = friction(table.speed, between, table.load)
    np.testing.assert_allclose(warm.table.friction, expected, rtol=1e-12)
    slope = -0.056 * 15.7 * np.exp(-0.056 * between) * np.sqrt(table.speed)
    back = expected - slope * (between - table.motor_temperature)
    np.testing.assert_allclose(warm.friction_misfit, warm.friction - back, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(
        at_temperature(warm, parameters, None).table.temperature, table.motor_temperature
    )
    assert len(BINS) * len(problem.layout.bins) == len(table.time)


WHOLE = {one.parts: one for one in WITH_HOUSING if one.whole}
PARTLY = {one.parts: one for one in WITH_HOUSING if not one.whole and one.times}


@pytest.mark.parametrize(
    ("criteria", "chosen"),
    [
        # a gear with all the friction, up to 20 behind one that has a part of it
        ({PARTLY[0, 1, 3]: -19.0, WHOLE[1, 3]: 0.0, MEASURED: 300.0}, WHOLE[1, 3]),
        ({PARTLY[0, 1, 3]: -21.0, WHOLE[1, 3]: 0.0, MEASURED: 300.0}, PARTLY[0, 1, 3]),
        # of two with all the friction the simpler one only up to 10 behind
        ({WHOLE[1, 3]: -9.0, WHOLE[1,]: 0.0, MEASURED: 300.0}, WHOLE[1,]),
        ({WHOLE[1, 3]: -11.0, WHOLE[1,]: 0.0, MEASURED: 300.0}, WHOLE[1, 3]),
        ({PARTLY[0, 1, 3]: -18.0, WHOLE[1, 3]: -11.0, WHOLE[1,]: 0.0}, WHOLE[1, 3]),
        ({WHOLE[1, 3]: -11.0, WHOLE[1,]: -9.0, MEASURED: -3.0}, MEASURED),
    ],
)
def test_the_simplest_network_that_is_as_good_as_the_best(criteria, chosen):
    rivals = [
        SimpleNamespace(structure=structure, criterion=value, left=1.0 + value / 1000)
        for structure, value in criteria.items()
    ]
    ranked = sorted(rivals, key=lambda one: one.criterion)
    assert simplest_as_good(ranked, 1e-6).structure is chosen
