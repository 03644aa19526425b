r"""Starts of moves on one grid of samples, and what the torque consists of there.

Every signal is smoothed as the acceleration is, twice by the slope of a local line: a shift between
torque and acceleration is then no work of the smoothing. Positions are known at the samples only;
the smoothed value of a signal *x* is the slope of its integral along a cubic spline. Of smoothed
signals every few samples of a fast log tell all.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.gravity import known_payload, known_pose
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.robust_fit import Labels
from frictioncli.model.friction import friction_torque
from frictioncli.model.zero_load import temperature_of

LEAST_STARTS = 6
"""Least number of starts."""

MOST_STARTS = 120
"""Starts that are used, evenly spaced, of more."""

_HALF_WINDOW = 0.015
"""Half of the time over which position and velocity are differentiated. [s]"""

_INTERVAL = 0.004
"""Time between samples up to which nothing of smoothed signals is lost: of half of that frequency
smoothing leaves less than a thousandth. [s]"""

_WHOLE = 0.02
"""Share of a sampling period by which a number of them may miss that time."""

_ONSET = 0.04
"""Time after the start of a move in which friction builds up as no model knows. [s]"""

_SLOWEST = 0.5
"""Speed below which the direction of friction is uncertain. [deg/s]"""

_REGULAR = 0.02
"""Tolerated difference between sampling periods, as a share."""

_DISTANCES = (0.05, 0.3, 3.0)
"""Angles over which friction may still build up after that. [deg]"""

_SLOW_SPEED = 5.0
"""Speed over which friction at low speed may decay. [deg/s]"""

_SHORTEST_RIPPLE = 24.0
"""Shortest period of what friction may vary with along the angle. [deg]"""

_FEWEST_SAMPLES = 3
"""Samples that tell an even clock from their stamps."""

_SAME_SPEED = 0.03
"""Relative width of a speed level."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StartWindows:
    """Signals at the starts of moves, a row per start and a column per sample.

    Attributes
    ----------
    period : float
        Sampling period of the log. [s]
    stride : int
        Sampling periods from one sample to the next.
    torque : ndarray, shape (starts, samples)
        Logged torque. [N·m]
    since : ndarray, shape (logged,)
        Time since the start of the move, of all samples of the log. [s]
    moving : ndarray of bool, shape (starts, logged)
        Samples of the log with known neighbours while the joint moves.
    gravity : ndarray, shape (starts, samples)
        Torque of gravity; 0 where it is not known in the unit of the torque. [N·m]
    turned : ndarray or None, shape (starts, samples)
        Angle since the first sample, over which a load that is not known changes; None where all
        loads are known. [deg]
    friction : ndarray, shape (starts, samples)
        Friction torque of the base model with the sign of the motion. [N·m]
    inertial : tuple of ndarray, shape (starts, samples)
        Columns of torque that follow the motion at once: acceleration [deg/s²], that of each
        further payload, and gravity's where it is not known.
    frictional : tuple of ndarray, shape (starts, samples)
        Columns by which friction may differ from the base model.
    conditions : ndarray of int, shape (starts,)
        Number of the direction and speed of each start.
    """

    period: float
    stride: int
    torque: Array
    since: Array
    moving: Flags
    gravity: Array
    turned: Array | None
    friction: Array
    inertial: tuple[Array, ...]
    frictional: tuple[Array, ...]
    conditions: Labels

    @classmethod
    def of(
        cls, rows: pd.DataFrame, sign: int, problem: Problem, temperature: str
    ) -> "StartWindows | None":
        """Return the windows of a problem's starts; None where there are too few.

        Parameters
        ----------
        rows : DataFrame
            Rows of :data:`frictioncli.schemas.STARTS` of one joint.
        sign : int
            Sign convention of the log.
        problem : Problem
            Problem with the base model.
        temperature : {"motor", "housing", "mean"}
            Temperature that the friction function is given.
        """
        rows = rows[rows["run"].isin(problem.runs)]
        step = rows.groupby("move", sort=False)["since"].agg(lambda since: since.diff().median())
        period = float(step.median()) if len(step) else np.nan
        regular = step.index[np.abs(step - period) < _REGULAR * period]
        regular = regular[:: max(-(-len(regular) // MOST_STARTS), 1)]
        if len(regular) < LEAST_STARTS:
            return None
        rows = rows[rows["move"].isin(regular)]
        return _assembled(_Grid.of(rows, period), sign, problem, temperature)

    def weights(self, delay: float) -> Array:
        """Return square roots of the weights of the samples, shape (starts, samples) [-].

        A sample has the share of the log about it that the model describes: where that begins, most
        of the misfit is.

        Parameters
        ----------
        delay : float
            Time by which the torque is late: friction builds up as much later in the log. [s]
        """
        from scipy.ndimage import correlate1d  # slow to import, and only needed with ramps

        described = self.moving & (self.since > _ONSET + max(delay, 0.0))
        # sampling periods nearer to this sample than to the next one; half of that halfway
        near = np.ones(2 * (self.stride // 2) + 1)
        near[[0, -1]] = 1.0 if self.stride % 2 else 0.5
        share = correlate1d(described.astype(float), near / self.stride, axis=1, mode="constant")
        return np.sqrt(share[:, _standing_for_all(self.since, self.stride)])


@dataclass(frozen=True, slots=True)
class _Grid:
    """Samples of the starts at common times since each start [s], and which are known."""

    first: pd.DataFrame
    since: Array
    position: Array
    torque: Array
    known: Flags

    @classmethod
    def of(cls, rows: pd.DataFrame, period: float) -> "_Grid":
        low, high = rows["since"].min(), rows["since"].max()
        since = period * np.arange(round(low / period), round(high / period) + 1)
        first = rows.groupby("move", sort=False).first()
        position, torque = (np.empty((len(first), len(since))) for _ in range(2))
        known = np.empty((len(first), len(since)), bool)
        moves = [one for _, one in rows.groupby("move", sort=False)]
        times = sampling_times(
            [(one["since"].to_numpy(float), one["position"].to_numpy(float)) for one in moves],
            period,
        )
        for number, (time, one) in enumerate(zip(times, moves, strict=True)):
            position[number] = np.interp(since, time, one["position"].to_numpy(float))
            torque[number] = np.interp(since, time, one["torque"].to_numpy(float))
            known[number] = (since > time[0] - period / 2) & (since < time[-1] + period / 2)
        return cls(first, since, position, torque, known)


def sampling_times(moves: Sequence[tuple[Array, Array]], period: float) -> list[Array]:
    """Return when samples were taken: as they are stamped, or evenly if motion is smoother then.

    A controller samples by its clock. A logger on a network stamps what arrives, early or late;
    with the speed that is noise of the position, and the torque would seem to be smeared by what
    removes it.

    Parameters
    ----------
    moves : sequence of (ndarray, ndarray), each of shape (samples,)
        Times [s] and positions [deg] of each move.
    period : float
        Sampling period. [s]
    """
    stamped = [time for time, _ in moves]
    even = [_evenly(time, period) for time in stamped]
    positions = [position for _, position in moves]
    rough, smooth = (
        sum(_roughness(time, position) for time, position in zip(times, positions, strict=True))
        for times in (stamped, even)
    )
    return even if smooth < rough else stamped


def _evenly(time: Array, period: float) -> Array:
    """Return the times of an even clock for samples of which some may be missing [s]."""
    if len(time) < _FEWEST_SAMPLES:
        return time
    number = np.append(0.0, np.cumsum(np.maximum(np.round(np.diff(time) / period), 1.0)))
    slope, start = np.polyfit(number, time, 1)
    return np.asarray(start + slope * number)


def _roughness(time: Array, position: Array) -> float:
    """Return the sum of squares by which positions miss the chord of their neighbours [deg²]."""
    width = np.maximum(time[2:] - time[:-2], np.finfo(float).tiny)
    share = (time[1:-1] - time[:-2]) / width
    chord = (1 - share) * position[:-2] + share * position[2:]
    return float(np.sum(np.square(position[1:-1] - chord)))


def _assembled(grid: _Grid, sign: int, problem: Problem, temperature: str) -> StartWindows:
    """Return the windows of starts on a grid."""
    from scipy.interpolate import CubicSpline  # slow to import, and only needed with ramps

    period = float(grid.since[1] - grid.since[0])
    half = max(round(_HALF_WINDOW / period), 1)
    stride = max(int(_INTERVAL / period + _WHOLE), 1)
    velocity = _slope(grid.position, period, half)

    def smooth(values: Array, times: int) -> Array:
        for _ in range(times):
            integral = CubicSpline(grid.since, values, axis=1).antiderivative()(grid.since)
            values = _slope(integral, period, half)
        return values

    direction = grid.first["direction"].to_numpy(float)[:, np.newaxis]
    along = velocity * direction
    moving = np.where(np.abs(velocity) > _SLOWEST, np.sign(velocity), 0.0)
    mass = np.nan_to_num(known_payload(grid.first))
    known_temperature = np.nan_to_num(temperature_of(grid.first, temperature).to_numpy(float))
    gravity = _gravity(grid, mass, problem)
    friction = moving * friction_torque(
        problem.parameters,
        load=0.0 * gravity if problem.has_load_channel else gravity,
        speed=np.abs(velocity),
        temperature=np.repeat(known_temperature[:, np.newaxis], len(grid.since), axis=1),
    )
    travelled = period * np.cumsum(np.where(grid.since > 0, np.maximum(along, 0.0), 0.0), axis=1)
    acceleration = _slope(velocity, period, half)
    inertial = [acceleration]
    inertial += [acceleration * (mass == one)[:, np.newaxis] for one in np.unique(mass)[1:]]
    if problem.has_load_channel:
        angle = np.radians(grid.position)
        inertial += [smooth(values, 2) for values in (np.cos(angle), np.sin(angle))]
        gravity = np.zeros_like(gravity)
    built_up = [moving * np.exp(-travelled / distance) for distance in _DISTANCES]
    slow = moving * np.exp(-np.abs(velocity) / _SLOW_SPEED)
    ends = np.cumsum(grid.known[:, ::-1], axis=1)[:, ::-1]
    level = np.round(np.log(grid.first["speed"].to_numpy(float)) / _SAME_SPEED)
    conditions = pd.MultiIndex.from_arrays([level, direction[:, 0]])
    chosen = _standing_for_all(grid.since, stride)

    def smoothed(values: Array, times: int) -> Array:
        return smooth(values, times)[:, chosen]

    return StartWindows(
        period=period,
        stride=stride,
        torque=smoothed(grid.torque, 2),
        since=grid.since,
        moving=(grid.since > 0) & (along > _SLOWEST) & (ends > 2 * half + 2),
        gravity=smoothed(gravity, 2),
        turned=smoothed(grid.position - grid.position[:, :1], 2),
        friction=sign * smoothed(friction, 1),
        inertial=tuple(one[:, chosen] for one in inertial),
        frictional=tuple(
            smoothed(one, 1)
            for one in (*built_up, slow, moving * np.abs(velocity), *_along_angle(grid, moving))
        ),
        conditions=pd.factorize(conditions)[0],
    )


def _standing_for_all(since: Array, stride: int) -> slice:
    """Return which samples stand for all: one in each stride, that of the start among them."""
    return slice(int(np.argmin(np.abs(since))) % stride, None, stride)


def _along_angle(grid: _Grid, moving: Array) -> list[Array]:
    """Return friction that varies with the angle, as a sum of cosines, columns of each [-]."""
    low, high = np.min(grid.position[grid.known]), np.max(grid.position[grid.known])
    if high - low <= 0:
        return []
    way = np.pi * (grid.position - low) / (high - low)
    count = int(2 * (high - low) / _SHORTEST_RIPPLE)
    return [moving * np.cos(number * way) for number in range(1, count + 1)]


def _gravity(grid: _Grid, mass: Array, problem: Problem) -> Array:
    """Return the torque of gravity, shape (starts, samples) [N·m]."""
    samples = grid.position.shape[1]
    columns = problem.gravity_form.columns_at(
        grid.position.ravel(),
        np.repeat(mass, samples),
        np.repeat(known_pose(grid.first), samples),
    )
    return np.asarray(columns @ problem.gravity).reshape(grid.position.shape)


def _slope(values: Array, period: float, half: int) -> Array:
    """Return the slope of local lines along the samples, shape (starts, samples)."""
    from scipy.ndimage import correlate1d  # slow to import, and only needed with ramps

    steps = np.arange(-half, half + 1)
    return correlate1d(values, steps / (period * np.sum(np.square(steps))), axis=1, mode="nearest")
