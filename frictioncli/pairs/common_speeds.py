"""The value that stands for a commanded speed: the mean of those of its pairs."""

import math

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.pairs.partitioned_store import PartitionedStore

Level = tuple[int, int]
"""Joint and level of speed."""

_SAME_COMMAND = 0.01
"""Speeds this close to the median of their level, as a share, are one commanded speed."""


def is_same_command(speed: Array, median: Array | float) -> Flags:
    """Return whether speeds are the commanded one whose median is given [deg/s]."""
    return np.abs(speed - median) < _SAME_COMMAND * median


def common_speeds(
    store: PartitionedStore[tuple[str, int]], medians: dict[Level, float]
) -> dict[Level, float]:
    """Return the mean of the speeds that are one commanded speed, by joint and level [deg/s]."""
    sums: dict[Level, list[float]] = {level: [] for level in medians}
    counts = dict.fromkeys(medians, 0)
    for joint in store.keys:
        for (pairs,) in store.read(joint, "pairs"):
            for one in np.unique(pairs["level"]).tolist():
                level = joint[1], one
                speed = pairs["speed"][pairs["level"] == one]
                same = speed[is_same_command(speed, medians[level])]
                sums[level].append(math.fsum(same))
                counts[level] += len(same)
    return {level: math.fsum(sums[level]) / max(counts[level], 1) for level in medians}
