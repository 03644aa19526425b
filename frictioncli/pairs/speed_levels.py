"""Commanded speeds: which speeds of a log are meant to be the same, whatever its size."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array, Numbers

_STEP = math.log1p(1e-4)
"""Speeds that differ by less than one part in 10,000 are counted as one."""


def steps_of(speed: ArrayLike) -> Numbers:
    """Return speeds as numbers of steps of one part in 10,000.

    Parameters
    ----------
    speed : array_like
        Speeds, > 0. [deg/s]
    """
    return np.rint(np.log(speed) / _STEP).astype(np.int64)


def speed_levels(speed: Array, same: float) -> Numbers:
    """Return the number of the speed level of each span; a level spans at most ``2 * same``.

    Parameters
    ----------
    speed : ndarray, shape (spans,)
        Speeds. [deg/s]
    same : float
        Greatest difference between neighbours of a level, as a share.
    """
    level = np.zeros(len(speed), dtype=np.int64)
    number, floor, last = -1, -np.inf, -np.inf
    for index in np.argsort(speed, kind="stable"):
        if speed[index] > last * (1 + same) or speed[index] > floor * (1 + 2 * same):
            number, floor = number + 1, speed[index]
        level[index], last = number, speed[index]
    return level


@dataclass(slots=True)
class SpeedCounts:
    """How often which speed occurs; there are only so many, however long a log is."""

    steps: Numbers = field(default_factory=lambda: np.empty(0, np.int64))
    counts: Numbers = field(default_factory=lambda: np.empty(0, np.int64))

    def add(self, speed: Array) -> None:
        """Count more speeds [deg/s]."""
        steps, counts = np.unique(steps_of(speed), return_counts=True)
        both, place = np.unique(np.concatenate([self.steps, steps]), return_inverse=True)
        total = np.bincount(place, np.concatenate([self.counts, counts]), len(both))
        self.steps, self.counts = both, total.astype(np.int64)

    @property
    def total(self) -> int:
        """Number of speeds counted."""
        return int(self.counts.sum())

    @property
    def speeds(self) -> Array:
        """The speeds that occur, growing [deg/s]."""
        return np.exp(self.steps * _STEP)

    @property
    def median(self) -> float:
        """Median speed [deg/s]."""
        reached = np.cumsum(self.counts)
        middle = np.searchsorted(reached, [(reached[-1] + 1) // 2, reached[-1] // 2 + 1])
        return float(np.mean(self.speeds[middle]))
