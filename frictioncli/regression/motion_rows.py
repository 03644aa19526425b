"""Filtered rows of a joint's motion: what is left of samples, a few numbers every 0.05 s.

The rows of a recording follow each other without overlap of what their averages weigh most, so that
white noise stays white. Only samples inside a move have rows: near a start, stop or reversal the
joint sticks, and no law of the speed holds.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Array, Flags, Indices, Numbers
from frictioncli.pairs.chunks import SampleChunk, chunks
from frictioncli.pairs.settings import SteadySettings
from frictioncli.regression.even_samples import even_samples, later, position_jumps, row_centres
from frictioncli.regression.filters import STEP_TIMES, filter_step, filtered, matched_filters

STANDING = "standing"
NEAR_TURN = "near a start, stop or reversal"
JUMP = "position jumps"

_CHANNELS = (
    "position",
    "torque",
    "motor_temperature",
    "housing_temperature",
    "motor_temperature_reading",
    "load",
    "other_speed",
    "pose",
    "payload",
)

_FOURTH = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
"""Fourth difference, in which smooth motion leaves next to nothing."""

_LEAST_NOISE = 20
"""Least rows of a chunk from which noise is estimated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionRows:
    """Averages of the motion of one joint, each over about 0.05 s within one move.

    Attributes
    ----------
    run, recording : ndarray of int, shape (rows,)
        Numbers of the run and the recording.
    move : ndarray of int, shape (rows,)
        Number of the move, growing.
    number : ndarray of int, shape (rows,)
        Place in the recording; rows that follow each other differ by one.
    samples : ndarray of int, shape (rows,)
        Samples that a row stands for.
    time, position : ndarray, shape (rows,)
        Time since the run's first sample, and angle. [s], [deg]
    velocity, position_slope : ndarray, shape (rows,)
        Velocity as logged, and that of the position. [deg/s]
    acceleration, velocity_slope : ndarray, shape (rows,)
        Second derivative of the position, and first one of the logged velocity. [deg/s²]
    jerk, velocity_curvature : ndarray, shape (rows,)
        Third derivative of the position, and second one of the logged velocity. [deg/s³]
    travel : ndarray, shape (rows,)
        Way since the move began. [deg]
    torque, load : ndarray, shape (rows,)
        Torque, and that of a load channel, NaN without. [torque unit], [N·m]
    motor_temperature, housing_temperature, motor_temperature_reading : ndarray, shape (rows,)
        Temperatures, NaN where unknown. [°C]
    other_speed : ndarray, shape (rows,)
        Speed of the fastest other joint, NaN where unknown. [deg/s]
    pose : ndarray, shape (rows,)
        Number of the pose of the other joints, NaN while one moves or where unknown.
    payload : ndarray, shape (rows,)
        Payload of the motion, NaN where only that of the recording may be known. [kg]
    variance : ndarray, shape (rows,)
        Variance of the weights of the averages. [s²]
    """

    run: Numbers
    recording: Numbers
    move: Numbers
    number: Numbers
    samples: Numbers
    time: Array
    position: Array
    velocity: Array
    position_slope: Array
    acceleration: Array
    velocity_slope: Array
    jerk: Array
    velocity_curvature: Array
    travel: Array
    torque: Array
    load: Array
    motor_temperature: Array
    housing_temperature: Array
    motor_temperature_reading: Array
    other_speed: Array
    pose: Array
    payload: Array
    variance: Array

    def __len__(self) -> int:
        return len(self.time)

    def where(self, kept: Flags) -> "MotionRows":
        """Return the rows that are kept.

        Parameters
        ----------
        kept : ndarray of bool, shape (rows,)
            Whether each is kept.
        """
        return MotionRows(**{one.name: getattr(self, one.name)[kept] for one in fields(self)})


@dataclass(slots=True)
class MotionLog:
    """Rows of a joint while they are gathered, and the samples without rows.

    Attributes
    ----------
    runs : list of str
        Names of the runs, by number.
    recordings : list of (str, str)
        Run and recording, by number.
    samples : int
        Samples read.
    dropped : dict of str to int
        Samples without rows by reason.
    step : int
        Width of the filter's triangles. [samples]
    period : float
        Sampling period. [s]
    step_time : float
        Width of the filter's triangles that was asked for. [s]
    known_delay : float
        Delay of the torque that the rows are free of: their torque is that of so much later. [s]
    """

    runs: list[str] = field(default_factory=list)
    recordings: list[tuple[str, str]] = field(default_factory=list)
    samples: int = 0
    dropped: dict[str, int] = field(default_factory=dict)
    step: int = 0
    period: float = 0.0
    step_time: float = STEP_TIMES[0]
    known_delay: float = 0.0
    moves: int = 0
    parts: list[dict[str, np.ndarray]] = field(default_factory=list)
    noises: list[tuple[float, float]] = field(default_factory=list)

    @property
    def noise(self) -> tuple[float, float]:
        """White noise of the positions and of the logged velocities [deg], [deg/s]."""
        position, velocity = np.median(self.noises, axis=0).tolist() if self.noises else (0.0, 0.0)
        return position, velocity

    def drop(self, reason: str, samples: int) -> None:
        """Count samples without rows."""
        self.dropped[reason] = self.dropped.get(reason, 0) + samples

    def rows(self) -> MotionRows:
        """Return all rows, in the order of runs, recordings and time."""
        names = [one.name for one in fields(MotionRows)]
        parts = self.parts or [{name: np.empty(0) for name in names}]
        if len(parts) > 1:
            # one column after the other, so that hardly more than one is held twice
            whole = {name: np.concatenate([part.pop(name) for part in parts]) for name in names}
            parts = self.parts = [whole]
        columns: dict[str, Any] = parts[0]
        return MotionRows(**columns)


def motion_rows(
    batches: Iterable[pa.RecordBatch],
    settings: SteadySettings | None = None,
    step_time: float = STEP_TIMES[0],
    delays: Mapping[int, float] | None = None,
) -> dict[int, MotionLog]:
    """Return the filtered rows of the motion of each joint.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`, ordered as ``ingest`` writes them.
    settings : SteadySettings, optional
        ``min_speed`` decides what is standing.
    step_time : float
        Width of the filter's triangles, at least one sampling period. [s]
    delays : mapping of int to float, optional
        Delay of the torque by joint, which is taken out of the rows; other joints then have none.
        [s]

    Returns
    -------
    dict of int to MotionLog
        Motion by joint.

    Raises
    ------
    TableError
        If a required channel has values that are no numbers.
    """
    found: dict[int, MotionLog] = {}
    for chunk in chunks(batches, _CHANNELS, settings or SteadySettings()):
        joint = chunk.source.joint
        if delays is not None and joint not in delays:
            continue
        if joint not in found:
            delay = 0.0 if delays is None else delays[joint]
            found[joint] = MotionLog(step_time=step_time, known_delay=delay)
        _add(found[joint], chunk)
    return dict(sorted(found.items()))


def _add(motion: MotionLog, chunk: SampleChunk) -> None:
    """Add the rows of a chunk of samples."""
    source = chunk.source
    if source.run not in motion.runs:
        motion.runs.append(source.run)
    if (source.run, source.recording) not in motion.recordings:
        motion.recordings.append((source.run, source.recording))
    motion.samples += chunk.end - chunk.begin
    motion.drop(STANDING, chunk.standing)
    if not len(chunk.move_start):
        return
    grid = even_samples(chunk)
    filters = matched_filters(filter_step(grid.period, motion.step_time), grid.period)
    motion.step, motion.period = filters.step, grid.period
    spacing = 2 * filters.step
    centre, move = row_centres(grid, filters.half, spacing)
    moving = int(np.sum(chunk.move_stop - chunk.move_start))
    broken = position_jumps(grid, centre, filters.half)
    samples = grid.samples(centre, spacing)
    motion.drop(JUMP, int(samples[broken].sum()))
    motion.drop(NEAR_TURN, moving - int(samples.sum()))
    centre, move, samples = centre[~broken], move[~broken], samples[~broken]
    of = grid.channels
    position = filtered(
        of["position"], centre, filters.mean, filters.slope, filters.curvature, filters.jerk
    )
    velocity = filtered(of["velocity"], centre, filters.mean, filters.slope, filters.curvature)
    begin = of["position"][grid.start[move]]
    motion.noises += _noises(of, centre)
    # a measured load belongs to the torque beside it
    torque, load = (
        filtered(
            later(of[name], motion.known_delay / grid.period) if motion.known_delay else of[name],
            centre,
            filters.mean,
        )[0]
        for name in ("torque", "load")
    )
    offset = np.arange(-filters.half, filters.half + 1) * grid.period
    ones = np.ones(len(centre), dtype=np.int64)
    motion.parts.append(
        {
            "run": ones * motion.runs.index(source.run),
            "recording": ones * (len(motion.recordings) - 1),
            "move": motion.moves + move,
            "number": (grid.number[centre] // spacing).astype(np.int64),
            "samples": samples,
            "time": of["time"][centre],
            "position": position[0],
            "velocity": velocity[0],
            "position_slope": position[1],
            "acceleration": position[2],
            "velocity_slope": velocity[1],
            "jerk": position[3],
            "velocity_curvature": velocity[2],
            "travel": np.abs(position[0] - begin),
            "torque": torque,
            "load": load,
            "variance": np.full(len(centre), float(filters.mean @ offset**2)),
            **{
                name: of[name][centre]
                for name in (
                    "motor_temperature",
                    "housing_temperature",
                    "motor_temperature_reading",
                    "other_speed",
                    "pose",
                    "payload",
                )
            },
        }
    )
    motion.moves += len(chunk.move_start)


def _noises(channels: Mapping[str, Array], centre: Indices) -> list[tuple[float, float]]:
    """Return the white noise of position and velocity from their fourth differences."""
    if len(centre) < _LEAST_NOISE:
        return []
    scale = 0.6745 * float(np.linalg.norm(_FOURTH))
    found = [
        float(np.median(np.abs(filtered(channels[name], centre, _FOURTH)))) / scale
        for name in ("position", "velocity")
    ]
    return [(found[0], found[1])]
