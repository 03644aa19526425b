"""Columns of effects that differ along the stroke, by hand from their equations."""

import numpy as np
import pytest

from frictioncli.effects import BY_NAME
from tests.effects.tables import friction, load, small


def test_payload_change_is_gravity_of_any_phase_from_the_moment_on():
    table = small(clock=[0.0, 1.0, 2.0], position=[0.0, 0.0, 90.0])
    found = load("payload_change", table, moment=0.3)
    assert found == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), abs=1e-12)


def test_payload_change_raises_friction_as_the_base_s_load_term_does():
    """alpha ((L + l)^2 - L^2) is 2 alpha L l, but for alpha l^2: here 0.0014 * 0.01."""
    angle = np.radians([0.0, 40.0, 90.0, 150.0])
    before = 60.0 * np.cos(angle)
    more = 0.1 * np.cos(angle - 0.5)
    table = small(
        clock=[1.0, 1.0, 1.0, 1.0],
        position=np.degrees(angle),
        load_slope=2 * 0.0014 * before,
    )
    change = friction("payload_change", table, moment=0.0) @ (
        0.1 * np.array([np.cos(0.5), np.sin(0.5)])
    )
    exact = 0.0014 * (np.square(before + more) - np.square(before))
    np.testing.assert_allclose(change, exact, atol=0.0014 * 0.01 + 1e-12)


def test_dress_pack_is_slack_at_its_rest_angle_from_the_middle():
    table = small(position=[0.0, 90.0, 180.0])
    quarter = np.pi / 2
    even = load("dress_pack", table, rest=0.0, stiffening=0.0)
    assert even == pytest.approx(np.array([[-quarter], [0.0], [quarter]]))
    moved = load("dress_pack", table, rest=90.0, stiffening=0.0)
    assert moved == pytest.approx(np.array([[-np.pi], [-quarter], [0.0]]))


def test_dress_pack_stiffens_on_both_sides_of_its_rest():
    """1 rad away it pulls 1 + 0.5, 2 rad away 2 + 0.5 * 8."""
    table = small(position=90.0 + np.degrees([-1.0, 0.0, 1.0, 2.0, -2.0]))
    found = load("dress_pack", table, rest=0.0, stiffening=0.5)
    assert np.ravel(found) == pytest.approx([-1.5, 0.0, 1.5, 6.0, -6.0])


def test_ripple_repeats_with_its_order():
    """Order 4 has a period of 90 deg, its second harmonic one of 45 deg."""
    found = friction("position_ripple", small(position=22.5 * np.arange(10)), order=4.0)
    period = [[0, 1, 0, 1], [1, 0, 0, -1], [0, -1, 0, 1], [-1, 0, 0, -1]]
    assert found == pytest.approx(np.array([*period, *period, *period[:2]], float), abs=1e-12)


def test_ripple_over_fewer_than_ten_angles_is_not_judged():
    """A sine, a cosine and those of twice the order go through four of six values, whatever."""
    assert np.any(friction("position_ripple", small(position=20.0 * np.arange(10)), order=4.0))
    found = friction("position_ripple", small(position=20.0 * np.arange(9)), order=4.0)
    np.testing.assert_array_equal(found, np.zeros((9, 4)))


def test_ripple_that_does_not_come_back_is_not_judged():
    """Order 4 over 112.5 deg is 1.25 periods; over 111 deg it is less."""
    assert np.any(friction("position_ripple", small(position=np.linspace(0, 112.5, 60)), order=4.0))
    short = friction("position_ripple", small(position=np.linspace(0, 111.0, 60)), order=4.0)
    np.testing.assert_array_equal(short, np.zeros((60, 4)))


def test_a_second_harmonic_finer_than_the_bins_is_its_mean_over_a_bin():
    """Bins of 30 deg sample at most 6 periods per turn: order 4, of its double the mean."""
    centres = 30.0 * np.arange(12)
    found = np.array(friction("position_ripple", small(position=centres), order=4.0))
    fine = centres[:, np.newaxis] + np.linspace(-15.0, 15.0, 3001)
    mean = np.trapezoid(np.cos(8 * np.radians(fine)), fine, axis=1) / 30.0
    np.testing.assert_allclose(found[:, 3], mean, atol=1e-5)
    np.testing.assert_allclose(found[:, 1], np.cos(4 * np.radians(centres)), atol=1e-12)


def move(position, start, stop, acceleration):
    """Return the acceleration at an angle of a move that speeds up and brakes over 10 deg."""
    forward = 1.0 if stop > start else -1.0
    if abs(position - start) < 10.0:
        return forward * acceleration[0]
    return -forward * acceleration[1] if abs(position - stop) < 10.0 else 0.0


@pytest.mark.parametrize("acceleration", [(3.0, 3.0), (5.0, 3.0)], ids=["equal", "unequal"])
def test_inertia_has_the_parity_of_two_counter_directed_moves(acceleration):
    """Sum and difference of simulated accelerations show where each column belongs."""
    position = np.array([5.0, 50.0, 95.0])
    there = np.array([move(q, 0.0, 100.0, acceleration) for q in position])
    back = np.array([move(q, 100.0, 0.0, acceleration) for q in position])
    table = small(position=position, pair=0, speed=200.0)
    basis = BY_NAME["inertia"].evaluate(table, {"distance": 2.0, "growth": 0.0})
    mean, half_difference = (there + back) / 2, (there - back) / 2
    np.testing.assert_allclose(basis.load[:, 0] / 4.0 * mean[0], mean, atol=1e-6)
    np.testing.assert_allclose(
        basis.friction[:, 1] / 4.0 * half_difference[0], half_difference, atol=1e-6
    )
    assert bool(half_difference.any()) == (acceleration[0] != acceleration[1])
    assert not basis.load[:, 1].any()
    assert not basis.friction[:, 0].any()


@pytest.mark.parametrize(("growth", "torque", "distance"), [(0.0, 4.0, 5.0), (1.0, 2.0, 10.0)])
def test_inertia_of_a_faster_move_is_greater_or_reaches_further(growth, torque, distance):
    """At 200 deg/s: four times at the same distance, or twice at twice the distance."""
    position = np.array([0.0, 10.0, 1000.0])
    shape = {"distance": 5.0, "growth": growth}
    basis = BY_NAME["inertia"].evaluate(small(position=position, pair=0, speed=200.0), shape)
    near = np.exp(-10.0 / distance)
    np.testing.assert_allclose(basis.load[:, 0], torque * np.array([1.0, near, -1.0]), atol=1e-12)
    np.testing.assert_allclose(
        basis.friction[:, 1], torque * np.array([1.0, near, 1.0]), atol=1e-12
    )


@pytest.mark.parametrize("growth", [0.0, 0.5, 1.0])
def test_inertia_is_stated_at_100_deg_per_s(growth):
    table = small(position=[0.0, 5.0, 1000.0], pair=0, speed=100.0)
    basis = BY_NAME["inertia"].evaluate(table, {"distance": 5.0, "growth": growth})
    np.testing.assert_allclose(basis.load[:, 0], [1.0, np.exp(-1), -1.0], atol=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_reversal_transient_is_what_separation_makes_of_a_build_up(sign):
    """Friction 20, of which 8 are lacking at the reversal; torque load plus or less friction."""
    position = np.array([0.0, 2.0, 5.0, 10.0])
    forward = 20.0 - 8.0 * np.exp(-position / 2.0)
    reverse = 20.0 - 8.0 * np.exp(-(10.0 - position) / 2.0)
    torque_forward, torque_reverse = 30.0 + sign * forward, 30.0 - sign * reverse
    basis = BY_NAME["reversal_transient"].evaluate(
        small(position=position, pair=0), {"distance": 2.0, "side": float(sign)}
    )
    coefficients = np.array([8.0])
    np.testing.assert_allclose(
        20.0 + basis.friction @ coefficients, sign * (torque_forward - torque_reverse) / 2
    )
    np.testing.assert_allclose(
        30.0 + basis.load @ coefficients, (torque_forward + torque_reverse) / 2
    )


def test_ripple_finer_than_the_bins_is_not_judged():
    """Bins of 20 deg sample at most 9 periods per turn; order 16 would look like order 2."""
    found = friction("position_ripple", small(position=[0.0, 20.0, 40.0]), order=16.0)
    np.testing.assert_array_equal(found, np.zeros((3, 4)))
