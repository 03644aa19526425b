"""Samples taken while another joint moves make no pair, unless nothing would be left."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from tests.found import pairs as paired
from tests.logs.logs import REAL
from tests.moves import move_sequence, samples

REASON = "other joint moves"


def strokes(count, *, moves=lambda time: np.zeros(len(time), bool), disturbance=0.0, **columns):
    """Moves there and back at 30 deg/s; another joint moves at times, and disturbs the torque."""
    frame = samples(move_sequence([0, 90] * count, [30.0] * (2 * count - 1)), friction=8.0)
    other = moves(frame["time"].to_numpy())
    torque = frame["torque"] + disturbance * other
    return frame.assign(torque=torque, other_speed=12.0 * other, **columns)


def friction(pairs):
    return ((pairs["torque_forward"] - pairs["torque_reverse"]) / 2).to_numpy()


def test_bins_during_which_another_joint_moves_are_left_out_and_counted():
    clean = paired(strokes(6))
    frame = strokes(6, moves=lambda time: time < 5.0, disturbance=20.0)
    found = paired(frame)
    assert found.dropped[REASON] > 100
    assert clean.dropped[REASON] == 0
    np.testing.assert_allclose(friction(found.pairs), 8.0, atol=0.05)
    # without the column the disturbance enters the friction
    disturbed = friction(paired(frame.drop(columns="other_speed")).pairs)
    assert np.abs(disturbed - 8.0).max() > 5.0
    kept = found.pairs[["n_forward", "n_reverse"]].to_numpy().sum()
    assert kept + sum(found.dropped.values()) == found.samples


def test_a_joint_that_never_moves_alone_is_used_nonetheless():
    found = paired(strokes(6, moves=lambda time: time > 5.0))
    assert found.dropped[REASON] == 0
    assert found.pairs["n_forward"].sum() == paired(strokes(6)).pairs["n_forward"].sum()


def test_a_joint_of_which_no_pair_would_be_left_is_used_nonetheless():
    """One stroke there and a longer way back: the way there is a third, all of it shared."""
    frame = samples(move_sequence([0, 60, -60], [30.0] * 2), friction=8.0)
    there = frame["velocity"] > 0
    found = paired(frame.assign(other_speed=9.0 * there))
    assert len(found.pairs) == len(paired(frame).pairs) > 0
    assert found.dropped[REASON] == 0


def test_joints_are_judged_one_by_one():
    one = strokes(6, moves=lambda time: time < 5.0)
    other = strokes(6, moves=lambda time: time > 5.0, joint=3)
    both = paired(pd.concat([one, other], ignore_index=True))
    assert both.dropped[REASON] == paired(one).dropped[REASON]
    count = both.pairs.groupby("joint")["n_forward"].sum()
    assert count[3] == paired(strokes(6)).pairs["n_forward"].sum() > count[2]


@pytest.mark.parametrize("value", [np.nan, 0.0])
def test_an_unknown_or_resting_neighbour_changes_nothing(value):
    found, plain = paired(strokes(3).assign(other_speed=value)), paired(strokes(3))
    assert found.pairs.equals(plain.pairs)


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
@pytest.mark.parametrize("joints", [(4,), None])
def test_real_neighbours_that_drive_to_zero_are_no_step_and_no_payload(tmp_path, joints):
    """Kinova Gen3: four other joints move in the first 9 s of the first file."""
    ingest([REAL / "kinova-gen3-j4"], tmp_path, IngestSettings(joints=joints))
    text = pair(tmp_path).text
    assert "other joint moves 12;" in text
    assert "note: joint 4: another joint moves during 5 % of its motion at constant speed" in text
    if joints is None:
        return  # the pairs are the same
    for stage in (separate, fit, diagnose):
        stage(tmp_path)
    found, _ = read_documents(tmp_path)[4]
    names = {name for cause in (*found.causes, *found.visible) for name in cause.effects}
    assert not names & {"step_change", "payload_change"}
