"""The misfit of the ramps' torque, counted as friction, and the columns that may explain it."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.gravity import NAMES, columns_of, known_payload
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.robust_fit import Labels, Projection
from frictioncli.model.friction import friction_torque
from frictioncli.model.zero_load import temperature_of
from frictioncli.pairs.ramps import LAGS

_CORRELATED = 10.0
"""Neighbouring samples beyond this number add nothing to a mean."""

_SAME_SPEED = 0.03
_SLOW_SCALES = (3.0, 10.0)
"""Speeds over which a misfit of friction at low speed may fade. [deg/s]"""

_SLOWEST = 0.5
"""Below this speed friction has no direction to speak of. [deg/s]"""

_STEADY = 0.02
"""Share of the greatest acceleration below which a bin counts as constant velocity."""

_REACHED = 0.9
_LEAST_SAMPLES = 8
"""A ramp must have as many samples until it has reached this share of its speed."""


def resolved(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that can be simulated, those of one move together.

    Without those too slow for friction to have a direction, and without those in which a ramp of
    too few samples accelerates: where it cannot be followed, acceleration is not known.
    ``accelerates`` tells the others apart.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.RAMPS` of one joint.
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
    """The ramps' misfit, counted as friction, and what may explain it.

    Attributes
    ----------
    rows : DataFrame
        The rows, those of one move together.
    sign : int
        Sign convention of the log.
    inertial : ndarray, shape (rows, columns)
        Acceleration at each of :data:`frictioncli.pairs.ramps.LAGS` counted as friction
        [deg/s²], and the one without lag times the mass above the mean where payloads differ
        [kg·deg/s²].
    misfit : ndarray, shape (rows,)
        Measured minus simulated friction without inertia. [N·m]
    projection : Projection
        Takes out what is free.
    clusters : tuple of ndarray of int
        Rows of one move; rows of all moves of one direction, part and speed.
    fresh, begun : ndarray, shape (rows,)
        1 where the joint accelerates after a reversal, after standing; else 0.
    ramp : ndarray, shape (rows,)
        How long the row's move accelerates. [s]
    """

    rows: pd.DataFrame
    sign: int
    inertial: Array
    misfit: Array
    projection: Projection
    clusters: tuple[Labels, ...]
    fresh: Array
    begun: Array
    ramp: Array

    @classmethod
    def of(cls, rows: pd.DataFrame, sign: int, problem: Problem, temperature: str) -> "RampMisfit":
        """Return the misfit of rows under a problem's base; parameters as ``ramp_evidence``."""
        frame = sign * rows["direction"].to_numpy(float)[:, np.newaxis]
        speed = rows["velocity"].abs().to_numpy(float)
        payloads = len(problem.gravity) > len(NAMES)
        gravity = columns_of(rows, payloads=payloads)
        # the mean of a sine over a bin is less than the sine of the mean
        turning = [column for column in range(gravity.shape[1]) if column != NAMES.index("offset")]
        spread = np.radians(rows["spread"].to_numpy(float))
        gravity[:, turning] *= 1 - np.square(spread[:, np.newaxis]) / 2
        held = gravity @ problem.gravity
        load = rows["load"].to_numpy(float) if problem.own_load else held
        warm = np.nan_to_num(temperature_of(rows, temperature).to_numpy(float))
        friction = friction_torque(problem.parameters, load=load, speed=speed, temperature=warm)
        # a load channel may have another unit: what it does in the torque is then left free
        held = 0.0 * held if problem.own_load else held
        misfit = frame[:, 0] * (rows["torque"].to_numpy(float) - held) - friction
        inertial = frame * rows[list(LAGS)].to_numpy(float)
        if payloads:
            mass = np.nan_to_num(known_payload(rows))
            now = frame[:, 0] * rows["acceleration"].to_numpy(float)
            inertial = np.column_stack([inertial, now * (mass - mass.mean())])
        common = [speed, np.square(load), *(np.exp(-speed / scale) for scale in _SLOW_SCALES)]
        count = rows["samples"].to_numpy(float)
        move = rows["move"].to_numpy()
        level = np.round(np.log(rows["speed"].to_numpy(float)) / _SAME_SPEED)
        part = (rows["part"] == "accelerating").to_numpy()
        alike = pd.MultiIndex.from_arrays([level, frame[:, 0], part])
        return cls(
            rows=rows,
            sign=sign,
            inertial=inertial,
            misfit=misfit,
            projection=Projection.of(
                1 / (1 / count + 1 / _CORRELATED),
                move,
                np.column_stack([np.ones_like(speed), np.sqrt(speed)]),
                np.column_stack([frame * gravity, *common]),
            ),
            clusters=(pd.factorize(move)[0], pd.factorize(alike)[0]),
            fresh=(part & rows["reversal"].to_numpy(bool)).astype(float),
            begun=part.astype(float),
            ramp=_ramp_time(rows, part),
        )

    def lack(self, distance: float) -> Array:
        """Return the friction that lacks after a reversal, 1 at first. [-]."""
        return -self.fresh * np.exp(-self.rows["distance"].to_numpy(float) / distance)

    def settling(self, time: float) -> Array:
        """Return the acceleration of a ramp that is followed late: rising in it, then fading."""
        ramp, elapsed = self.ramp, self.rows["elapsed"].to_numpy(float)
        rising = -np.expm1(-np.minimum(elapsed, ramp) / time)
        fading = np.exp(-np.maximum(elapsed - ramp, 0.0) / time)
        height = self.rows["speed"].to_numpy(float) / ramp
        return self.sign * self.begun * height * rising * fading


def _ramp_time(rows: pd.DataFrame, begun: Flags) -> Array:
    """Return how long each row's move accelerates, from speed and greatest acceleration. [s]."""
    steepest = rows["acceleration"].abs().where(begun).groupby(rows["move"]).transform("max")
    return np.asarray(rows["speed"] / np.maximum(steepest.fillna(0.0), 1.0), dtype=float)
