"""Of several torque-like channels of a joint, the one that bears friction is read."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import REAL, write


def two_joints(*, compensated: float, seed=0):
    """Return a log of joint 1 in motion and joint 2 at rest, with torque and current of both.

    Gravity is 30 N·m times the cosine of the angle, friction 4 N·m + 0.02 N·m/(deg/s), and a motor
    current has 0.2 A/(N·m). The controller frees the torque of a share of the friction, with an
    error of the load that depends on the angle.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 120.0, 0.05)
    rate = 2 * np.pi / np.repeat([24.0, 12.0], len(time) // 2)
    phase = np.cumsum(rate) * 0.05
    position, velocity = 70 * np.sin(phase), 70 * rate * np.cos(phase)
    gravity = 30 * np.cos(np.radians(position))
    friction = np.sign(velocity) * (4 + 0.02 * np.abs(velocity))
    error = 0.4 * np.sin(np.radians(7 * position)) * np.sign(velocity)
    torque = gravity + (1 - compensated) * friction + compensated * error
    still = np.zeros_like(time)
    return {
        "time": time,
        "pos_1": position,
        "pos_2": still + 12.0,
        "torque_1": torque + rng.normal(0, 0.05, len(time)),
        "torque_2": still + 3.0 + rng.normal(0, 0.05, len(time)),
        "current_1": 0.2 * (gravity + friction) + rng.normal(0, 0.02, len(time)),
        "current_2": still + 0.7 + rng.normal(0, 0.02, len(time)),
    }


@pytest.mark.parametrize("compensated", [0.95, 1.0])
def test_a_torque_freed_of_friction_becomes_the_load(compensated, tmp_path):
    columns = two_joints(compensated=compensated)
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert summary.torque_unit == "A"
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    moving = table[table["joint"] == 1].set_index("time")
    line = np.searchsorted(columns["time"], moving.index)
    np.testing.assert_allclose(moving["torque"], columns["current_1"][line], atol=1e-8)
    np.testing.assert_allclose(moving["load"], columns["torque_1"][line], atol=1e-8)
    (why,) = (note for note in summary.notes if "torque of joint 1 is current_1" in note)
    assert "torque_1 is free of most friction" in why
    assert "torque_1 serves as load" in why


@pytest.mark.parametrize("compensated", [0.0, 0.5])
def test_a_torque_that_bears_friction_is_kept(compensated, tmp_path):
    columns = two_joints(compensated=compensated)
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert summary.torque_unit == "N·m"
    assert "torque of joint 1 is torque_1; not used: current_1" in summary.notes


def test_a_single_torque_is_never_exchanged(tmp_path):
    columns = two_joints(compensated=1.0)
    del columns["current_1"], columns["current_2"]
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert summary.torque_unit == "N·m"


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
@pytest.mark.parametrize(("folder", "joint"), [("xarm6-j2", 2), ("xarm6-j3", 3)])
def test_xarm_unaided_is_read_as_with_its_map(folder, joint, tmp_path):
    summary = ingest([REAL / folder], tmp_path, IngestSettings(joints=(joint,)))
    assert summary.torque_unit == "A"
    table = tables.read(tmp_path / "samples.parquet", schemas.SAMPLES)
    assert table["load"].notna().all()
