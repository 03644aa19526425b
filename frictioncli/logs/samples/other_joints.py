"""Motion of the other joints of a recording: it adds torque that is no friction of the joint.

It is taken from positions, as their change over half a second: the noise of a differentiated
position is no motion, and what a motion leaves behind has settled half a second after it.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.logs.samples.poses import Poses

WINDOW = 0.5
"""Time over which the change of a position is taken. [s]"""

LEAST_SPEED = 0.5
"""Mean speed over it below which a joint stands. [deg/s]"""

_MOST_JOINTS = 53
"""Joints with a greater number are in no set: a sum of more powers of two is not exact."""

_TURN = 360.0
"""A position may jump by this where it wraps. [deg]"""


def with_other_joints(
    blocks: Iterable[LogRows], joints: Sequence[int], poses: Poses | None = None
) -> Iterator[LogRows]:
    """Yield rows with the motion and the pose of the other joints beside each joint's channels.

    It is the speed of the fastest of them, which of them move, and where all stand. Columns of
    joints that are not read are left out. Where the log has the position of one joint only, rows
    stay as they are.

    Parameters
    ----------
    blocks : iterable of LogRows
        Rows in ascending time, with the positions of all joints whose position is known.
    joints : sequence of int
        Joints that are read.
    poses : Poses, optional
        Poses of the logs before; new ones are added.
    """
    poses = poses or Poses()
    before: LogRows | None = None
    for block in blocks:
        positions = _positions(block)
        if len(positions) < 2:
            yield block
            continue
        tail = _tail(block, before, positions)
        speeds = {
            joint: mean_speed(tail.time, tail.columns[key])[len(tail) - len(block) :]
            for joint, key in positions.items()
        }
        before = tail.take(_last(tail.time))
        places = {
            joint: poses.places(joint, block.columns[key], speeds[joint] == 0)
            for joint, key in positions.items()
        }
        columns = {key: values for key, values in block.columns.items() if key[0] in joints}
        for joint in joints:
            others = {other: speed for other, speed in speeds.items() if other != joint}
            columns[joint, names.OTHER_SPEED] = np.max(list(others.values()), axis=0)
            columns[joint, names.OTHER_JOINTS] = joint_set(others)
            columns[joint, names.POSE] = poses.of(joint, places)
        yield LogRows(block.lines, block.time, columns)


def mean_speed(time: Array, position: Array) -> Array:
    """Return the mean speed over the last half second, 0 where it is below 0.5 deg/s.

    Parameters
    ----------
    time : ndarray, shape (rows,)
        Ascending times. [s]
    position : ndarray, shape (rows,)
        Positions; where one is missing the joint is taken to stand. [deg]

    Returns
    -------
    ndarray, shape (rows,)
        Speeds. [deg/s]

    Examples
    --------
    >>> import numpy as np
    >>> mean_speed(np.array([0.0, 0.5, 1.0, 1.5]), np.array([0.0, 0.1, 2.1, 2.1]))
    array([0., 0., 4., 0.])
    """
    position = np.where(np.isfinite(position), position, np.nan)
    earlier = np.maximum(np.searchsorted(time, time - WINDOW, side="right") - 1, 0)
    turned = np.abs((position - position[earlier] + _TURN / 2) % _TURN - _TURN / 2)
    speed = np.nan_to_num(turned / np.maximum(time - time[earlier], WINDOW))
    return np.where(speed < LEAST_SPEED, 0.0, speed)


def joint_set(speeds: Mapping[int, Array]) -> Array:
    """Return which joints move, as the sum of 2^(joint - 1).

    Parameters
    ----------
    speeds : mapping of int to ndarray, shape (rows,)
        Speed by joint, 0 where it stands. [deg/s]

    Returns
    -------
    ndarray, shape (rows,)
        Whole numbers.

    Examples
    --------
    >>> import numpy as np
    >>> joint_set({1: np.array([0.0, 2.0]), 3: np.array([0.0, 5.0])})
    array([0., 5.])
    """
    found = np.zeros(len(next(iter(speeds.values()))))
    for joint, speed in speeds.items():
        if joint <= _MOST_JOINTS:
            found += 2.0 ** (joint - 1) * (speed > 0)
    return found


def _positions(rows: LogRows) -> dict[int, tuple[int, str]]:
    return {key[0]: key for key in rows.columns if key[1] == names.POSITION}


def _tail(
    block: LogRows, before: LogRows | None, positions: Mapping[int, tuple[int, str]]
) -> LogRows:
    """Return times and positions of a block, behind those of the half second before it."""
    own = {key: block.columns[key] for key in positions.values()}
    rows = LogRows(block.lines, block.time, own)
    if before is None:
        return rows
    return LogRows(
        np.concatenate((before.lines, rows.lines)),
        np.concatenate((before.time, rows.time)),
        {key: np.concatenate((before.columns[key], values)) for key, values in own.items()},
    )


def _last(time: Array) -> slice:
    """Return the rows that those behind them may be compared with."""
    if not len(time):
        return slice(0)
    return slice(max(int(np.searchsorted(time, time[-1] - WINDOW, side="right")) - 1, 0), None)
