"""Columns of effects that differ from pair to pair, by hand from their equations."""

import numpy as np
import pytest

from frictioncli.effects import BY_NAME
from frictioncli.effects.run_in import OF_LOGGED, logged_travel
from tests.effects.tables import friction, load, small


def test_stribeck_falls_to_a_share_of_1_by_e_at_its_velocity():
    found = friction("stribeck", small(speed=[5.0, 10.0]), velocity=5.0, exponent=2.0, shift=0.0)
    assert found == pytest.approx(np.array([[np.exp(-1)], [np.exp(-4)]]))


def test_stribeck_velocity_grows_by_the_shift_from_40_degrees_on():
    """At 0.02 1/°C and 90 °C it is e times as great; at 40 °C it is what it is called."""
    table = small(speed=[5.0, 5.0 * np.e, 5.0], temperature=[40.0, 90.0, 90.0])
    found = friction("stribeck", table, velocity=5.0, exponent=1.0, shift=0.02)
    assert found == pytest.approx(np.array([[np.exp(-1)], [np.exp(-1)], [np.exp(-np.exp(-1))]]))


def test_velocity_exponent_is_zero_at_the_geometric_mean_speed():
    """Mean of 4, 16, 64 is 16; at exponent 1: 0.5 * 8 * (2 - 1) and 0.5 * 2 * (1/2 - 1)."""
    table = small(speed=[4.0, 16.0, 64.0], viscous=0.5)
    found = friction("velocity_exponent", table, exponent=1.0)
    assert found == pytest.approx(np.array([[-0.5], [0.0], [4.0]]))


@pytest.mark.parametrize("exponent", [0.3, 0.5, 0.72, 1.0])
def test_all_of_the_viscous_friction_can_follow_the_exponent(exponent):
    """3 sqrt(v) with the whole column is c v^p, with c such that both agree at the mean speed."""
    speed = np.array([4.0, 16.0, 64.0])
    column = friction("velocity_exponent", small(speed=speed, viscous=3.0), exponent=exponent)
    law = 3.0 * 16.0 ** (0.5 - exponent) * speed**exponent
    np.testing.assert_allclose(3.0 * np.sqrt(speed) + np.ravel(column), law, rtol=1e-12)


def test_velocity_exponent_counts_pairs_and_not_angle_bins():
    """Two bins at 4 deg/s and one at 16 deg/s: the mean stays at 8 deg/s."""
    table = small(speed=[4.0, 4.0, 16.0], pair=[0, 0, 1])
    found = friction("velocity_exponent", table, exponent=1.0)
    root = np.sqrt(2)
    assert found == pytest.approx(np.array([[2 * (1 / root - 1)]] * 2 + [[4 * (root - 1)]]))


def test_linear_viscous_is_the_speed():
    assert friction("linear_viscous", small(speed=[2.0, 290.0])) == [[2.0], [290.0]]


def test_quadratic_drag_is_one_at_100_deg_per_s():
    assert friction("quadratic_drag", small(speed=[100.0, 300.0])) == [[1.0], [9.0]]


def test_coulomb_temperature_counts_tens_of_degrees_from_25():
    found = friction("coulomb_temperature", small(temperature=[20.0, 65.0]))
    assert found == [[-0.5], [4.0]]


def test_load_linear_does_not_know_the_sign_of_the_load():
    assert friction("load_linear", small(load=[-30.0, 20.0])) == [[30.0], [20.0]]


def test_load_velocity_by_hand():
    """(20/10)^2 sqrt(25/100) = 2."""
    assert friction("load_velocity", small(load=-20.0, speed=[25.0])) == [[2.0]]


def test_load_temperature_by_hand():
    """(20/10)^2 (45 - 25)/10 = 8."""
    table = small(load=-20.0, temperature=[45.0])
    assert friction("load_temperature", table, bend=0.0) == [[8.0]]
    assert friction("load_temperature", table, bend=1e-8)[0][0] == pytest.approx(8.0)


@pytest.mark.parametrize("bend", [-0.04, 0.02, 0.08])
def test_load_temperature_fades_by_its_bend(bend):
    """The change per degree, 0.4 at load 20 and 25 °C, falls by exp(-bend) with each degree."""
    warm = np.linspace(25.0, 65.0, 4001)
    table = small(load=20.0, temperature=warm)
    rate = 0.4 * np.exp(-bend * (warm - 25.0))
    summed = np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * 0.01)])
    found = np.ravel(friction("load_temperature", table, bend=bend))
    np.testing.assert_allclose(found, summed, atol=1e-6)


def warmed(**columns):
    """Return a table whose base model is given the motor temperature."""
    return small(measured_temperature=columns["motor_temperature"], **columns)


def test_thermal_lag_follows_a_step():
    """After a step of 10 °C the gear lags by 10 exp(-t/theta); friction changes by -2 per °C."""
    table = warmed(
        time=[0.0, 0.0, 600.0, 1200.0],
        motor_temperature=[20.0, 30.0, 30.0, 30.0],
        temperature_slope=-2.0,
    )
    found = np.array(friction("thermal_lag", table, time_constant=600.0))
    expected = [0.0, 20.0, 20.0 * np.exp(-1), 20.0 * np.exp(-2)]
    np.testing.assert_allclose(found[:, 0], expected, rtol=1e-12)


def test_thermal_lag_behind_a_ramp_settles_at_rate_times_time_constant():
    """0.01 °C/s for 20 time constants of 300 s: the gear is 3 °C behind."""
    time = np.arange(0.0, 6001.0, 60.0)
    table = warmed(time=time, motor_temperature=20.0 + 0.01 * time, temperature_slope=-1.0)
    found = np.array(friction("thermal_lag", table, time_constant=300.0))
    assert found[-1, 0] == pytest.approx(3.0, rel=1e-6)


def test_friction_heats_the_gear_while_the_motor_warms_and_not_while_it_cools():
    """Half the reference power while the motor warms, which ends after 3600 s."""
    time = np.arange(0.0, 9001.0, 60.0)
    motor = 60.0 - np.abs(time - 3600.0) / 100.0
    table = warmed(
        time=time,
        motor_temperature=motor,
        temperature_slope=-1.0,
        friction_power=0.5,
        moved=np.where(time <= 3600.0, 60.0, 0.0),
    )
    heat = -np.array(friction("thermal_lag", table, time_constant=600.0))[:, 1]
    warming = time <= 3600.0
    np.testing.assert_allclose(heat[warming], 0.5 * -np.expm1(-time[warming] / 600.0), rtol=1e-9)
    fall = heat[-1] / heat[np.searchsorted(time, 6000.0)]
    assert fall == pytest.approx(np.exp(-3000.0 / 600.0), rel=1e-9)


def test_recorded_moves_heat_the_gear_even_while_the_motor_cools():
    """750 deg there and back at 50 deg/s are half of each 60 s: a quarter of the power."""
    time = np.repeat(np.arange(0.0, 12_001.0, 60.0), 2)
    table = warmed(
        time=time,
        pair=np.arange(len(time)) // 2,
        position=np.tile([0.0, 750.0], len(time) // 2),
        motor_temperature=60.0 - time / 1000.0,
        temperature_slope=-1.0,
        friction_power=0.5,
        speed=50.0,
    )
    heat = -np.array(friction("thermal_lag", table, time_constant=300.0))[:, 1]
    assert heat[-1] == pytest.approx(0.25, rel=1e-6)


def test_moves_that_are_not_recorded_heat_as_the_fastest_recorded_ones():
    """Slow and fast moves by turns, of no recorded way: all heat is that of the fast ones."""
    time = np.arange(0.0, 12_001.0, 60.0)
    fast = np.arange(len(time)) % 2 == 1
    table = warmed(
        time=time,
        motor_temperature=20.0 + time / 1000.0,
        temperature_slope=-1.0,
        friction_power=np.where(fast, 0.8, 0.1),
        speed=np.where(fast, 100.0, 10.0),
        moved=60.0,
    )
    heat = -np.array(friction("thermal_lag", table, time_constant=300.0))[:, 1]
    assert heat[-1] == pytest.approx(0.8, rel=1e-6)


@pytest.mark.parametrize(("housing", "expected"), [(35.0, 10.0), (np.nan, 0.0)])
def test_housing_moves_the_temperature_of_friction_where_it_is_known(housing, expected):
    table = warmed(
        time=[0.0], motor_temperature=40.0, housing_temperature=housing, temperature_slope=-2.0
    )
    assert friction("thermal_lag", table, time_constant=600.0)[0][2:] == [expected, expected]


def test_a_gear_that_follows_the_housing_starts_as_warm_as_it():
    """The housing is 5 °C colder and rises by 10 °C at once: 5 °C above after, less what lags."""
    table = warmed(
        time=[0.0, 0.0, 600.0],
        motor_temperature=40.0,
        housing_temperature=[35.0, 45.0, 45.0],
        temperature_slope=-1.0,
    )
    found = np.array(friction("thermal_lag", table, time_constant=600.0))[:, 3]
    np.testing.assert_allclose(found, [5.0, 5.0, -5.0 + 10.0 * np.exp(-1)], rtol=1e-12)


def test_drift_counts_hours_over_all_runs():
    table = small(clock=[1800.0, 5400.0, 88_200.0], run=[0, 0, 1])
    steady = friction("drift", table, time_constant=1e6)
    np.testing.assert_allclose(steady, [[0.0], [1.0], [24.0]], rtol=1e-4)


def test_drift_slows_down_with_its_time_constant():
    """A rate that falls by exp(-t/th) sums to th (1 - 1/e) after th, here 24 h."""
    table = small(clock=[0.0, 60.0, 86_400.0, 1e9])
    found = np.ravel(friction("drift", table, time_constant=24.0))
    assert found == pytest.approx([0.0, 1 / 60, 24.0 * (1 - np.exp(-1)), 24.0], rel=1e-3)


def test_run_in_falls_with_the_way_of_all_days():
    """First day 0 and 20,000 deg, second day from 0 again, with 10,000 deg to run in."""
    table = small(travel=[0.0, 20_000.0, 0.0], run=[0, 0, 1])
    found = friction("run_in", table, distance=10_000.0)
    assert found == pytest.approx(np.array([[1.0], [np.exp(-2)], [np.exp(-2)]]))


def test_run_in_of_recordings_alone_falls_with_the_strokes_of_the_pairs():
    """Two pairs of 90 deg and one of 45 deg, there and back; a day between the last two."""
    table = small(
        pair=[0, 0, 1, 1, 2, 2],
        run=[0, 0, 0, 0, 1, 1],
        position=[0.0, 90.0, 0.0, 90.0, 0.0, 45.0],
        travel=[0.0, 0.0, 9e4, 9e4, 0.0, 0.0],
    )
    assert logged_travel(table).tolist() == [0.0, 0.0, 180.0, 180.0, 0.0, 0.0]
    found = np.ravel(OF_LOGGED.evaluate(table, {"distance": 180.0}).friction)
    # what a run covers counts up to its last pair
    assert found == pytest.approx(np.exp([0, 0, -1, -1, -1, -1]))


def test_rest_recovery_decays_with_every_pair_and_recovers_at_rest():
    """Of 0.3 at the start, each pair of the usual motion keeps a share of exp(-1/2)."""
    table = small(
        run=[0, 0, 0, 0, 1, 1],
        pair=[0, 1, 2, 3, 4, 5],
        travel=[0.0, 90.0, 180.0, 270.0, 0.0, 900.0],
        rest=[np.inf, np.inf, np.inf, 100.0, np.inf, 0.0],
        order=[0.0, 1.0, 2.0, 0.0, 0.0, 0.0],
    )
    found = friction("rest_recovery", table, pairs=2.0, rest_time=100.0, at_start=0.3)
    rested = 1 - (1 - 0.3 * np.exp(-1.5)) * np.exp(-1)
    after_ten_pairs = 0.3 * np.exp(-5)
    expected = [0.3, 0.3 * np.exp(-0.5), 0.3 * np.exp(-1), rested, 0.3, after_ten_pairs]
    assert [row[0] for row in found] == pytest.approx(expected)
    assert [row[1] for row in found] == [0.0] * 6


def test_rest_recovery_of_an_unknown_rest_goes_on_as_it_was():
    table = small(pair=[0, 1], travel=[0.0, 90.0], rest=[np.inf, np.nan], order=0.0)
    found = friction("rest_recovery", table, pairs=1.0, rest_time=100.0, at_start=1.0)
    assert [row[0] for row in found] == pytest.approx([1.0, np.exp(-1)])


@pytest.mark.parametrize("sign", [1, -1])
def test_rest_recovery_is_what_separation_makes_of_a_stiffer_first_move(sign):
    """The first move has 5 more friction after a long rest, the one back 3 more."""
    first, back = 20.0 + 5.0, 20.0 + 3.0
    torque_first, torque_back = 30.0 + sign * first, 30.0 - sign * back
    basis = BY_NAME["rest_recovery"].evaluate(
        small(travel=[0.0]), {"pairs": 3.0, "rest_time": 60.0, "at_start": 1.0}
    )
    coefficients = np.array([4.0, sign * 1.0])
    assert 20.0 + basis.friction @ coefficients == sign * (torque_first - torque_back) / 2
    assert 30.0 + basis.load @ coefficients == (torque_first + torque_back) / 2


def test_step_comes_after_its_share_of_the_pairs_whatever_the_gaps_between_days():
    """Of four pairs two are on each day: 0.5 is the night, 0.6 between the last two pairs."""
    table = small(
        clock=[0.0, 100.0, 86_400.0, 86_400.0, 86_500.0],
        run=[0, 0, 1, 1, 1],
        pair=[0, 1, 2, 2, 3],
    )
    steps = [np.ravel(friction("step_change", table, moment=m)).tolist() for m in (0.5, 0.6)]
    assert steps == [[0.0, 0.0, 1.0, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0, 1.0]]


def test_direction_asymmetry_is_an_offset_and_a_share_of_viscous_friction():
    table = small(speed=[4.0, 100.0], viscous=[3.0, 2.0])
    found = load("direction_asymmetry", table, exponent=0.5)
    power = np.sqrt([4.0 / 50.0, 100.0 / 50.0])
    expected = [[1.0, power[0], 6.0], [1.0, power[1], 20.0]]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("exponent", [0.2, 0.5, 1.0])
def test_direction_asymmetry_is_the_base_s_viscous_friction_at_50_deg_per_s(exponent):
    """2 sqrt(50) there, and four times the speed has 4^p times as much."""
    found = load("direction_asymmetry", small(speed=[50.0, 200.0], viscous=2.0), exponent=exponent)
    assert found[0] == pytest.approx([1.0, 1.0, 2.0 * np.sqrt(50.0)])
    assert np.divide(found[1], found[0]) == pytest.approx([1.0, 4.0**exponent, 4.0**exponent])


def test_torque_constant_scales_both_channels_by_the_same_percentage():
    """At 65 °C, 0.1 %/°C are 4 % of 50 and of -20."""
    basis = BY_NAME["torque_constant"].evaluate(
        small(motor_temperature=[65.0], friction=50.0, load=-20.0), {}
    )
    assert 0.1 * basis.friction[0, 0] == pytest.approx(0.04 * 50.0)
    assert 0.1 * basis.load[0, 0] == pytest.approx(0.04 * -20.0)


def test_torque_scale_is_the_same_share_of_both_channels_while_it_is_there():
    """3 % of 50 and of -20 in the second half of four pairs."""
    table = small(pair=np.arange(4), clock=np.arange(4) * 60.0, friction=50.0, load=-20.0)
    basis = BY_NAME["torque_scale"].evaluate(table, {"moment": 0.5, "end": 1.0})
    assert 3.0 * basis.friction[:, 0] == pytest.approx([0.0, 0.0, 1.5, 1.5])
    assert 3.0 * basis.load[:, 0] == pytest.approx([0.0, 0.0, -0.6, -0.6])


def test_position_offset_turns_gravity_while_it_is_there():
    """Gravity of 40 N·m times the cosine, 2 deg off at 30 deg, in the second half of four pairs."""
    slope = -40.0 * np.sin(np.radians(30.0)) * np.pi / 180.0
    table = small(pair=np.arange(4), clock=np.arange(4) * 60.0, load_gradient=slope, load_slope=0.1)
    basis = BY_NAME["position_offset"].evaluate(table, {"moment": 0.5, "end": 1.0})
    turned = 40.0 * (np.cos(np.radians(28.0)) - np.cos(np.radians(30.0)))
    assert 2.0 * basis.load[:, 0] == pytest.approx([0.0, 0.0, turned, turned], rel=0.05)
    assert basis.friction[:, 0] == pytest.approx(0.1 * basis.load[:, 0])
