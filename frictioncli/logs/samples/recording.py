"""A log read to its end: usable rows in order, rejected lines, what was seen on the way."""

from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.log_source import Refusal, UnreadableLog
from frictioncli.logs.runs.opening import OpenedLog
from frictioncli.logs.samples import quantized_temperature
from frictioncli.logs.samples.chunks import Chunk, PlannedLog
from frictioncli.logs.samples.differentiation import half_window, max_gap
from frictioncli.logs.samples.row_checks import (
    EMPTY,
    REASONS,
    LogRows,
    RejectedRows,
    ascending,
    drop_stale_first_rows,
    with_velocity,
)
from frictioncli.logs.samples.temperature_register import TemperatureRegister

_EXAMPLE_BYTES = 1 << 16
_MIN_ROWS = 3


@dataclass(frozen=True, slots=True)
class RecordingSummary:
    """A log that was read to its end.

    Attributes
    ----------
    reading : PlannedLog
        Which, and how.
    registers : dict of int to TemperatureRegister
        Joint -> what its temperature register showed.
    rows_read, rows_kept : int
        Rows of the file.
    rejected : dict of str to int
        Reason -> rows that were not kept.
    duration : float
        Last sample's time from the first. [s]
    """

    reading: PlannedLog
    registers: dict[int, TemperatureRegister]
    rows_read: int
    rows_kept: int
    rejected: dict[str, int]
    duration: float

    @property
    def log(self) -> OpenedLog:
        """The log."""
        return self.reading.log

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints that were read."""
        return tuple(self.registers)


def usable_rows(
    reading: PlannedLog, parts: Iterable[Chunk], faults: RejectedRows
) -> Iterator[LogRows]:
    """Yield the rows that become samples, all channels present, in ascending time.

    Parameters
    ----------
    reading : PlannedLog
        The log.
    parts : iterable of Chunk
        Its rows.
    faults : RejectedRows
        Takes the lines of all others.
    """

    def blocks() -> Iterator[LogRows]:
        for part in parts:
            faults.extend(part.faults)
            yield part.block

    positions = [(plan.channels.joint, names.POSITION) for plan in reading.plans]
    derived = {
        (plan.channels.joint, names.VELOCITY): (plan.channels.joint, names.POSITION)
        for plan in reading.plans
        if names.VELOCITY not in plan.conversions
    }
    growing = drop_stale_first_rows(ascending(blocks(), faults), positions, faults)
    half, gap = half_window(reading.period), max_gap(reading.period)
    for block in with_velocity(growing, derived, faults, half=half, gap=gap):
        if len(block):
            yield block


Sink = Callable[[LogRows, Array], None]
"""Takes samples of all joints, and their times from the recording's first sample [s]."""


def record(
    reading: PlannedLog,
    parts: Iterable[Chunk],
    faults: RejectedRows,
    sink: Sink,
    smooth: Collection[int] = (),
) -> RecordingSummary | Refusal:
    """Hand all samples of a log to ``sink``.

    Parameters
    ----------
    reading : PlannedLog
        The log.
    parts : iterable of Chunk
        Its rows.
    faults : RejectedRows
        Takes the lines that are rejected.
    sink : callable
        Takes the samples.
    smooth : collection of int
        Joints whose temperature is known not to come from a register of steps.

    Returns
    -------
    RecordingSummary or Refusal
        ``too_few_rows``, ``unreadable_file``, or the most frequent reason when more than half
        of the rows are bad. Samples that went to the sink are then void.

    Raises
    ------
    LogError
        If positions contradict the unit that the survey found.
    """
    rows = 0

    def counted() -> Iterator[Chunk]:
        nonlocal rows
        for part in parts:
            rows += part.rows
            yield part

    joints = [plan.channels.joint for plan in reading.plans]
    registers = {joint: TemperatureRegister(smooth=joint in smooth) for joint in joints}
    wait = quantized_temperature.longest_change_interval(reading.period)
    kept, begin, time = 0, 0.0, np.zeros(1)
    try:
        for block in usable_rows(reading, counted(), faults):
            begin = begin if kept else float(block.time[0])
            kept += len(block)
            time = block.time - begin if begin else block.time
            for joint, register in registers.items():
                shown = block.columns.get((joint, names.MOTOR_TEMPERATURE))
                if shown is not None:
                    register.see(time, shown, wait)
            sink(block, time)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))
    counts = faults.counts()
    refusal = _refusal(reading.log, rows, kept, counts, faults)
    return refusal or RecordingSummary(reading, registers, rows, kept, counts, float(time[-1]))


def _refusal(
    log: OpenedLog, rows: int, kept: int, counts: dict[str, int], faults: RejectedRows
) -> Refusal | None:
    counts = {reason: n for reason, n in counts.items() if reason != EMPTY}
    rejected = sum(counts.values())
    if rejected > kept:
        reason = max(counts, key=lambda name: (counts[name], -REASONS.index(name)))
        line, text = next(iter(log.source.texts(faults.first(reason), _EXAMPLE_BYTES)))
        return Refusal(
            reason,
            f"{rejected} of {rows} rows cannot be used, mostly {reason}, for example line"
            f" {line}: {text}",
        )
    if kept < _MIN_ROWS:
        return Refusal("too_few_rows", f"{kept} usable rows; expected at least {_MIN_ROWS}")
    return None
