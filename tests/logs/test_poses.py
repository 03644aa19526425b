"""Poses of the other joints, from their positions alone."""

from itertools import pairwise

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.logs.samples.other_joints import with_other_joints
from frictioncli.logs.samples.poses import Poses

TIME = np.arange(0, 40, 0.01)


def rows(**positions):
    columns = {(int(name[1:]), "position"): values for name, values in positions.items()}
    return LogRows(np.arange(len(TIME)), TIME, columns)


def poses(log, joint, cuts=()):
    """Return the pose beside a joint, reading the log in pieces."""
    pieces = [log.take(slice(a, b)) for a, b in pairwise([0, *cuts, len(log)])]
    found = with_other_joints(pieces, [joint], Poses())
    return np.concatenate([piece.columns[joint, "pose"] for piece in found])


def turned(start, by, speed=20.0):
    """Return the angle of a joint that turns at some time."""
    return np.sign(by) * np.clip(speed * (TIME - start), 0, abs(by))


def test_a_pose_is_where_all_others_stand_and_is_none_while_one_moves():
    """Joint 2 turns by 30 deg at 10 s and back at 30 s, joint 3 by 5 deg at 20 s."""
    log = rows(q1=TIME, q2=turned(10, 30) - turned(30, 30), q3=turned(20, 5))
    found = poses(log, 1)
    at = [found[round(100 * time)] for time in (5, 15, 25, 35)]
    assert at == [0, 1, 2, 3]
    assert np.isnan(found[(100 * 11)])
    # joint 1 never stands
    assert np.isnan(poses(log, 3)[100:]).all()


@pytest.mark.parametrize("cuts", [(1000,), (1, 2, 3, 250, 1100, 3020), tuple(range(7, 3990, 7))])
def test_pieces_give_what_the_whole_gives(cuts):
    generator = np.random.default_rng(3)
    steps = np.repeat(generator.uniform(0, 4, 40), 100) + generator.normal(0, 0.01, len(TIME))
    log = rows(q1=TIME, q2=steps, q3=turned(20, 5))
    whole = poses(log, 1)
    np.testing.assert_array_equal(poses(log, 1, cuts), whole)
    assert np.nanmax(whole) > 3


def test_noise_a_wrapping_angle_and_a_missing_one_are_no_other_pose():
    generator = np.random.default_rng(4)
    noisy = 359.99 + generator.normal(0, 0.02, len(TIME))
    log = rows(q1=TIME, q2=noisy % 360, q3=np.full(len(TIME), np.nan))
    assert set(poses(log, 1)) == {0.0}


def test_poses_keep_their_numbers_over_logs_and_runs(tmp_path):
    """Joint 2 stands at 10 deg on the first day, at 50 and again at 10.4 deg on the second."""
    angle = 40 * np.abs((TIME / 5) % 2 - 1)
    for day, name, stands in (("a", "1", 10), ("b", "1", 50), ("b", "2", 10.4)):
        log = np.column_stack([TIME, angle, np.cos(angle), np.full(len(TIME), stands)])
        header = "time [s],q_1 [deg],torque_1 [Nm],q_2 [deg]"
        (tmp_path / day).mkdir(exist_ok=True)
        path = tmp_path / day / f"{name}.csv"
        np.savetxt(path, log, "%.6f", ",", header=header, comments="")
    ingest([tmp_path / "a", tmp_path / "b"], tmp_path / "run", IngestSettings())
    source = tmp_path / "run" / "samples.parquet"
    table = tables.read(source, schemas.SAMPLES)
    found = table.groupby(["run", "recording"], observed=True)["pose"].unique().map(list).to_dict()
    assert found == {("a", "1"): [0], ("b", "1"): [1], ("b", "2"): [0]}
    assert tables.facts(source)["poses"] == {"1": [{"2": 10.0}, {"2": 50.0}]}
