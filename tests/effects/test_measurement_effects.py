"""Columns of measurement effects against torque that was shifted, filtered or misplaced."""

import numpy as np
import pytest
from scipy.signal import lfilter

from frictioncli.effects import BY_NAME
from frictioncli.effects.sensor_lag import basis as sensor_lag
from tests.effects.tables import moved_before, small

GRAVITY, OFFSET, ALPHA, COULOMB = 60.0, 4.0, 0.001, 10.0
RADIANS = np.pi / 180
SPEEDS = np.array([17.0, 50.0, 101.0, 290.0])
ANGLES = np.arange(20.0, 161.0, 5.0)


def load_at(angle):
    return GRAVITY * np.cos(RADIANS * angle) + OFFSET


def friction_at(load):
    return COULOMB + ALPHA * load**2


def torque_at(angle, direction):
    load = load_at(angle)
    return load + direction * friction_at(load)


def table():
    position = np.tile(ANGLES, len(SPEEDS))
    load = load_at(position)
    return small(
        speed=np.repeat(SPEEDS, len(ANGLES)),
        position=position,
        load=load,
        load_gradient=-RADIANS * GRAVITY * np.sin(RADIANS * position),
        load_curvature=-(RADIANS**2) * GRAVITY * np.cos(RADIANS * position),
        load_slope=2 * ALPHA * load,
    )


def channels(forward, reverse, rows):
    """Return what separation makes of two torques beyond the true friction and load."""
    return (
        (forward - reverse) / 2 - friction_at(rows.load),
        (forward + reverse) / 2 - rows.load,
    )


def predicted(name, rows, *coefficients):
    basis = BY_NAME[name].evaluate(rows, {})
    return tuple(channel @ np.array(coefficients) for channel in basis)


def filtered_at(angle, speed, direction, time_constant):
    """Return the torque behind a filter of first order, by running through samples of 0.1 ms."""
    step = 1e-4
    share, decay = step / (2 * time_constant + step), (2 * time_constant - step)
    decay /= 2 * time_constant + step
    reach = 15 * time_constant * speed
    way = np.arange(-reach, step * speed / 2, step * speed)
    true = torque_at(angle + direction * way, direction)
    return lfilter([share, share], [1, -decay], true, zi=[true[0] * (1 - share)])[0][-1]


def test_a_late_torque_is_the_column_times_the_delay():
    rows, delay = table(), 0.004
    shift = rows.speed * delay
    found = channels(
        torque_at(rows.position - shift, 1), torque_at(rows.position + shift, -1), rows
    )
    for measured, expected in zip(found, predicted("torque_delay", rows, delay), strict=True):
        # second order: half the squared shift in radians of 60 N·m
        assert np.abs(measured - expected).max() < 0.5 * (290 * delay * RADIANS) ** 2 * 75
    assert np.abs(found[0]).max() > 1.0


@pytest.mark.parametrize("time_constant", [0.012, 0.03, 0.04])
def test_a_filtered_torque_is_delay_and_filter_together(time_constant):
    rows = table()
    torques = [
        np.array(
            [
                filtered_at(angle, speed, direction, time_constant)
                for angle, speed in zip(rows.position, rows.speed, strict=True)
            ]
        )
        for direction in (1, -1)
    ]
    friction, _ = channels(*torques, rows)
    load = np.mean(torques, axis=0) - rows.load
    delay = predicted("torque_delay", rows, time_constant)
    more = predicted("torque_filter", rows, time_constant**2)
    angle = RADIANS * 290 * time_constant
    # beside gravity's 60 N·m friction has 1.8 N·m of the double angle, without its third order
    most = 60 * angle**5 + 1.8 * (2 * angle) ** 3
    # the third moment is that of 30 ms
    most += 60 * angle**3 * abs(1 - 0.03 / time_constant)
    assert np.abs(friction - delay[0] - more[0]).max() < most
    assert np.abs(load - delay[1] - more[1]).max() < 60 * angle**4 + 15 * angle**3
    assert np.abs(load - delay[1]).max() > 50 * angle**2


def test_play_moves_gravity_by_half_of_it_in_each_direction():
    rows, play = table(), 0.4
    found = channels(
        torque_at(rows.position - play / 2, 1), torque_at(rows.position + play / 2, -1), rows
    )
    for measured, expected in zip(found, predicted("backlash", rows, play), strict=True):
        assert np.abs(measured - expected).max() < 1e-3
    assert np.ptp(found[0][rows.position == 90.0]) == 0.0


def test_a_constant_that_is_not_carried_moves_the_least_of_friction():
    rows = table()
    true = COULOMB + ALPHA * (rows.load - OFFSET) ** 2
    change, load = predicted("load_offset", rows, OFFSET)
    constant = true - friction_at(rows.load) - change
    assert np.ptp(constant) < 1e-12
    assert constant[0] == pytest.approx(ALPHA * OFFSET**2)
    assert not load.any()


def test_a_late_sensor_shows_the_slope_of_a_steady_warming():
    """Warming by 0.01 °C/s in one run, cooling by half of it in the next, a pause in both."""
    time = np.concatenate([np.arange(0, 3000, 37.0), np.arange(7200, 9000, 61.0)])
    rows = small(
        run=np.repeat([0, 1], len(time)),
        pair=np.arange(2 * len(time)),
        time=np.tile(time, 2),
        temperature=np.concatenate([25 + 0.01 * time, 70 - 0.005 * time]),
        temperature_slope=-0.5,
    )
    column = sensor_lag(rows).friction[:, 0]
    assert column[: len(time)] == pytest.approx(-0.005, rel=0.02)
    assert column[len(time) :] == pytest.approx(0.0025, rel=0.02)


def test_warming_in_a_pause_is_no_slope_of_the_pairs_before_and_after_it():
    """In a pause of ten minutes the joint warms by 12 °C, which the pairs beside it do not show."""
    series = np.arange(0.0, 400.0, 20.0)
    time = np.concatenate([series, series + 980.0])
    temperature = np.concatenate([25.0 + 0.001 * series, 37.0 + 0.01 * series])
    order = np.tile(np.arange(len(series)), 2)
    rows = small(time=time, temperature=temperature, temperature_slope=-2.0, order=order)
    column = sensor_lag(rows).friction[:, 0]
    assert column[: len(series)] == pytest.approx(-0.002, abs=0.001)
    assert column[len(series) :] == pytest.approx(-0.02, abs=0.001)


def test_a_single_pair_has_no_slope_of_temperature():
    rows = small(run=[0, 1, 1], time=[0.0, 0.0, 60.0], temperature=[30.0, 30.0, 36.0])
    alone, *two = sensor_lag(rows).friction[:, 0]
    assert alone == 0.0
    assert np.mean(two) == pytest.approx(0.1, rel=0.1)


def heated(lag, noise, random):
    """Return series of slow and fast pairs with readings, and by how much these are too low.

    Losses grow with the temperature, and the heat of moves with the speed. In each pause the joint
    is heated, more or less, and rests. The first-order response of the sensor to a heat that is
    constant for half a second is exact.
    """
    speeds, step = np.array([20.0, 150.0, 40.0, 100.0, 8.0]), 0.5
    power, middles, orders, heat = [], [], [], []
    for _ in range(24):
        heat += [0.03 * random.random()] * 300 + [0.0] * int(random.integers(20, 200))
        for order, speed in enumerate(speeds):
            steps = round(200.0 / speed / step)
            middles.append(len(heat) + steps // 2)
            heat += [2e-4 * speed] * steps
            power.append(speed / 100.0)
            orders.append(order)
    true = lfilter([step], [1.0, step / 900.0 - 1.0], heat)
    kept = np.exp(-step / lag)
    behind = lfilter([1.0, -1.0], [1.0, -kept], true) * lag * (1 - kept) / step
    at = np.array(middles)
    reading = 25.0 + (true - behind)[at] + noise * random.standard_normal(len(at))
    per_pair = {
        "time": at * step,
        "speed": np.tile(speeds, 24),
        "friction_power": np.array(power),
        "order": np.array(orders, float),
        "temperature": reading,
        "motor_temperature": reading,
        "moved": moved_before(at * step, np.tile(speeds, 24), 100.0, reading),
    }
    rows = {name: np.repeat(values, 2) for name, values in per_pair.items()}
    pair, position = np.repeat(np.arange(len(at)), 2), np.tile([20.0, 120.0], len(at))
    return small(**rows, pair=pair, position=position, temperature_slope=-1.0), -behind[at]


@pytest.mark.parametrize("lag", [60.0, 90.0, 120.0])
def test_a_late_sensor_shows_how_its_reading_rises_in_slow_and_in_fast_moves(lag):
    """A line through the readings of four minutes is off by 10 to 15 %."""
    rows, too_high = heated(lag, 0.003, np.random.default_rng(0))
    column = sensor_lag(rows).friction[::2, 0]
    assert column @ too_high / (column @ column) == pytest.approx(lag, rel=0.05)
    error = np.linalg.norm(column - too_high / lag)
    assert error < 0.09 * np.linalg.norm(too_high / lag)
