"""Misfit of the simulated torque in the ramps, and the columns that may explain it.

Counted as friction, the misfit is the measured torque less gravity, in the direction of the motion,
minus the friction (16) of the base model at the velocity of each angle bin.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.gravity import NAMES, known_payload
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.robust_fit import Labels, Projection
from frictioncli.model.friction import friction_torque
from frictioncli.model.zero_load import temperature_of
from frictioncli.pairs.ramps import LAGS

_CORRELATED = 10.0
"""Number of samples beyond which further ones hardly reduce the variance of a mean."""

_SAME_SPEED = 0.03
"""Relative width of a speed level."""

_SLOW_SCALES = (3.0, 10.0)
"""Speeds over which a misfit of friction at low speed decays. [deg/s]"""

_SLOWEST = 0.5
"""Below this speed the direction of friction is uncertain. [deg/s]"""

_STEADY = 0.02
"""Share of the greatest acceleration below which a bin counts as constant velocity."""

_REACHED = 0.9
"""Share of its speed at which a ramp counts as finished."""

_LEAST_SAMPLES = 8
"""Least number of samples of a ramp until then."""


def resolved(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that can be simulated, grouped by move.

    Rows too slow for friction to have a direction are left out, and the accelerating rows of ramps
    with too few samples, whose acceleration is not resolved.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.RAMPS` of one joint.

    Returns
    -------
    DataFrame
        The rows with the column ``accelerates``: whether the bin is not at constant velocity.
    """
    moving = rows["velocity"] * rows["direction"] > _SLOWEST
    rows = rows[moving].sort_values("move", kind="stable", ignore_index=True)
    most = rows[list(LAGS)].abs().max(axis=1)
    accelerates = most > _STEADY * most.max()
    slower = rows["velocity"].abs() < _REACHED * rows["speed"]
    samples = (
        rows["samples"].where(slower, 0).groupby([rows["move"], rows["part"]]).transform("sum")
    )
    kept = rows.assign(accelerates=accelerates)[~accelerates | (samples >= _LEAST_SAMPLES)]
    return kept.reset_index(drop=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class RampMisfit:
    """Misfit of the ramps, counted as friction, and columns that may explain it.

    Attributes
    ----------
    rows : DataFrame
        The rows, grouped by move.
    sign : int
        Sign convention of the log.
    inertial : ndarray, shape (rows, columns)
        Acceleration at each of :data:`frictioncli.pairs.ramps.LAGS` counted as friction
        [deg/s²], and that without lag times the payload above the mean where payloads differ
       [kg·deg/s²].
    misfit : ndarray, shape (rows,)
        Measured minus simulated friction, without inertia. [N·m]
    projection : Projection
        Projection off the nuisance columns.
    clusters : tuple of ndarray of int
        Clusterings by move, and by direction, part and speed of the move.
    after_reversal, after_start : ndarray, shape (rows,)
        1 in the accelerating part of a move after a reversal, after any start; else 0.
    ramp_time : ndarray, shape (rows,)
        Duration of the acceleration of the row's move. [s]
    """

    rows: pd.DataFrame
    sign: int
    inertial: Array
    misfit: Array
    projection: Projection
    clusters: tuple[Labels, ...]
    after_reversal: Array
    after_start: Array
    ramp_time: Array

    @classmethod
    def of(cls, rows: pd.DataFrame, sign: int, problem: Problem, temperature: str) -> "RampMisfit":
        """Return the misfit of rows under a base model.

        Parameters
        ----------
        rows : DataFrame
            As of :func:`resolved`.
        sign : int
            Sign convention of the log.
        problem : Problem
            Problem with the base model.
        temperature : {"motor", "housing", "mean"}
            Temperature that the friction function is given.
        """
        direction = sign * rows["direction"].to_numpy(float)[:, np.newaxis]
        speed = rows["velocity"].abs().to_numpy(float)
        gravity = problem.gravity_form.columns(rows)
        # a sine averaged over a bin is less than the sine at its centre
        sines = [column for column in range(gravity.shape[1]) if column != NAMES.index("offset")]
        spread = np.radians(rows["spread"].to_numpy(float))
        gravity[:, sines] *= 1 - np.square(spread[:, np.newaxis]) / 2
        gravity_torque = gravity @ problem.gravity
        load = rows["load"].to_numpy(float) if problem.has_load_channel else gravity_torque
        known_temperature = np.nan_to_num(temperature_of(rows, temperature).to_numpy(float))
        friction = friction_torque(
            problem.parameters, load=load, speed=speed, temperature=known_temperature
        )
        # a load channel may have another unit: gravity in the torque is then a nuisance column
        gravity_torque = 0.0 * gravity_torque if problem.has_load_channel else gravity_torque
        misfit = direction[:, 0] * (rows["torque"].to_numpy(float) - gravity_torque) - friction
        inertial = direction * rows[list(LAGS)].to_numpy(float)
        if problem.gravity_form.payloads:
            mass = np.nan_to_num(known_payload(rows))
            acceleration = direction[:, 0] * rows["acceleration"].to_numpy(float)
            inertial = np.column_stack([inertial, acceleration * (mass - mass.mean())])
        common = [speed, np.square(load), *(np.exp(-speed / scale) for scale in _SLOW_SCALES)]
        count = rows["samples"].to_numpy(float)
        move = rows["move"].to_numpy()
        level = np.round(np.log(rows["speed"].to_numpy(float)) / _SAME_SPEED)
        part = (rows["part"] == "accelerating").to_numpy()
        conditions = pd.MultiIndex.from_arrays([level, direction[:, 0], part])
        return cls(
            rows=rows,
            sign=sign,
            inertial=inertial,
            misfit=misfit,
            projection=Projection.of(
                1 / (1 / count + 1 / _CORRELATED),
                move,
                np.column_stack([np.ones_like(speed), np.sqrt(speed)]),
                np.column_stack([direction * gravity, *common]),
            ),
            clusters=(pd.factorize(move)[0], pd.factorize(conditions)[0]),
            after_reversal=(part & rows["reversal"].to_numpy(bool)).astype(float),
            after_start=part.astype(float),
            ramp_time=_ramp_time(rows, part),
        )

    def deficit(self, distance: float) -> Array:
        """Return the shape of a friction deficit after a reversal, -1 at first, shape (rows,). [-].

        Parameters
        ----------
        distance : float
            Angle over which it decays. [deg]
        """
        return -self.after_reversal * np.exp(-self.rows["distance"].to_numpy(float) / distance)

    def delayed_acceleration(self, time: float) -> Array:
        """Return the acceleration of the ramps after a first-order lag, shape (rows,) [deg/s²].

        Parameters
        ----------
        time : float
            Time constant of the lag. [s]
        """
        ramp_time, elapsed = self.ramp_time, self.rows["elapsed"].to_numpy(float)
        rise = -np.expm1(-np.minimum(elapsed, ramp_time) / time)
        decay = np.exp(-np.maximum(elapsed - ramp_time, 0.0) / time)
        acceleration = self.rows["speed"].to_numpy(float) / ramp_time
        return self.sign * self.after_start * acceleration * rise * decay


def _ramp_time(rows: pd.DataFrame, accelerating: Flags) -> Array:
    """Return the duration of each row's acceleration: speed over greatest acceleration [s]."""
    steepest = rows["acceleration"].abs().where(accelerating).groupby(rows["move"]).transform("max")
    return np.asarray(rows["speed"] / np.maximum(steepest.fillna(0.0), 1.0), dtype=float)
