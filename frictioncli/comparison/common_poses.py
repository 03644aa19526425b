"""Poses of the other joints, whose numbers are those of one work folder, over several folders."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from frictioncli.logs.samples.poses import SAME_PLACE

_TURN = 360.0  # [deg]

Angles = Mapping[str, float]
"""Angles at which the other joints stand in a pose, by joint. [deg]"""


def with_common_poses(
    folders: Sequence[pd.DataFrame], stated: Sequence[Sequence[Angles]]
) -> list[pd.DataFrame]:
    """Return the torques of one joint with poses that have the same number in all work folders.

    Parameters
    ----------
    folders : sequence of DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of each folder.
    stated : sequence of sequence of Angles
        The poses of each folder by their numbers; one that is not stated is like no other.

    Returns
    -------
    list of DataFrame
        The rows with poses renumbered.

    Examples
    --------
    >>> folders = [pd.DataFrame({"pose": [0, 1]}), pd.DataFrame({"pose": [0, None]})]
    >>> found = with_common_poses(folders, [[{"3": 10.0}, {"3": 359.8}], [{"3": 0.1}]])
    >>> [rows["pose"].tolist() for rows in found]
    [[0.0, 1.0], [1.0, nan]]
    """
    known: list[Angles] = []
    found = []
    for rows, poses in zip(folders, stated, strict=True):
        pose = rows["pose"].to_numpy(float, na_value=np.nan)
        common = pose.copy()
        for number in np.unique(pose[np.isfinite(pose)]).astype(int).tolist():
            angles = poses[number] if number < len(poses) else {}
            same = [index for index, other in enumerate(known) if _same(angles, other)]
            common[pose == number] = same[0] if same else len(known)
            known += [] if same else [angles]
        found.append(rows.assign(pose=common))
    return found


def _same(one: Angles, other: Angles) -> bool:
    """Return whether two poses are of the same joints at the same angles."""
    if not one or one.keys() != other.keys():
        return False
    away = [abs((one[joint] - other[joint] + _TURN / 2) % _TURN - _TURN / 2) for joint in one]
    return max(away) <= SAME_PLACE
