"""Moves are paired in one pose of the other joints: in another one gravity is another."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from tests.found import pairs as paired
from tests.moves import move_sequence, samples

OTHER = "the other joints are at other angles than for the partner"
ELSEWHERE = "other joints stop at other angles, or the payload changes"
FRICTION = 8.0


def moves(turns, poses, speed=40.0, **columns):
    """One move after the other, each in a pose whose gravity is 40 N·m times its number + 1."""
    parts = [
        samples(
            move_sequence(ends, [speed]),
            friction=FRICTION,
            load=lambda q, pose=pose: 40 * (1 + np.nan_to_num(pose)) * np.cos(np.radians(q)),
            pose=pose,
            **columns,
        )
        for ends, pose in zip(pairwise(turns), poses, strict=True)
    ]
    frame = pd.concat(parts, ignore_index=True)
    return frame.assign(time=0.012 * frame.index)


def friction(pairs):
    return ((pairs["torque_forward"] - pairs["torque_reverse"]) / 2).to_numpy()


def test_a_move_passes_by_neighbours_in_another_pose():
    found = paired(moves([0, 170, 0, 170, 0], [0, 1, 1, 0]))
    assert sorted(found.pairs["pose"].unique()) == [0, 1]
    np.testing.assert_allclose(friction(found.pairs), FRICTION, rtol=0.01)
    assert found.dropped[OTHER] == 0


def test_what_only_another_pose_would_match_is_counted():
    found = paired(moves([0, 170, 0, 170], [0, 0, 1]))
    assert found.pairs["pose"].unique().tolist() == [0]
    assert found.dropped[OTHER] == 0  # the partner is taken already
    found = paired(moves([0, 170, 0, 170, 60], [0, 0, 1, 0]))
    same = paired(moves([0, 170, 0, 170, 60], [0, 0, 0, 0]))
    lost = same.pairs[same.pairs["pair"] == 1]
    assert found.dropped[OTHER] == lost["n_forward"].sum() + lost["n_reverse"].sum() > 0
    kept = found.pairs["n_forward"].sum() + found.pairs["n_reverse"].sum()
    assert kept + sum(found.dropped.values()) == found.samples


def test_pairs_across_poses_are_used_where_there_are_no_others():
    found = paired(moves([0, 170, 0, 170, 0], [0, 1, 0, 1]))
    assert len(found.pairs)
    assert found.pairs["pose"].isna().all()
    # half of what the pose changes in gravity, 20 N·m at 0 deg
    error = friction(found.pairs) - FRICTION
    expected = -20 * np.cos(np.radians(found.pairs["position"]))
    np.testing.assert_allclose(error, expected, atol=0.1)


def test_of_a_move_during_which_the_pose_changes_the_longer_part_is_used():
    frame = moves([0, 170, 0], [0, 0])
    early = frame.index < 0.3 * frame.index[frame["velocity"] > 0].max()
    found = paired(frame.assign(pose=np.where(early, 1, 0)))
    assert found.pairs["pose"].unique().tolist() == [0]
    assert found.dropped[ELSEWHERE] > 0
    assert found.pairs["position"].min() > 40


@pytest.mark.parametrize("pose", [np.nan, 3])
def test_one_pose_or_none_changes_nothing(pose):
    found = paired(moves([0, 170, 0], [0, 0]).assign(pose=pose)).pairs
    plain = paired(moves([0, 170, 0], [0, 0])).pairs
    pd.testing.assert_frame_equal(found.drop(columns="pose"), plain.drop(columns="pose"))


def test_where_others_move_throughout_poses_are_of_no_use():
    """Their samples are used nonetheless, and have no pose."""
    frame = moves([0, 170, 0, 170, 0], [0, 1, 0, 1], other_speed=12.0)
    found = paired(frame.assign(pose=np.where(frame.index % 3, np.nan, frame["pose"])))
    assert found.pairs["pose"].isna().all()
    assert found.dropped[OTHER] == 0
