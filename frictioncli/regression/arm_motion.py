"""Motion of all joints of an arm at the rows of one of them, through the same filter."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Array
from frictioncli.pairs.chunks import SampleChunk, chunks
from frictioncli.pairs.settings import SteadySettings
from frictioncli.regression.even_samples import even_samples
from frictioncli.regression.filters import filter_step, matched_filters
from frictioncli.regression.motion_rows import MotionLog


def arm_motions(
    read: Callable[[], Iterable[pa.RecordBatch]],
    motions: Mapping[int, MotionLog],
    joints: Sequence[int],
) -> dict[int, Array]:
    """Return position, velocity and acceleration of all joints at the rows of each.

    Parameters
    ----------
    read : callable
        Returns the batches of the table of samples from its start.
    motions : mapping of int to MotionLog
        Rows by joint.
    joints : sequence of int
        Joints of the arm, from its base.

    Returns
    -------
    dict of int to ndarray, shape (rows, joints, 3)
        Angle, velocity and acceleration by joint whose rows they are of; NaN where a joint has no
        samples. [deg], [deg/s], [deg/s²]
    """
    rows = {joint: motion.rows() for joint, motion in motions.items()}
    found = {joint: np.full((len(one), len(joints), 3), np.nan) for joint, one in rows.items()}
    for chunk in chunks(read(), ("position",), SteadySettings()):
        if chunk.source.joint not in joints:
            continue
        place = list(joints).index(chunk.source.joint)
        for joint, motion in motions.items():
            key = (chunk.source.run, chunk.source.recording)
            if key not in motion.recordings:
                continue
            number = motion.recordings.index(key)
            one = rows[joint]
            begin = np.searchsorted(one.recording, number)
            end = np.searchsorted(one.recording, number, side="right")
            time = one.time[begin:end]
            known, values = _at(chunk, time, motion.step * motion.period)
            found[joint][begin:end][known, place] = values
    return found


def _at(chunk: SampleChunk, time: Array, step_time: float) -> tuple[Array, Array]:
    """Return which times a chunk covers, and filtered position and derivatives there."""
    grid = even_samples(chunk)
    filters = matched_filters(filter_step(grid.period, step_time), grid.period)
    half = filters.half
    clock = grid.channels["time"]
    if len(clock) < 2 * half + 3:
        return np.zeros(len(time), dtype=bool), np.empty((0, 3))
    inner = clock[half : len(clock) - half]
    known = (time >= inner[0] - 1e-9) & (time <= inner[-1] + 1e-9)
    values = [
        np.interp(
            time[known], inner, np.convolve(grid.channels["position"], weights[::-1], "valid")
        )
        for weights in (filters.mean, filters.slope, filters.curvature)
    ]
    return known, np.stack(values, axis=1)
