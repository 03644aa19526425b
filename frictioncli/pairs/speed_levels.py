"""Commanded speeds: levels of speeds that are meant to be the same."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array, Numbers

_STEP = math.log1p(1e-4)
"""Speeds that differ by less than one part in 10,000 are counted as one."""


def steps_of(speed: ArrayLike) -> Numbers:
    """Return the logarithms of speeds in whole steps of one part in 10,000.

    Parameters
    ----------
    speed : array_like
        Speeds, > 0. [deg/s]

    Returns
    -------
    ndarray of int
        Steps above 1 deg/s.
    """
    return np.rint(np.log(speed) / _STEP).astype(np.int64)


def speed_levels(speed: Array, same: float) -> Numbers:
    """Return the number of the speed level of each segment; a level is at most ``2 * same`` wide.

    Parameters
    ----------
    speed : ndarray, shape (segments,)
        Speeds. [deg/s]
    same : float
        Greatest difference between neighbours of a level, as a share. [-]

    Returns
    -------
    ndarray of int, shape (segments,)
        Levels, numbered from 0 by ascending speed.

    Examples
    --------
    >>> speed_levels(np.array([50.0, 20.0, 50.5]), 0.03)
    array([1, 0, 1])
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
    """Counts of speeds in steps of one part in 10,000, so that their number stays bounded."""

    steps: Numbers = field(default_factory=lambda: np.empty(0, np.int64))
    counts: Numbers = field(default_factory=lambda: np.empty(0, np.int64))

    def add(self, speed: Array) -> None:
        """Count more speeds [deg/s]."""
        steps, counts = np.unique(steps_of(speed), return_counts=True)
        both, position = np.unique(np.concatenate([self.steps, steps]), return_inverse=True)
        total = np.bincount(position, np.concatenate([self.counts, counts]), len(both))
        self.steps, self.counts = both, total.astype(np.int64)

    @property
    def total(self) -> int:
        """Number of speeds counted."""
        return int(self.counts.sum())

    @property
    def speeds(self) -> Array:
        """Speeds that occur, ascending [deg/s]."""
        return np.exp(self.steps * _STEP)

    @property
    def median(self) -> float:
        """Median speed [deg/s]."""
        reached = np.cumsum(self.counts)
        middle = np.searchsorted(reached, [(reached[-1] + 1) // 2, reached[-1] // 2 + 1])
        return float(np.mean(self.speeds[middle]))
