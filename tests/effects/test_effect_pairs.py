"""Steps that effects share, against a general integrator and by hand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from frictioncli.effects.pair_series import (
    first_order_lag,
    first_order_response,
    measured_share,
    pair_heads,
    series_starts,
    stroke_ends,
    turning_points,
)
from tests.effects.tables import small


def integrated(time, derivative, start):
    """Return the state at each moment, integrated from knot to knot."""
    states = [start]
    for i in range(len(time) - 1):
        solution = solve_ivp(
            lambda t, y, i=i: derivative(t, y, i),
            (time[i], time[i + 1]),
            [states[-1]],
            rtol=1e-9,
            atol=1e-10,
        )
        states.append(solution.y[0, -1])
    return np.array(states)


@pytest.fixture
def knots():
    random = np.random.default_rng(11)
    time = np.cumsum(random.uniform(5.0, 400.0, 40))
    return time, 40.0 + np.cumsum(random.normal(0.0, 2.0, 40))


@pytest.mark.parametrize("time_constant", [120.0, 900.0, 14_400.0])
def test_lag_agrees_with_a_general_integrator(knots, time_constant):
    time, value = knots
    follower = integrated(
        time, lambda t, y, i: (np.interp(t, time, value) - y) / time_constant, value[0]
    )
    restart = np.arange(len(time)) == 0
    lag = first_order_lag(time=time, value=value, restart=restart, time_constant=time_constant)
    np.testing.assert_allclose(value + lag, follower, atol=1e-6)


@pytest.mark.parametrize("time_constant", [120.0, 900.0, 14_400.0])
def test_response_agrees_with_a_general_integrator(knots, time_constant):
    time, value = knots
    follower = integrated(time, lambda t, y, i: (value[i] - y) / time_constant, 0.0)
    restart = np.arange(len(time)) == 0
    found = first_order_response(
        time=time, level=value[:-1], restart=restart, time_constant=time_constant
    )
    np.testing.assert_allclose(found, follower, atol=1e-6)


def test_follower_forgets_at_a_restart_however_far_the_clock_jumps_back():
    time = np.array([0.0, 500_000.0, 0.0, 60.0])
    value = np.array([20.0, 60.0, 25.0, 26.0])
    restart = np.array([True, False, True, False])
    lag = first_order_lag(time=time, value=value, restart=restart, time_constant=120.0)
    assert lag[2] == 0.0
    assert lag[3] == pytest.approx(-(1 - np.exp(-0.5)) / 0.5)


def test_pairs_are_reduced_and_spread():
    table = small(run=[0, 0, 0, 1], pair=[3, 3, 5, 5], position=[1.0, 4.0, 2.0, 7.0])
    heads = pair_heads(table)
    assert heads.first.tolist() == [0, 2, 3]
    assert heads.mean(table.position).tolist() == [2.5, 2.0, 7.0]
    assert heads.minimum(table.position).tolist() == [1.0, 2.0, 7.0]
    assert heads.maximum(table.position).tolist() == [4.0, 2.0, 7.0]
    assert heads.spread(np.array([1.0, 2.0, 3.0])).tolist() == [1.0, 1.0, 2.0, 3.0]


def test_share_measured_before_goes_by_the_clock_of_all_runs():
    table = small(clock=[10.0, 20.0, 0.0, 5.0], run=[0, 0, 1, 1])
    assert measured_share(table).tolist() == [0.5, 0.75, 0.0, 0.25]


def test_changes_come_between_two_series():
    """Series of three pairs, two rows each: after 3, 6, ... of 18 pairs."""
    pair = np.repeat(np.arange(18), 2)
    table = small(clock=10.0 * pair, pair=pair, order=pair % 3.0)
    assert series_starts(table) == pytest.approx(np.arange(3, 18, 3) / 18)


def test_where_series_are_few_a_change_may_come_before_any_pair():
    pair = np.arange(8)
    table = small(clock=10.0 * pair, pair=pair, order=pair % 4.0)
    assert series_starts(table) == pytest.approx(np.arange(1, 8) / 8)


def test_of_a_few_hundred_series_each_is_tried():
    """A pair on the wrong side of a change hides it where pairs scatter little."""
    pair = np.arange(400)
    found = series_starts(small(clock=10.0 * pair, pair=pair, order=0.0 * pair))
    assert found == pytest.approx(np.arange(1, 400) / 400)


def test_of_many_series_some_are_left_out_evenly():
    """1,000 series: at most 480 moments, each as far from the next."""
    pair = np.arange(2000)
    found = series_starts(small(clock=10.0 * pair, pair=pair, order=pair % 2.0))
    assert 240 <= len(found) <= 480
    np.testing.assert_allclose(np.diff(found), found[1] - found[0])


def test_ends_are_those_of_the_own_pair():
    table = small(position=[0.0, 10.0, 50.0, 55.0], pair=[0, 0, 1, 1])
    low, high = stroke_ends(table, distance=5.0)
    assert low.tolist() == pytest.approx([1.0, np.exp(-2), 1.0, np.exp(-1)])
    assert high.tolist() == pytest.approx([np.exp(-2), 1.0, np.exp(-1), 1.0])


def turned(*strokes, run=0, distance=10.0):
    """Return low and high nearness of pairs of three angles each, shape (pairs, 3)."""
    position = np.array([[low, (low + high) / 2, high] for low, high in strokes]).ravel()
    pair = np.repeat(np.arange(len(strokes)), 3)
    table = small(
        position=position, pair=pair, run=np.repeat(np.broadcast_to(run, len(strokes)), 3)
    )
    return tuple(values.reshape(-1, 3) for values in turning_points(table, distance=distance))


def test_a_fast_move_turns_where_a_slow_one_does():
    """Both cut 10 deg off each end: the first bin is 10 deg from the turn at 0, and at 100."""
    low, high = turned((0.0, 100.0), (10.0, 90.0))
    assert low[0] == pytest.approx([1.0, np.exp(-5), np.exp(-10)])
    assert low[1] == pytest.approx([np.exp(-1), np.exp(-5), np.exp(-9)])
    assert high[1] == pytest.approx([np.exp(-9), np.exp(-5), np.exp(-1)])


def test_a_move_over_part_of_the_angles_turns_where_it_ends():
    """50 deg are lacking at one end only; 5 and 15 deg differ by as much as is too much."""
    low, high = turned((0.0, 100.0), (0.0, 50.0), (5.0, 85.0))
    for pair in (1, 2):
        assert low[pair, 0] == high[pair, 2] == 1.0
    assert high[1, 0] == pytest.approx(np.exp(-5))
    low, high = turned((0.0, 100.0), (5.0, 85.1))
    assert low[1, 0] == pytest.approx(np.exp(-0.5))
    assert high[1, 2] == pytest.approx(np.exp(-1.49))


def test_each_run_has_its_own_turns():
    low, high = turned((0.0, 100.0), (20.0, 80.0), (30.0, 70.0), run=[0, 1, 1])
    assert low[1, 0] == high[1, 2] == 1.0
    assert low[2, 0] == high[2, 2] == pytest.approx(np.exp(-1))


def test_what_is_made_of_a_table_once_is_that_of_the_table_alone():
    """A table with other columns starts anew, though it comes from the first one."""
    calls = []

    def fastest(table):
        calls.append(table)
        return float(table.speed.max())

    table = small(speed=[10.0, 30.0, 20.0])
    assert [table.once(fastest), table.once(fastest)] == [30.0, 30.0]
    assert len(calls) == 1
    slower = replace(table, speed=table.speed / 2)
    assert slower.once(fastest) == 15.0
    assert table.once(fastest) == 30.0
    assert len(calls) == 2
