"""How much the columns of a log depend on the direction of motion, as a torque does."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.map_suggestion.log_head import LogHead

_LEAST_SPEED = 0.1
"""Least speed of a moving joint, as a share of the highest speed."""
_LEAST_SAMPLES = 20
_LEAST_EXPLAINED = 0.05
"""Least share of variance that the direction explains in a torque."""
_LEAST_GRAVITY = 0.5
"""Least share of variance that the angle explains in a load."""


@dataclass(frozen=True, slots=True)
class DirectionDependence:
    """Dependence of a column on the direction of motion.

    Attributes
    ----------
    column : int
        Index in the file.
    explained : float
        Share of the variance left by gravity that direction and velocity explain. [-]
    jump : float
        Half the difference between the two directions. [raw]
    by_angle : float
        Share of the total variance that gravity explains. [-]
    """

    column: int
    explained: float
    jump: float
    by_angle: float

    @property
    def is_significant(self) -> bool:
        """Whether the column depends on the direction."""
        return self.explained > _LEAST_EXPLAINED

    @property
    def is_load(self) -> bool:
        """Whether the column depends on the angle and not on the direction, as a load does."""
        return not self.is_significant and self.by_angle > _LEAST_GRAVITY


def direction_dependences(
    head: LogHead, position: Array, velocity: Array, excluded: Collection[int]
) -> list[DirectionDependence]:
    """Return how much each column depends on the direction of motion, in descending order.

    Two linear regressions are compared: on gravity (a constant, sine and cosine of the angle), and
    on gravity, the sign of velocity and velocity.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    position : ndarray, shape (n,)
        The joint's position. [deg]
    velocity : ndarray, shape (n,)
        The joint's velocity. [deg/s]
    excluded : collection of int
        Columns that are no torque: times, positions, velocities.
    """
    speed = np.abs(velocity)
    moving = speed > _LEAST_SPEED * float(np.max(speed, initial=0.0))
    if np.count_nonzero(moving) < _LEAST_SAMPLES:
        return []
    angle = np.radians(position[moving])
    ones = np.ones(len(angle))
    gravity = np.stack([ones, np.sin(angle), np.cos(angle)], axis=1)
    direction = np.stack([np.sign(velocity[moving]), velocity[moving]], axis=1)
    both = np.concatenate([gravity, direction], axis=1)
    found = []
    for column, all_values in head.values.items():
        if column in excluded:
            continue
        values = all_values[moving]
        without_direction = _mean_squared_residual(gravity, values)
        with_direction = _mean_squared_residual(both, values)
        variance = float(np.var(values))
        if variance <= 0 or without_direction <= 0:
            continue
        signed = np.column_stack([gravity, direction[:, 0]])
        jump = float(np.linalg.lstsq(signed, values, rcond=None)[0][-1])
        explained = 1 - with_direction / without_direction
        by_angle = max(1 - without_direction / variance, 0.0)
        found.append(DirectionDependence(column, explained, jump, by_angle))
    return sorted(found, key=lambda one: -one.explained)


def _mean_squared_residual(regressors: Array, values: Array) -> float:
    """Return the mean squared residual of a linear regression."""
    coefficients = np.linalg.lstsq(regressors, values, rcond=None)[0]
    return float(np.mean((values - regressors @ coefficients) ** 2))
