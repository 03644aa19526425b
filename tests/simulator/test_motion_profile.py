"""Moves of the simulated joint: duration by hand, the servo's equation solved numerically."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, solve_ivp

from frictioncli.simulator.motion_profile import Servo, follow, move_duration, round_trips

SERVO = Servo(acceleration=400.0, frequency=6.0, damping=0.45)


def test_duration_of_a_trapezoid():
    # 0.25 s up and down at 100 deg/s cover 25 deg; 155 deg remain.
    assert move_duration(SERVO, distance=180.0, speed=100.0) == pytest.approx(0.5 + 1.55)


def test_duration_of_a_triangle():
    # 16 deg at 400 deg/s²: 8 deg up, 8 deg down, sqrt(2*8/400) s each.
    assert move_duration(SERVO, distance=16.0, speed=100.0) == pytest.approx(2.0 * 0.2)


@pytest.mark.parametrize(("distance", "speed"), [(180.0, 67.5), (-180.0, 101.2), (10.0, 90.0)])
def test_position_integrates_velocity_and_velocity_acceleration(distance, speed):
    time = np.linspace(0.0, 5.0, 50_001)
    motion = follow(SERVO, time=time, start=30.0, distance=distance, speed=speed)
    position = 30.0 + cumulative_trapezoid(motion.velocity, time, initial=0.0)
    velocity = cumulative_trapezoid(motion.acceleration, time, initial=0.0)
    assert motion.position == pytest.approx(position, abs=1e-4)
    assert motion.velocity == pytest.approx(velocity, abs=1e-2)
    assert motion.position[-1] == pytest.approx(30.0 + distance, abs=1e-6)


def test_motion_solves_the_servo_equation():
    omega = 2.0 * np.pi * SERVO.frequency

    def command(t):
        return 400.0 * t if t < 0.2 else min(80.0, 400.0 * (1.2 - t)) if t < 1.2 else 0.0

    def slope(t, state):
        _, velocity, acceleration = state
        jerk = omega**2 * (command(t) - velocity) - 2.0 * SERVO.damping * omega * acceleration
        return [velocity, acceleration, jerk]

    # 80 deg/s with ramps of 0.2 s and 1.2 s in all: 80 deg.
    time = np.linspace(0.0, 2.0, 201)
    solved = solve_ivp(slope, (0.0, 2.0), [0.0, 0.0, 0.0], t_eval=time, rtol=1e-8, max_step=0.005)
    motion = follow(SERVO, time=time, start=0.0, distance=80.0, speed=80.0)
    assert motion.position == pytest.approx(solved.y[0], abs=1e-3)
    assert motion.velocity == pytest.approx(solved.y[1], abs=0.05)
    assert motion.acceleration == pytest.approx(solved.y[2], abs=2.0)


def test_speed_settles_with_an_overshoot_and_is_then_constant():
    time = np.arange(0.0, 2.0, 0.001)
    motion = follow(SERVO, time=time, start=0.0, distance=180.0, speed=67.5)
    assert motion.velocity.max() > 67.6
    middle = (time > 0.7) & (time < 1.5)
    assert motion.velocity[middle] == pytest.approx(67.5, abs=0.05)


def test_round_trips_return_and_rest():
    motion, time, trips = round_trips(
        SERVO, speeds=(50.0, 100.0), angles=(0.0, 90.0), lead=1.0, dwell=0.6, interval=0.012
    )
    assert np.diff(time) == pytest.approx(0.012)
    assert set(trips.tolist()) == {0, 1}
    assert motion.position[time < 1.0] == pytest.approx(0.0)
    assert motion.position[-1] == pytest.approx(0.0, abs=0.01)
    assert motion.position.max() == pytest.approx(90.0, abs=1.0)
    for trip, speed in ((0, 50.0), (1, 100.0)):
        constant = np.isclose(np.abs(motion.velocity[trips == trip]), speed, atol=0.5)
        # 90 deg there and back, less the ramps and their settling.
        assert constant.sum() * 0.012 * speed > 60.0
