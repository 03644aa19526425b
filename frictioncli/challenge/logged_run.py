"""One run of a joint as it was logged: samples in order of time, strokes and reversals."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.logs.runs.run_order import runs_in_order


@dataclass(frozen=True, slots=True, kw_only=True)
class LoggedRun:
    """Samples of a joint in one run, in order of time.

    Attributes
    ----------
    name : str
        The run.
    rows : ndarray of int, shape (samples,)
        Rows of the table that the samples came from.
    recording : ndarray of int, shape (samples,)
        Number of each sample's recording.
    time : ndarray, shape (samples,)
        Time since the run's first sample. [s]
    position, velocity, acceleration : ndarray, shape (samples,)
        Motion; the acceleration is the slope of the velocity. [deg], [deg/s], [deg/s²]
    torque : ndarray, shape (samples,)
        Logged torque. [torque unit]
    motor : ndarray, shape (samples,)
        Motor temperature; NaN where not logged. [°C]
    load : ndarray, shape (samples,)
        Load channel of the log; NaN without one. [N·m]
    """

    name: str
    rows: Indices
    recording: Indices
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    torque: Array
    motor: Array
    load: Array


def logged_runs(samples: pd.DataFrame) -> list[LoggedRun]:
    """Return the runs of a joint in order, the one that the diagnosis holds out last.

    Parameters
    ----------
    samples : DataFrame
        Rows of :data:`frictioncli.schemas.SAMPLES` of a single joint, numbered from 0.
    """
    by_run = samples.groupby("run", observed=True)
    return [_logged_run(name, by_run.get_group(name)) for name in runs_in_order(samples)]


def _logged_run(name: str, rows: pd.DataFrame) -> LoggedRun:
    rows = rows.sort_values("time", kind="stable")
    time, velocity = rows["time"].to_numpy(float), rows["velocity"].to_numpy(float)
    recording = pd.factorize(rows["recording"])[0]
    return LoggedRun(
        name=name,
        rows=rows.index.to_numpy(),
        recording=recording,
        time=time,
        position=rows["position"].to_numpy(float),
        velocity=velocity,
        acceleration=_slope(velocity, time, recording),
        torque=rows["torque"].to_numpy(float),
        motor=rows["motor_temperature"].to_numpy(float),
        load=rows["load"].to_numpy(float),
    )


def recordings(recording: Indices) -> Iterator[slice]:
    """Yield the slices of consecutive samples of one recording."""
    edges = np.flatnonzero(np.diff(recording)) + 1
    for begin, end in zip([0, *edges], [*edges, len(recording)], strict=True):
        yield slice(int(begin), int(end))


def _slope(value: Array, time: Array, recording: Indices) -> Array:
    """Return the derivative by time, recording by recording; 0 in those of a single sample."""
    slope = np.zeros(len(value))
    for part in recordings(recording):
        steps = np.diff(time[part])
        if len(steps) and np.all(steps > 0):
            slope[part] = np.gradient(value[part], time[part])
    return slope


@dataclass(frozen=True, slots=True, kw_only=True)
class Strokes:
    """Where a joint is in its stroke.

    Attributes
    ----------
    since_start : ndarray, shape (samples,)
        Time since the stroke began. [s]
    since_turn : ndarray, shape (samples,)
        Angle turned since the last reversal. [deg]
    """

    since_start: Array
    since_turn: Array


def strokes_of(run: LoggedRun, standing: float) -> Strokes:
    """Return how far each sample is from the start of its stroke and from the last reversal.

    A stroke begins where the joint starts to move, a reversal where it moves the other way than
    before; the first motion of a recording counts as both, as the log does not know what was
    before.

    Parameters
    ----------
    run : LoggedRun
        The run.
    standing : float
        Speed below which the joint stands. [deg/s]
    """
    sign = np.where(np.abs(run.velocity) > standing, np.sign(run.velocity), 0.0)
    fresh = np.concatenate([[True], np.diff(run.recording) != 0])
    starts = (sign != 0) & (fresh | (sign != np.concatenate([[0.0], sign[:-1]])))
    begin = _last(starts | fresh)
    way = sign[_last((sign != 0) | fresh)]
    turns = (way != np.concatenate([[0.0], way[:-1]])) | fresh
    turn = _last(turns)
    return Strokes(
        since_start=run.time - run.time[begin],
        since_turn=np.abs(run.position - run.position[turn]),
    )


def _last(marks: Flags) -> Indices:
    """Return the number of the last marked sample up to each; the first one is marked."""
    return np.asarray(np.maximum.accumulate(np.where(marks, np.arange(len(marks)), 0)))
