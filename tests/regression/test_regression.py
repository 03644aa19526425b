"""The equation of motion of joints whose parameters are known, and refusals."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

from frictioncli.errors import NotEnoughData
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.regression.determination import regress
from frictioncli.regression.motion_rows import motion_rows
from frictioncli.regression.preparation import RARE_STATE, prepare, with_wide_enough_filter
from frictioncli.regression.separation import torques_by_regression
from tests.moves import move_sequence
from tests.regression import programmes

TRUTH = {
    "inertia": programmes.INERTIA,
    "gravity_cos": programmes.GRAVITY[0],
    "gravity_sin": programmes.GRAVITY[1],
    "offset": programmes.OFFSET,
    "tau_c": 8.0,
    "alpha": 0.002,
    "beta": 2.0,
}


def regression(table, sign=None, payload=None):
    motions = with_wide_enough_filter(
        lambda width: motion_rows(table.to_batches(), step_time=width)
    )
    return regress(prepare(motions[1], payload), 1, sign)


def clean(seed=0, duration=120, **law):
    motion = programmes.sines(duration, np.random.default_rng(seed))
    return motion, programmes.torque(motion, **law)


def test_without_noise_all_parameters_are_exact():
    found = regression(programmes.samples(*clean())).estimate
    for name, value in TRUTH.items():
        assert found.parameters[name] == pytest.approx(value, rel=0.01, abs=0.02), name
    assert "delay" not in found.parameters or abs(found.parameters["delay"]) < 1e-4


@pytest.mark.parametrize("seed", range(5))
def test_noisy_parameters_lie_near_their_intervals(seed):
    found = regression(programmes.noisy_log(seed)).estimate
    for name, value in TRUTH.items():
        assert abs(found.parameters[name] - value) < 4.5 * found.deviation(name), name


@pytest.mark.long
def test_intervals_hold_the_truth_as_often_as_they_say():
    """100 logs, seven parameters and friction at three speeds."""
    held = {name: [] for name in (*TRUTH, "friction")}
    for seed in range(100):
        found = regression(programmes.noisy_log(1000 + seed))
        for name, value in TRUTH.items():
            low, high = found.estimate.interval(name)
            held[name].append(low <= value <= high)
        for speed, (_, low, high) in found.friction.items():
            held["friction"].append(low <= 8.0 + 2.0 * np.sqrt(speed) <= high)
    shares = {name: np.mean(values) for name, values in held.items()}
    # one share of 100 logs lies within 0.95 ± 0.065 with a probability of 99.7 %
    assert min(shares.values()) > 0.87, shares
    assert 0.92 <= np.mean(list(shares.values())) <= 0.98, shares


def test_a_delayed_torque_is_found():
    """The torque of a moment is logged 12 ms later."""
    motion, torque = clean()
    late = np.interp(motion[0] - 0.012, motion[0], torque)
    found = regression(programmes.samples(motion, late)).estimate
    assert found.delay == pytest.approx(0.012, abs=0.001)
    for name in ("inertia", "tau_c", "beta"):
        assert found.parameters[name] == pytest.approx(TRUTH[name], rel=0.02), name


@pytest.mark.parametrize("counted", ["as the paper", "against the motion"])
def test_the_sign_of_a_log_is_found(counted):
    if counted == "as the paper":
        motion, torque = clean(sign=-1)
    else:
        motion, torque = clean()
        torque = -torque
    found = regression(programmes.samples(motion, torque))
    assert found.sign == -1
    speed, (friction, low, high) = list(found.friction.items())[1]
    assert friction == pytest.approx(8 + 2 * np.sqrt(speed), rel=0.01)
    assert low <= friction <= high


def test_friction_that_falls_with_temperature():
    generator = np.random.default_rng(5)
    motion = programmes.sines(900, generator, period=0.02)
    temperature = 25 + 35 * np.sin(np.pi * motion[0] / 900) ** 2
    law = {"beta": 1.0, "gamma": 6.0, "delta": 0.05}
    torque = programmes.torque(motion, temperature=temperature, **law)
    torque += programmes.autoregressive(generator, len(torque), 0.3, 0.5)
    table = programmes.samples(motion, torque, motor_temperature=temperature)
    found = regression(table).estimate
    for name, value in law.items():
        assert abs(found.parameters[name] - value) < 4 * found.deviation(name), name
        assert found.deviation(name) < 0.15 * value, name
    # and so does the fit of the cells
    rows = torques_by_regression(table.to_batches).table
    model = fit_joint(rows, {}, FitSettings())
    for name, value in (law | {"tau_c": 8.0, "alpha": 0.002}).items():
        low, high = model.parameters[name].ci95
        margin = 0.5 * (high - low)
        assert low - margin <= value <= high + margin, name


def test_motion_in_one_direction_gives_friction_with_the_offset_in_it():
    """A joint that turns on and on: what is constant cannot be told from Coulomb friction."""
    generator = np.random.default_rng(6)
    time = np.arange(0, 120, 0.01)
    rate = 2 * np.pi * np.array([0.07, 0.21])
    velocity = 80 + np.cos(rate * time[:, np.newaxis]) @ np.array([40.0, 25.0])
    position = 80 * time + np.sin(rate * time[:, np.newaxis]) @ (np.array([40.0, 25.0]) / rate)
    acceleration = -np.sin(rate * time[:, np.newaxis]) @ (np.array([40.0, 25.0]) * rate)
    motion = time, position, velocity, acceleration
    torque = programmes.torque(motion, alpha=0.0)
    torque += programmes.autoregressive(generator, len(time), 0.3, 0.0)
    found = regression(programmes.samples(motion, torque))
    assert "one direction" in found.undetermined["offset"]
    assert found.estimate.parameters["tau_c"] == pytest.approx(8.0 + programmes.OFFSET, abs=0.5)
    assert found.estimate.parameters["inertia"] == pytest.approx(programmes.INERTIA, rel=0.05)


def test_each_payload_has_its_gravity():
    parts, last = [], 0.0
    for number, mass in enumerate((0.0, 5.0)):
        motion = programmes.sines(120, np.random.default_rng(number))
        gravity = (55.0 + 4 * mass, -12.0)
        torque = programmes.torque(motion, gravity=gravity, inertia=4.0 + 0.2 * mass)
        shifted = (motion[0] + last, *motion[1:])
        table = programmes.samples(shifted, torque).to_pandas()
        parts.append(table.assign(recording=f"log{number}"))
        last = shifted[0][-1] + 1.0
    table = programmes.samples((np.empty(0),) * 4, np.empty(0)).from_pandas(
        pd.concat(parts, ignore_index=True), preserve_index=False
    )
    keys = pd.MultiIndex.from_tuples([("day1", "log0"), ("day1", "log1")])
    found = regression(table, payload=pd.Series([0.0, 5.0], keys)).estimate
    assert found.parameters["gravity_cos"] == pytest.approx(55.0, rel=0.01)
    assert found.parameters["gravity_cos_2"] == pytest.approx(75.0, rel=0.01)
    assert found.parameters["inertia_2"] == pytest.approx(5.0, rel=0.02)


def in_two_states(masses=(0.0, 5.0), seconds=120, **columns):
    """A log whose gravity goes with a mass from one stretch of time to the next."""
    parts, last = [], 0.0
    for number, mass in enumerate(masses):
        motion = programmes.sines(seconds, np.random.default_rng(number))
        torque = programmes.torque(motion, gravity=(55.0 + 4 * mass, -12.0), alpha=0.0)
        shifted = (motion[0] + last, *motion[1:])
        table = programmes.samples(shifted, torque).to_pandas()
        own = {name: values[number] for name, values in columns.items()}
        parts.append(table.assign(**own))
        last = shifted[0][-1] + 0.1
    return pa.Table.from_pandas(pd.concat(parts, ignore_index=True), preserve_index=False)


@pytest.mark.parametrize("column", ["pose", "payload"])
def test_each_pose_and_each_payload_of_a_motion_has_its_gravity(column):
    table = in_two_states(**{column: (0.0, 5.0)})
    found = regression(table).estimate
    assert found.parameters["gravity_cos"] == pytest.approx(55.0, rel=0.01)
    assert found.parameters["gravity_cos_2"] == pytest.approx(75.0, rel=0.01)
    assert found.parameters["tau_c"] == pytest.approx(8.0, rel=0.03)
    rows = torques_by_regression(table.to_batches).table
    assert set(rows[column]) == {0.0, 5.0}
    assert rows.groupby("pair")[column].nunique().max() == 1


def test_a_pose_of_little_motion_is_left_out_and_one_in_each_move_is_not_told_apart():
    table = in_two_states((0.0, 0.0), 60, pose=(0.0, 1.0))
    prepared = prepare(motion_rows(table.to_batches())[1])
    assert RARE_STATE not in prepared.dropped
    assert prepared.terms.poses == (0.0, 1.0)
    frame = table.to_pandas()
    rare = frame.assign(pose=np.where(frame.index > 0.99 * len(frame), 2.0, 0.0))
    prepared = prepare(motion_rows(pa.Table.from_pandas(rare).to_batches())[1])
    assert prepared.dropped[RARE_STATE] > 0
    assert prepared.terms.poses == (0.0,)
    always = frame.assign(pose=(frame["time"] // 1.5).astype(float))
    prepared = prepare(motion_rows(pa.Table.from_pandas(always).to_batches())[1])
    assert RARE_STATE not in prepared.dropped
    assert np.isnan(prepared.terms.poses).all()
    assert any("stand elsewhere in nearly every move" in note for note in prepared.notes)


def test_a_measured_load_takes_the_place_of_gravity():
    """A current of 0.2 A/(N·m), beside a load that no cosine describes."""
    motion, _ = clean()
    position, velocity, acceleration = motion[1:]
    load = 20 + 0.004 * position**2
    friction = np.sign(velocity) * (1.0 + 0.3 * np.sqrt(np.abs(velocity)))
    current = 0.2 * load + friction + 0.5 * np.radians(acceleration)
    table = programmes.samples(motion, current, load=load)
    found = regression(table).estimate
    assert found.parameters["load"] == pytest.approx(0.2, rel=0.02)
    assert found.parameters["tau_c"] == pytest.approx(1.0, rel=0.03)
    rows = torques_by_regression(table.to_batches).table
    np.testing.assert_allclose(rows["load_torque"], 20 + 0.004 * rows["position"] ** 2, atol=2.5)


@pytest.mark.parametrize("share", [0.0, 0.01, -0.01])
def test_a_torque_behind_the_gear_is_refused(share):
    motion, _ = clean()
    position, velocity, acceleration = motion[1:]
    noise = programmes.autoregressive(np.random.default_rng(8), len(position), 0.5, 0.0)
    torque = 80 * np.cos(np.radians(position)) + 4 * np.radians(acceleration) + noise
    torque += share * np.sign(velocity) * 80
    with pytest.raises(NotEnoughData, match="holds no friction to speak of"):
        regression(programmes.samples(motion, torque))


def test_a_sign_told_against_the_data_is_refused():
    with pytest.raises(NotEnoughData, match="holds no friction"):
        regression(programmes.samples(*clean()), sign=-1)


def test_a_few_seconds_are_refused():
    with pytest.raises(NotEnoughData, match="expected at least 100; log longer moves"):
        regression(programmes.samples(*clean(duration=4)))


def test_a_torque_of_other_things_is_refused():
    """Hours of process force, a hundred times friction."""
    motion, torque = clean(alpha=0.0)
    force = programmes.autoregressive(np.random.default_rng(9), len(torque), 900.0, 0.999)
    with pytest.raises(NotEnoughData):
        regression(programmes.samples(motion, torque + force))


def test_a_velocity_that_contradicts_the_position_is_taken_and_said():
    motion, _ = clean()
    scaled = (motion[0], 1.66 * motion[1], *motion[2:])
    torque = programmes.torque(motion, gravity=(0.0, 0.0), alpha=0.0)
    found = regression(programmes.samples(scaled, torque))
    assert "contradict each other" in found.prepared.notes[0]
    assert not found.equations.speed_from_position


def test_one_speed_does_not_tell_viscous_friction_even_where_temperature_does_not_either():
    """Moves there and back at one speed while the joint warms a little: one constant is left."""
    motion = move_sequence(np.tile([-50, 50], 30), np.full(59, 40.0), period=0.01)
    parts = tuple(motion[name].to_numpy() for name in motion)
    # without what the ramps hold, the speeds are those of the plateau
    generator = np.random.default_rng(31)
    table = programmes.samples(
        parts,
        programmes.torque(parts, alpha=0.0) + generator.normal(0, 0.5, len(parts[0])),
        motor_temperature=np.linspace(25, 38, len(parts[0])),
    )
    found = regression(table)
    assert {"beta", "gamma", "delta"} <= set(found.undetermined)
    assert found.estimate.terms.friction == ("tau_c",)
    assert found.estimate.parameters["tau_c"] == pytest.approx(8 + 2 * np.sqrt(40.0), rel=0.01)


@pytest.mark.parametrize(("speeds", "count"), [((19.1,), 1), ((19.1, 60.0), 2)])
def test_friction_at_one_speed_is_told_once(speeds, count):
    """There and back at 19.1 deg/s, with the noise of a logged velocity, and at others."""
    turns = np.resize([0.0, 90.0], 25)
    motion = move_sequence(turns, np.repeat(np.resize(speeds, 12), 2), period=0.01)
    motion["velocity"] += np.random.default_rng(7).normal(0, 0.02, len(motion))
    columns = tuple(motion[name].to_numpy() for name in motion)
    found = regression(programmes.samples(columns, programmes.torque(columns, alpha=0.0)))
    assert len(found.friction) == count
    assert len({f"{speed:.3g}" for speed in found.friction}) == count
    middle = min(found.friction, key=lambda speed: abs(speed - 19.1))
    assert found.friction[middle][0] == pytest.approx(8.0 + 2.0 * np.sqrt(19.1), rel=0.02)
