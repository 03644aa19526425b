"""One log read to its end: samples in order of time, and a summary of the recording."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.log_source import Refusal, UnreadableLog
from frictioncli.logs.runs.opening import OpenedLog
from frictioncli.logs.runs.sidecar import parts_of
from frictioncli.logs.samples.chunks import LogChunk, PlannedLog
from frictioncli.logs.samples.differentiation import half_window, max_gap
from frictioncli.logs.samples.log_rows import NO_VALUES, REASONS, LogRows, RejectedRows
from frictioncli.logs.samples.other_joints import with_other_joints
from frictioncli.logs.samples.poses import Poses
from frictioncli.logs.samples.quantized_temperature import longest_change_interval
from frictioncli.logs.samples.row_checks import (
    add_velocity,
    drop_non_increasing_time,
    drop_stale_first_rows,
)
from frictioncli.logs.samples.temperature_register import TemperatureRegister

_EXAMPLE_BYTES = 1 << 16
_MIN_ROWS = 3
_SHORTEST_PERIOD = 1e-6
"""No controller samples faster. [s]"""

_NO_REGISTERS: Mapping[int, TemperatureRegister] = {}
_NO_COUNTS: Mapping[str, int] = {}
"""Shared by all recordings that have none: there may be 100,000."""

SampleSink = Callable[[LogRows, Array], None]
"""Takes samples of all joints, and their times since the recording's first sample [s]."""


@dataclass(frozen=True, slots=True)
class RecordingSummary:
    """Summary of a log that was read to its end.

    Attributes
    ----------
    planned : PlannedLog
        The log.
    registers : mapping of int to TemperatureRegister
        Joint -> its motor temperature register; none where there are no readings.
    rows_read, rows_kept : int
        Rows of the file, and those that became samples.
    rejected : mapping of str to int
        Reason -> number of rejected rows.
    duration : float
        Time from the first sample to the last. [s]
    """

    planned: PlannedLog
    registers: Mapping[int, TemperatureRegister]
    rows_read: int
    rows_kept: int
    rejected: Mapping[str, int]
    duration: float

    @property
    def log(self) -> OpenedLog:
        """The log."""
        return self.planned.log

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints that were read."""
        return tuple(plan.channels.joint for plan in self.planned.plans)


def read_recording(
    planned: PlannedLog,
    chunks: Iterable[LogChunk],
    rejected: RejectedRows,
    sink: SampleSink,
    continuous: Collection[int] = (),
    poses: Poses | None = None,
    payloads: Sequence[tuple[float, float]] = (),
) -> RecordingSummary | Refusal:
    """Hand all samples of a log to a sink.

    Parameters
    ----------
    planned : PlannedLog
        The log.
    chunks : iterable of LogChunk
        Its rows.
    rejected : RejectedRows
        Takes the lines that are rejected.
    sink : callable
        Takes the samples.
    continuous : collection of int
        Joints whose motor temperature is known to be continuous, not quantized.
    poses : Poses, optional
        Poses of the recordings before; new ones are added.
    payloads : sequence of (float, float)
        Start [s] of each motion by the clock of the log, and payload [kg] from then on.

    Returns
    -------
    RecordingSummary or Refusal
        A refusal with the reason ``too_few_rows`` or ``unreadable_file``, or with the most frequent
        reason where more rows are rejected than kept. Samples that went to the sink are then void.

    Raises
    ------
    LogError
        If positions contradict the unit that the survey found.
    """
    rows_read = 0

    def counted() -> Iterator[LogChunk]:
        nonlocal rows_read
        for chunk in chunks:
            rows_read += chunk.rows_read
            yield chunk
            if rejected.are_hopeless(rows_read):
                return

    joints = [plan.channels.joint for plan in planned.plans]
    registers = {
        plan.channels.joint: TemperatureRegister(continuous=plan.channels.joint in continuous)
        for plan in planned.plans
        if names.MOTOR_TEMPERATURE in plan.conversions
    }
    longest = longest_change_interval(planned.period)
    kept, first, time = 0, 0.0, np.zeros(1)
    try:
        for rows in _usable_rows(planned, counted(), rejected, poses):
            first = first if kept else float(rows.time[0])
            kept += len(rows)
            time = rows.time - first if first else rows.time
            for joint, register in registers.items():
                reading = rows.columns.get((joint, names.MOTOR_TEMPERATURE))
                if reading is not None:
                    register.update(time, reading, longest)
            sink(_with_payloads(rows, joints, payloads), time)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))
    counts = rejected.counts()
    refusal = _refusal(planned, rows_read, kept, counts, rejected, float(time[-1]))
    return refusal or RecordingSummary(
        planned, registers or _NO_REGISTERS, rows_read, kept, counts or _NO_COUNTS, float(time[-1])
    )


def _usable_rows(
    planned: PlannedLog,
    chunks: Iterable[LogChunk],
    rejected: RejectedRows,
    poses: Poses | None,
) -> Iterator[LogRows]:
    """Yield the rows that become samples, with all channels, in ascending time."""

    def blocks() -> Iterator[LogRows]:
        for chunk in chunks:
            rejected.extend(chunk.rejected)
            yield chunk.rows

    positions = [(plan.channels.joint, names.POSITION) for plan in planned.plans]
    derived = {
        (plan.channels.joint, names.VELOCITY): (plan.channels.joint, names.POSITION)
        for plan in planned.plans
        if names.VELOCITY not in plan.conversions
    }
    increasing = drop_non_increasing_time(blocks(), rejected)
    started = drop_stale_first_rows(increasing, positions, rejected)
    half, gap = half_window(planned.period), max_gap(planned.period)
    moving = add_velocity(started, derived, rejected, half=half, gap=gap)
    joints = [plan.channels.joint for plan in planned.plans]
    for rows in with_other_joints(moving, joints, poses):
        if len(rows):
            yield rows


def _with_payloads(
    rows: LogRows, joints: Sequence[int], payloads: Sequence[tuple[float, float]]
) -> LogRows:
    """Return rows with the payload of the motion that ran; before the first, that of the first."""
    if not payloads:
        return rows
    start, mass = np.array(payloads).T
    carried = mass[np.maximum(np.searchsorted(start, rows.time, side="right") - 1, 0)]
    added = {(joint, names.PAYLOAD): carried for joint in joints}
    return LogRows(rows.lines, rows.time, {**rows.columns, **added})


def _tells(part: object) -> bool:
    """Return whether a source tells which cell of a row is damaged."""
    return hasattr(part, "fault")


def _refusal(
    planned: PlannedLog,
    rows_read: int,
    kept: int,
    counts: dict[str, int],
    rejected: RejectedRows,
    duration: float,
) -> Refusal | None:
    """Return why a log cannot be used as a whole; None where it can."""
    counts = {reason: n for reason, n in counts.items() if reason != NO_VALUES}
    n_rejected = sum(counts.values())
    if n_rejected > kept:
        reason = max(counts, key=lambda name: (counts[name], -REASONS.index(name)))
        source = planned.log.source
        line, text = next(iter(source.texts(rejected.first_line(reason), _EXAMPLE_BYTES)))
        faults = (part.fault(text, planned.columns) for part in parts_of(source) if _tells(part))
        fault = next((f": {fault}" for fault in faults if fault), "")
        return Refusal(
            reason,
            f"{n_rejected} of {rows_read} rows cannot be used, mostly {reason}, for example line"
            f" {line}: {text}{fault}",
        )
    if kept >= _MIN_ROWS and duration < _SHORTEST_PERIOD * (kept - 1):
        return Refusal(
            "implausible_time",
            f"{kept} rows within {duration:.3g} s; expected at most one per"
            f" {_SHORTEST_PERIOD * 1e6:g} µs; give the unit of the time with --time-unit",
        )
    if kept < _MIN_ROWS:
        return Refusal("too_few_rows", f"{kept} usable rows; expected at least {_MIN_ROWS}")
    return None
