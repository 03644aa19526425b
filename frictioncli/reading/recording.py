"""Read one log to its end: samples per joint to spool files, rejected lines, what was seen."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.errors import LogError
from frictioncli.reading import aliases as names
from frictioncli.reading import staircase
from frictioncli.reading.beliefs import JointPlan
from frictioncli.reading.channels import Channel
from frictioncli.reading.derivative import half_window, max_gap
from frictioncli.reading.formats.base import RawBatch, Refusal
from frictioncli.reading.formats.encoding import UnreadableLog
from frictioncli.reading.opening import OpenedLog
from frictioncli.reading.register import Register
from frictioncli.reading.rows import (
    REASONS,
    Block,
    Faults,
    ascending,
    with_values,
    with_velocity,
    without_stale_start,
)
from frictioncli.reading.units import plausible_temperature

SPOOLED = (
    names.TIME,
    names.POSITION,
    names.VELOCITY,
    names.TORQUE,
    names.MOTOR_TEMPERATURE,
    names.HOUSING_TEMPERATURE,
    names.LOAD,
)
_SPOOL_SCHEMA = pa.schema([(name, pa.float64()) for name in SPOOLED])
_PERIOD_BYTES = 1 << 16
_MIN_ROWS = 3
_BEYOND = 3
_BEYOND_SHARE = 0.01


@dataclass(frozen=True, slots=True)
class Recorded:
    """A log that was read to its end.

    Attributes
    ----------
    log : OpenedLog
        Which.
    plans : tuple of JointPlan
        How.
    spools : dict of int to Path
        Joint -> Arrow file of its samples, time from the first sample.
    registers : dict of int to Register
        Joint -> what its temperature register showed.
    rows_read, rows_kept : int
        Rows of the file.
    rejected : tuple of ndarray
        Lines and indices into ``REASONS``.
    begin : float
        The file's own time at its first sample. [s]
    duration, period : float
        Last sample's time from the first, median time between samples. [s]
    """

    log: OpenedLog
    plans: tuple[JointPlan, ...]
    spools: dict[int, Path]
    registers: dict[int, Register]
    rows_read: int
    rows_kept: int
    rejected: tuple[NDArray[np.int64], NDArray[np.int8]]
    begin: float
    duration: float
    period: float


def read_recording(
    log: OpenedLog, plans: Sequence[JointPlan], stem: Path, batch_bytes: int
) -> Recorded | Refusal:
    """Stream a log into one spool file per joint.

    Parameters
    ----------
    log : OpenedLog
        The log.
    plans : sequence of JointPlan
        How to read each of its joints.
    stem : Path
        Beginning of the names of the spool files.
    batch_bytes : int
        How much of the log to hold at a time. [byte]

    Returns
    -------
    Recorded or Refusal
        ``too_few_rows``, ``unreadable_file``, or the most frequent reason when more than half
        of the rows are bad.

    Raises
    ------
    LogError
        If positions contradict the unit that the survey found.
    """
    try:
        return _read(log, plans, stem, batch_bytes)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))


def _read(
    log: OpenedLog, plans: Sequence[JointPlan], stem: Path, batch_bytes: int
) -> Recorded | Refusal:
    period = _period(log, plans)
    faults = Faults()
    counted = [0]
    blocks = _blocks(log, plans, faults, counted, batch_bytes)
    required = [
        (plan.channels.joint, name)
        for plan in plans
        for name in (names.POSITION, names.TORQUE, names.VELOCITY)
        if name in plan.beliefs
    ]
    positions = [(plan.channels.joint, names.POSITION) for plan in plans]
    derived = {
        (plan.channels.joint, names.VELOCITY): (plan.channels.joint, names.POSITION)
        for plan in plans
        if names.VELOCITY not in plan.beliefs
    }
    blocks = with_values(blocks, required, faults)
    blocks = ascending(blocks, faults)
    blocks = without_stale_start(blocks, positions, faults)
    half, gap = half_window(period), max_gap(period)
    blocks = with_velocity(blocks, derived, faults, half=half, gap=gap)
    spools = {joint: Path(f"{stem}-{joint}.arrow") for joint in (p.channels.joint for p in plans)}
    registers = {joint: Register() for joint in spools}
    kept, begin, end = _spool(blocks, spools, registers, staircase.longest_wait(period))
    lines, codes = faults.ascending()
    refusal = _refusal(log, counted[0], kept, lines, codes)
    if refusal is not None:
        for spool in spools.values():
            spool.unlink()
        return refusal
    return Recorded(
        log,
        tuple(plans),
        spools,
        registers,
        counted[0],
        kept,
        (lines, codes),
        begin,
        end - begin,
        period,
    )


def _period(log: OpenedLog, plans: Sequence[JointPlan]) -> float:
    """Return the median time [s] between the first samples; 1 where they do not tell."""
    time = plans[0].channels.time.column
    first = next(iter(log.source.batches([time], _PERIOD_BYTES)), None)
    steps = np.diff(first.values[time]) if first is not None else np.empty(0)
    steps = steps[steps > 0]
    if not len(steps):
        return 1.0
    return float(np.median(steps)) * plans[0].beliefs[names.TIME].factor


def _blocks(
    log: OpenedLog,
    plans: Sequence[JointPlan],
    faults: Faults,
    counted: list[int],
    batch_bytes: int,
) -> Iterator[Block]:
    """Yield the converted rows; unreadable ones go to the faults."""
    columns = {plans[0].channels.time.column}
    for plan in plans:
        columns.update(_column(plan, name) for name in plan.beliefs)
    for batch in log.source.batches(columns, batch_bytes):
        counted[0] += len(batch.lines) + len(batch.bad_lines)
        for reason in sorted(set(batch.bad_reasons)):
            faults.add(batch.bad_lines[np.array(batch.bad_reasons) == reason], reason)
        block = _converted(batch, plans)
        outside = np.zeros(len(block), bool)
        for plan in plans:
            if plan.position_limit is not None:
                with np.errstate(invalid="ignore"):
                    raw = batch.values[plan.channels.position.column]
                    out = np.isfinite(raw) & (np.abs(raw) > plan.position_limit)
                if out.sum() > max(_BEYOND, _BEYOND_SHARE * len(out)):
                    _contradicted(log, plan, batch, out)
                outside |= out
        faults.add(block.lines[outside], "implausible_position")
        yield block.take(~outside)


def _contradicted(log: OpenedLog, plan: JointPlan, batch: RawBatch, out: NDArray[np.bool_]) -> None:
    where = int(np.flatnonzero(out)[0])
    name = plan.channels.position.name
    value = batch.values[plan.channels.position.column][where]
    raise LogError(
        f"{log.file.path} line {batch.lines[where]}: {name} is {value:.4g}, but the beginnings of"
        f" the logs of run {log.run.name} looked like rad, which end at ±6.9; say which it is with"
        " --position-unit deg or rad"
    )


def _column(plan: JointPlan, name: str) -> int:
    channel: Channel = getattr(plan.channels, name)
    return channel.column


def _converted(batch: RawBatch, plans: Sequence[JointPlan]) -> Block:
    columns: dict[tuple[int, str], NDArray[np.float64]] = {}
    for plan in plans:
        for name, belief in plan.beliefs.items():
            values = batch.values[_column(plan, name)] * belief.factor + belief.offset
            if name in (names.MOTOR_TEMPERATURE, names.HOUSING_TEMPERATURE):
                values = plausible_temperature(values)
            columns[plan.channels.joint, name] = values
    time = columns[plans[0].channels.joint, names.TIME]
    return Block(batch.lines, time, columns)


def _spool(
    blocks: Iterator[Block],
    spools: dict[int, Path],
    registers: dict[int, Register],
    wait: float,
) -> tuple[int, float, float]:
    """Write the samples; return how many rows, and the first and last time [s]."""
    writers = {joint: pa.OSFile(str(path), "wb") for joint, path in spools.items()}
    streams = {joint: pa.ipc.new_stream(sink, _SPOOL_SCHEMA) for joint, sink in writers.items()}
    kept, begin, end = 0, 0.0, 0.0
    try:
        for block in blocks:
            if not len(block):
                continue
            begin = begin if kept else float(block.time[0])
            end = float(block.time[-1])
            kept += len(block)
            time = block.time - begin
            for joint, stream in streams.items():
                columns = {
                    name: block.columns.get((joint, name), np.full(len(block), np.nan))
                    for name in SPOOLED
                }
                columns[names.TIME] = time
                registers[joint].see(time, columns[names.MOTOR_TEMPERATURE], wait)
                stream.write_batch(pa.record_batch(list(columns.values()), schema=_SPOOL_SCHEMA))
    finally:
        for joint, stream in streams.items():
            stream.close()
            writers[joint].close()
    return kept, begin, end


def _refusal(
    log: OpenedLog,
    read: int,
    kept: int,
    lines: NDArray[np.int64],
    codes: NDArray[np.int8],
) -> Refusal | None:
    if len(lines) > read / 2:
        reason = REASONS[int(np.bincount(codes).argmax())]
        first = lines[codes == REASONS.index(reason)][:1]
        line, text = next(iter(log.source.texts(first, _PERIOD_BYTES)))
        return Refusal(
            reason,
            f"{len(lines)} of {read} rows cannot be used, mostly {reason}, for example line"
            f" {line}: {text}",
        )
    if kept < _MIN_ROWS:
        return Refusal("too_few_rows", f"{kept} usable rows; expected at least {_MIN_ROWS}")
    return None
