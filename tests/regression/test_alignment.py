"""Torques that are logged later than the positions, with starts and stops of hundreds of deg/s²."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from scipy.signal import lfilter

from frictioncli.regression.even_samples import later
from frictioncli.regression.motion_rows import motion_rows
from frictioncli.regression.preparation import with_wide_enough_filter
from frictioncli.regression.separation import torques_by_regression
from tests.moves import move_sequence
from tests.regression import programmes

FINE = 0.001
"""Period of the simulation. [s]"""


def moves(seed, *, acceleration=400.0, count=60):
    """Trapezoids of speed between random angles on either side of zero."""
    generator = np.random.default_rng(seed)
    turns = generator.uniform(15, 85, count + 1) * np.resize([-1.0, 1.0], count + 1)
    speeds = generator.uniform(15, 100, count)
    motion = move_sequence(turns, speeds, period=FINE, acceleration=acceleration)
    return tuple(motion[name].to_numpy() for name in motion)


def sines(seed):
    return programmes.sines(120, np.random.default_rng(seed), period=FINE)


def late_log(motion, delay, time_constant=0.0, *, added=0.0, every=10, seed=0, joint=1):
    """Samples of every tenth millisecond, with a torque behind a delay and a first-order filter."""
    generator = np.random.default_rng(100 + seed)
    torque = programmes.torque(motion) + added
    torque = np.interp(motion[0] - delay, motion[0], torque)
    if time_constant:
        # the trapezoidal rule
        ratio = 2 * time_constant / FINE
        ahead, back = [1 / (ratio + 1)] * 2, [1.0, (1 - ratio) / (1 + ratio)]
        torque, _ = lfilter(ahead, back, torque, zi=[torque[0] * (1 - ahead[0])])
    time, position, velocity, acceleration = (column[::every] for column in motion)
    torque = torque[::every] + generator.normal(0, 0.3, len(time))
    velocity = velocity + generator.normal(0, 0.05, len(time))
    logged = time, np.round(position / 0.002) * 0.002, velocity, acceleration
    return programmes.samples(logged, torque, joint=np.full(len(time), joint, dtype=np.int16))


class Reads:
    """Batches of a table, and how often they were read."""

    def __init__(self, table):
        self.table, self.count = table, 0

    def __call__(self):
        self.count += 1
        return self.table.to_batches(max_chunksize=5000)


def parameters(table):
    return torques_by_regression(table.to_batches).facts[1]["parameters"]


@pytest.mark.parametrize("motion", [moves, sines])
@pytest.mark.parametrize(
    ("delay", "time_constant"),
    [(0.005, 0.0), (0.02, 0.0), (0.014, 0.006), (0.04, 0.0), (0.03, 0.01), (-0.01, 0.0)],
)
@pytest.mark.parametrize("seed", range(2))
def test_a_delay_is_found_and_the_inertia_with_it(motion, delay, time_constant, seed):
    found = parameters(late_log(motion(seed), delay, time_constant, seed=seed))
    low, high = found["delay"]["ci95"]
    assert low - 0.001 <= delay + time_constant <= high + 0.001
    assert found["delay"]["estimate"] == pytest.approx(delay + time_constant, abs=0.001)
    assert high - low < 0.003
    assert found["inertia"]["estimate"] == pytest.approx(programmes.INERTIA, rel=0.02)


@pytest.mark.parametrize("seed", range(3))
def test_a_delay_is_found_that_no_series_about_zero_tells(seed):
    """Ramps of a tenth of a second: 40 ms later, nothing is as it was."""
    found = parameters(late_log(moves(seed, acceleration=1000.0), 0.04, every=4, seed=seed))
    assert found["delay"]["estimate"] == pytest.approx(0.04, abs=0.001)
    assert found["inertia"]["estimate"] == pytest.approx(programmes.INERTIA, rel=0.02)


@pytest.mark.parametrize("delay", [0.0, 0.005])
def test_stribeck_friction_in_a_chirp_is_no_delay(delay):
    """A law of the root alone found 11 ms where there are none, and 15 where there are 5."""
    time = np.arange(0, 120, FINE)
    rate = np.log(20) / 60
    phase = 2 * np.pi * 0.05 * np.expm1(rate * (60 - np.abs(60 - time))) / rate
    position = 10 + 10 / (0.25 + 0.05 * np.exp(rate * (60 - np.abs(60 - time)))) * np.sin(phase)
    velocity = np.gradient(position, FINE)
    motion = time, position, velocity, np.gradient(velocity, FINE)
    low = np.sign(velocity) * 6 * np.exp(-np.abs(velocity) / 8)
    found = parameters(late_log(motion, delay, added=low))
    if delay:
        assert found["delay"]["estimate"] == pytest.approx(delay, abs=0.001)
    else:
        assert "delay" not in found
    assert found["inertia"]["estimate"] == pytest.approx(programmes.INERTIA, rel=0.005)


@pytest.mark.parametrize("seed", range(2))
def test_the_interval_of_the_inertia_allows_for_a_delay_that_is_not_told(seed):
    """With friction of 0.2 N·m·s/deg the torque of 8 ms before holds 1.6 mN·m·s²/deg less."""
    time = np.arange(0, 80, FINE)
    rate = 0.04 * 15 ** (time / 80)
    position = 8 + 35 * np.minimum(1, 0.2 / rate) * np.sin(2 * np.pi * np.cumsum(rate) * FINE)
    velocity = np.gradient(position, FINE)
    motion = time, position, velocity, np.gradient(velocity, FINE)
    found = parameters(late_log(motion, 0.008, added=0.2 * velocity, every=4, seed=seed))
    assert "delay" not in found
    low, high = found["inertia"]["ci95"]
    assert low < programmes.INERTIA < high
    assert found["inertia"]["estimate"] < 0.99 * programmes.INERTIA


def test_friction_by_the_size_of_the_load_is_no_delay():
    """The slope of gravity goes along this motion as the law does: 37 ms but for the rivals."""
    time, rate = np.arange(0, 120, FINE), 2 * np.pi * 0.07 * np.arange(1, 6)
    phase = rate * time[:, np.newaxis] + np.random.default_rng(1).uniform(0, 2 * np.pi, 5)
    size = 40.0 / np.arange(1, 6)
    position, velocity = 10 + np.sin(phase) @ size, np.cos(phase) @ (size * rate)
    motion = time, position, velocity, -np.sin(phase) @ (size * rate**2)
    angle = np.radians(position)
    load = programmes.GRAVITY[0] * np.cos(angle) + programmes.GRAVITY[1] * np.sin(angle)
    found = parameters(late_log(motion, 0.0, added=np.sign(velocity) * 0.3 * np.abs(load)))
    assert "delay" not in found


@pytest.mark.parametrize("motion", [moves, sines])
def test_samples_are_read_again_only_if_a_torque_is_late(motion):
    table = late_log(motion(1), 0.0)
    least, reads = Reads(table), Reads(table)
    with_wide_enough_filter(lambda width: motion_rows(least(), step_time=width))
    found = torques_by_regression(reads).facts[1]["parameters"]
    assert reads.count == least.count
    assert "delay" not in found
    assert found["inertia"]["estimate"] == pytest.approx(programmes.INERTIA, rel=0.01)
    reads = Reads(late_log(motion(1), 0.02))
    torques_by_regression(reads)
    assert least.count < reads.count <= least.count + 4


@pytest.mark.parametrize("delay", [0.02, 0.04])
def test_friction_and_load_are_as_near_the_truth_as_without_a_delay(delay):
    """Within 40 ms the joint moves by 4 deg, over which gravity changes by 3 N·m."""

    def errors(delay):
        rows = torques_by_regression(late_log(moves(3), delay).to_batches).table
        angle = np.radians(rows["position"])
        load = programmes.GRAVITY[0] * np.cos(angle) + programmes.GRAVITY[1] * np.sin(angle)
        load += programmes.OFFSET
        friction = programmes.friction(rows["speed"], load, 30.0)
        return [
            np.sqrt(np.mean(np.square(error)))
            for error in (rows["friction_torque"] - friction, rows["load_torque"] - load)
        ]

    assert np.less(errors(delay), 1.1 * np.array(errors(0.0))).all()


def test_each_joint_has_a_delay_of_its_own():
    late, prompt = late_log(moves(4), 0.02), late_log(moves(5), 0.0, joint=2)
    both = pd.concat([late.to_pandas(), prompt.to_pandas()])
    together = torques_by_regression(pa.Table.from_pandas(both).to_batches).facts
    assert together[1]["parameters"] == parameters(late)
    assert together[2] == torques_by_regression(prompt.to_batches).facts[2]


def test_a_torque_later_than_any_delay_has_none():
    """Its delay would be at the bound of what is searched."""
    found = parameters(late_log(sines(6), 0.3))
    assert "delay" not in found


def test_the_rows_do_not_depend_on_the_batches():
    table = late_log(moves(7), 0.023)
    whole, parts = (
        motion_rows(table.to_batches(max_chunksize=size), delays={1: 0.023})[1].rows()
        for size in (None, 701)
    )
    np.testing.assert_array_equal(whole.torque, parts.torque)


@pytest.mark.parametrize("delay", [0.023, -0.017])
def test_the_torque_of_a_row_is_that_of_its_own_moment(delay):
    motion = sines(8)
    logged = tuple(column[::10] for column in motion)
    wave = 50 * np.sin(2 * np.pi * 0.5 * (logged[0] - delay))
    table = programmes.samples(logged, wave)
    rows = motion_rows(table.to_batches(), delays={1: delay})[1].rows()
    prompt = programmes.samples(logged, 50 * np.sin(2 * np.pi * 0.5 * logged[0]))
    expected = motion_rows(prompt.to_batches())[1].rows()
    np.testing.assert_allclose(rows.torque, expected.torque, atol=2e-4)
    np.testing.assert_array_equal(rows.acceleration, expected.acceleration)
    assert motion_rows(table.to_batches(), delays={2: delay}) == {}


@pytest.mark.parametrize("shift", [-2.5, -1.0, 0.25, 3.0])
def test_a_cubic_is_shifted_exactly(shift):
    place = np.arange(12.0)
    found = later((place - 5) ** 3, shift)
    np.testing.assert_allclose(found[5:7], (place + shift - 5)[5:7] ** 3, atol=1e-12)
