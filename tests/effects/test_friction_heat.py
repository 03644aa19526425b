"""Friction heat between pairs, against a motion and a motor that are integrated step by step."""

import numpy as np
import pytest

from frictioncli.effects.friction_heat import friction_power
from frictioncli.effects.pair_series import pair_heads
from tests.effects.tables import moved_before, small

STROKE, ACCELERATION, PAUSE = 180.0, 400.0, 0.4
SPEEDS = (4.0, 200.0, 20.0, 100.0)
FRICTION = 40.0


def duration(speed):
    """Time of a move there and back, with ramps and a pause after each. [s]."""
    return 2 * (STROKE / speed + speed / ACCELERATION + PAUSE)


def experiment(rests):
    """Series of four moves; before each the joint warms at 180 deg/s, and stands so many seconds.

    Returns pairs with their motor temperatures, and the heat from each to the next [N·m·deg].
    """
    step, time, motor, made, heat = 0.5, 0.0, 20.0, 0.0, []
    times, temperatures = [], []
    mean_speed = 2 * STROKE / duration(180.0)

    def pass_time(seconds, speed):
        nonlocal time, motor, made
        for _ in range(round(seconds / step)):
            made += FRICTION * speed * step
            motor += step * (0.02 * speed / mean_speed - (motor - 20.0) / 4000.0)
            time += step

    for heating, rest in rests:
        pass_time(heating, mean_speed)
        pass_time(rest, 0.0)
        for speed in SPEEDS:
            half = duration(speed) / 2
            for part in range(2):
                pass_time(half, STROKE / half)
                if part == 0:
                    times.append(time)
                    temperatures.append(motor)
                    heat.append(made)
    return np.array(times), np.array(temperatures), np.diff(heat)


def found_heat(time, motor):
    """What the log tells: bins of the constant speed, motor temperature, friction."""
    count = len(time)
    speed = np.tile(SPEEDS, count // len(SPEEDS))
    cut = speed**2 / (2 * ACCELERATION)
    table = small(
        moved=np.repeat(moved_before(time, speed, STROKE - 2 * cut, motor), 2),
        time=np.repeat(time, 2),
        pair=np.repeat(np.arange(count), 2),
        position=np.column_stack([cut, STROKE - cut]).ravel(),
        speed=np.repeat(speed, 2),
        motor_temperature=np.repeat(motor, 2),
        friction_power=np.repeat(FRICTION * speed, 2),
    )
    return friction_power(table, pair_heads(table)) * np.diff(time)


CYCLE = [(300.0, 0.0)] * 8 + [(0.0, 900.0)] * 8


def test_heat_of_series_and_of_heating_is_that_of_the_motion():
    """Moves of 200 deg/s take twice as long as at constant speed; slow and fast ones alternate."""
    time, motor, heat = experiment(CYCLE)
    found = found_heat(time, motor)
    inside = np.arange(len(heat)) % len(SPEEDS) != len(SPEEDS) - 1
    np.testing.assert_allclose(found[inside].sum(), heat[inside].sum(), rtol=0.1)
    assert found.sum() == pytest.approx(heat.sum(), rel=0.2)


def test_a_pause_of_half_the_time_is_no_heat():
    """Every third heating is followed by a pause as long as itself."""
    rests = [(300.0, 300.0 if i % 3 == 2 else 0.0) for i in range(12)] + [(0.0, 900.0)] * 8
    time, motor, heat = experiment(rests)
    found = found_heat(time, motor)
    gaps = np.arange(len(SPEEDS) - 1, len(heat), len(SPEEDS))
    paused = gaps[1:10:3]  # after the last one the motor is not warmer than before
    assert found[paused].sum() == pytest.approx(heat[paused].sum(), rel=0.2)
    assert found.sum() == pytest.approx(heat.sum(), rel=0.2)


def test_a_joint_that_stands_is_not_heated_between_its_series():
    time, motor, heat = experiment(CYCLE)
    cooling = np.arange(8 * len(SPEEDS) + len(SPEEDS) - 1, len(heat), len(SPEEDS))
    found = found_heat(time, motor)
    np.testing.assert_allclose(found[cooling], heat[cooling], rtol=0.2)


def test_a_rest_is_no_heat_where_the_moves_before_and_after_it_warm_the_motor():
    """At the begin of a cold day the motor is warmer after a rest, since the series warm it."""
    time, motor, heat = experiment([(0.0, 240.0)] * 3)
    gaps = np.arange(len(SPEEDS) - 1, len(heat), len(SPEEDS))
    assert (np.diff(motor)[gaps] > 0).all()
    np.testing.assert_allclose(found_heat(time, motor)[gaps], heat[gaps], rtol=0.2)
