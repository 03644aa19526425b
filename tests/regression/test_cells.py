"""Torques by speed, angle and time: what the table holds, and what it leaves out."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.regression.separation import torques_by_regression
from tests.regression import programmes


@pytest.fixture(scope="module")
def found():
    return torques_by_regression(programmes.noisy_log(11, duration=600).to_batches)


def test_friction_and_load_are_those_of_the_joint(found):
    """Whatever the regression's model: the joint's own friction and gravity in every cell."""
    rows = found.table
    angle = np.radians(rows["position"])
    load = programmes.GRAVITY[0] * np.cos(angle) + programmes.GRAVITY[1] * np.sin(angle) + 1.5
    error = rows["friction_torque"] - programmes.friction(rows["speed"], load, 30.0)
    assert abs(error.mean()) < 0.1
    assert error.std() < 0.8
    assert abs((rows["load_torque"] - load).mean()) < 0.15


def test_structure_that_the_model_lacks_stays_in_the_table():
    """A Stribeck term of 6 N·m below 4 deg/s, which equation (16) does not have."""
    generator = np.random.default_rng(12)
    motion = programmes.sines(900, generator)
    torque = programmes.torque(motion, alpha=0.0)
    torque += 6.0 * np.sign(motion[2]) * np.exp(-np.square(motion[2] / 4.0))
    torque += programmes.autoregressive(generator, len(torque), 0.3, 0.0)
    rows = torques_by_regression(programmes.samples(motion, torque).to_batches).table
    excess = rows["friction_torque"] - 8.0 - 2.0 * np.sqrt(rows["speed"])
    slow, fast = excess[rows["speed"] < 2.5].mean(), excess[rows["speed"] > 15].mean()
    assert slow - fast > 3.0


def test_every_sample_is_in_the_table_or_counted(found):
    used = found.table[["n_forward", "n_reverse"]].sum().sum()
    assert used + sum(found.dropped.values()) == found.samples


def test_the_table_has_the_form_of_torques(found, tmp_path):
    path = tmp_path / "torques.parquet"
    provenance = tables.Provenance("separate")
    tables.write(path, found.table, schemas.TORQUES, provenance)
    read = tables.read(path, schemas.TORQUES)
    assert len(read) == len(found.table)
    one_way = (read["n_forward"] == 0) | (read["n_reverse"] == 0)
    assert read.loc[~one_way, ["torque_forward", "torque_reverse"]].notna().all(axis=None)
    assert (read.groupby("pair")["speed"].nunique() == 1).all()
    assert read["pair"].nunique() == read["pair"].max() + 1


def test_a_pair_spans_little_speed_time_and_temperature():
    motion = programmes.sines(1500, np.random.default_rng(13), period=0.02)
    temperature = 20 + motion[0] / 60
    table = programmes.samples(motion, programmes.torque(motion), motor_temperature=temperature)
    rows = torques_by_regression(table.to_batches).table
    pairs = rows.groupby("pair").first()
    assert np.abs(pairs["motor_temperature"] - 20 - pairs["time"] / 60).max() < 0.01
    assert pairs["phase"].eq("heat-up").all()
    assert (np.diff(pairs["time"]) >= 0).all()
