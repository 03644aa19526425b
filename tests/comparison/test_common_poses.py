"""A pose has the same number in all work folders that are compared."""

import numpy as np
import pandas as pd

from frictioncli.comparison.common_poses import with_common_poses


def test_poses_at_the_same_angles_are_one_and_others_are_not():
    folders = [pd.DataFrame({"pose": [0, 1, 1]}), pd.DataFrame({"pose": [0, 1, 70]})]
    stated = [
        [{"1": 0.0, "3": 90.0}, {"1": 0.0, "3": 10.0}],
        [{"1": 359.5, "3": 10.4}, {"1": 30.0, "3": 90.0}],
    ]
    first, second = with_common_poses(folders, stated)
    assert first["pose"].tolist() == [0, 1, 1]
    # the third is not stated: it is like no other
    assert second["pose"].tolist() == [1, 2, 3]


def test_poses_of_other_joints_and_unknown_ones_are_no_common_pose():
    folders = [pd.DataFrame({"pose": [0]}), pd.DataFrame({"pose": [0, None]})]
    first, second = with_common_poses(folders, [[{"1": 0.0}], [{"2": 0.0}]])
    assert first["pose"].tolist() == [0]
    assert second["pose"].tolist()[0] == 1
    assert np.isnan(second["pose"].tolist()[1])
    bare = with_common_poses([pd.DataFrame({"pose": [np.nan]})], [[]])[0]
    assert bare["pose"].isna().all()
