"""Motion of the joints beside the one that is read, from their positions alone."""

import warnings
from itertools import pairwise

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.logs.samples.other_joints import mean_speed, with_other_joints

TIME = np.arange(0, 20, 0.01)


def rows(**positions):
    columns = {(int(name[1:]), "position"): values for name, values in positions.items()}
    return LogRows(np.arange(len(TIME)), TIME, columns)


def other_speed(log, joints, cuts=()):
    """Return the speed beside each joint, reading the log in pieces."""
    edges = [0, *cuts, len(log)]
    pieces = [log.take(slice(a, b)) for a, b in pairwise(edges)]
    found = list(with_other_joints(pieces, joints))
    assert all(set(piece.columns) >= {(joint, "position") for joint in joints} for piece in found)
    return {
        joint: np.concatenate([piece.columns[joint, "other_speed"] for piece in found])
        for joint in joints
    }


def test_the_speed_of_the_fastest_other_joint_stands_beside_each():
    """Joint 1 turns at 8 deg/s from 2 s to 6 s, joint 2 at 3 deg/s from 4 s to 10 s."""
    log = rows(
        q1=8 * np.clip(TIME - 2, 0, 4), q2=3 * np.clip(TIME - 4, 0, 6), q3=np.full(len(TIME), 7.0)
    )
    found = other_speed(log, [1, 2, 3])
    at = {time: round(100 * time) for time in (1.0, 3.0, 5.0, 7.0, 12.0)}
    for joint, expected in {1: (0, 0, 3, 3, 0), 2: (0, 8, 8, 0, 0), 3: (0, 8, 8, 3, 0)}.items():
        assert found[joint][list(at.values())] == pytest.approx(expected)
    # what it leaves behind counts for half a second
    assert found[2][round(100 * 6.4)] > 0.5
    assert found[2][round(100 * 6.6)] == 0.0


def test_joints_that_are_not_read_count_and_their_columns_end_there():
    log = rows(q4=np.zeros(len(TIME)), q6=20 * np.clip(TIME - 2, 0, 4))
    (block,) = with_other_joints([log], [4])
    assert set(block.columns) == {
        (4, "position"),
        (4, "other_speed"),
        (4, "other_joints"),
        (4, "pose"),
    }
    # joint 6 alone moves, from 2 s on
    np.testing.assert_array_equal(block.columns[4, "other_joints"][[100, 300]], [0, 2**5])
    assert block.columns[4, "other_speed"][300] == pytest.approx(20)


@pytest.mark.parametrize("cuts", [(1000,), (1, 2, 3, 250, 251, 620), tuple(range(7, 1990, 7))])
def test_pieces_give_what_the_whole_gives(cuts):
    generator = np.random.default_rng(3)
    log = rows(q1=np.cumsum(generator.normal(0, 0.1, len(TIME))), q2=np.zeros(len(TIME)))
    whole, pieces = other_speed(log, [2]), other_speed(log, [2], cuts)
    np.testing.assert_array_equal(pieces[2], whole[2])
    assert (whole[2] > 0).any()
    assert (whole[2] == 0).any()


def test_noise_and_a_wrapping_angle_are_no_motion():
    generator = np.random.default_rng(4)
    noisy = generator.normal(0, 0.02, len(TIME))
    assert not mean_speed(TIME, noisy).any()
    # differentiated it would be 4 deg/s
    assert np.abs(np.gradient(noisy, TIME)).max() > 3
    assert not mean_speed(TIME, np.where(TIME < 9, 179.99, -179.99)).any()
    assert not mean_speed(TIME, np.full(len(TIME), np.nan)).any()


def test_a_log_of_one_joint_says_nothing():
    log = rows(q1=TIME)
    (block,) = with_other_joints([log], [1])
    assert set(block.columns) == {(1, "position")}


def test_a_joint_that_is_not_asked_for_is_seen_in_samples(tmp_path):
    """Joint 2 without a torque column, in the radians of joint 1 whatever the header says."""
    moved = np.deg2rad(30 * np.clip(TIME - 10, 0, 2))
    angle = np.deg2rad(40 * np.abs((TIME / 5) % 2 - 1))
    log = np.column_stack([TIME, angle, np.cos(angle), moved])
    header = "time [s],q_1 [rad],torque_1 [Nm],q_2 [rad]"
    (tmp_path / "day1").mkdir()
    np.savetxt(tmp_path / "day1" / "log.csv", log, "%.6f", ",", header=header, comments="")
    ingest([tmp_path / "day1"], tmp_path / "run", IngestSettings())
    table = tables.read(tmp_path / "run" / "samples.parquet", schemas.SAMPLES)
    assert set(table["joint"]) == {1}
    moves = table["other_speed"] > 0
    assert table.loc[moves, "time"].agg(["min", "max"]).tolist() == pytest.approx(
        [10, 12.5], abs=0.1
    )
    assert table["other_speed"].max() == pytest.approx(30, rel=0.01)


def test_damaged_angles_of_a_joint_that_is_not_read_end_nothing(tmp_path):
    """10^308 rad in a binary recording is more than a number of degrees can be."""
    angle = np.deg2rad(40 * np.abs((TIME / 5) % 2 - 1))
    other = np.where(np.arange(len(TIME)) == 700, 1e308, 0.0)
    log = np.column_stack([TIME, angle, np.cos(angle), other])
    head = b"timestamp actual_q_0 actual_current_0 actual_q_1\nDOUBLE DOUBLE DOUBLE DOUBLE\n"
    (tmp_path / "log.csv").write_bytes(head + log.astype(">f8").tobytes())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ingest([tmp_path / "log.csv"], tmp_path / "run", IngestSettings())
    table = tables.read(tmp_path / "run" / "samples.parquet", schemas.SAMPLES)
    assert (set(table["joint"]), len(table)) == ({1}, len(TIME))
