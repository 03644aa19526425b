"""Logs in parts: consecutive rows, converted and judged one by one, parsed ahead in threads."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import chain, groupby
from statistics import median

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.errors import LogError
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.units import plausible_temperature
from frictioncli.logs.log_source import RawBatch, ReadTask, UnreadableLog
from frictioncli.logs.runs.opening import OpenedLog
from frictioncli.logs.samples.read_ahead import in_order
from frictioncli.logs.samples.row_checks import LogRows, RejectedRows, with_values

_FIRST_BYTES = 1 << 12
_HANDED_OVER = 1 << 21
"""Tasks of fewer bytes go to a thread together: handing them over takes longer than some take."""
_BEYOND = 3
_BEYOND_SHARE = 0.01


@dataclass(frozen=True, slots=True)
class PlannedLog:
    """A log about to be read.

    Attributes
    ----------
    log : OpenedLog
        Which.
    plans : tuple of JointPlan
        How.
    begin : float
        The file's own time at its first row; NaN where it tells none. [s]
    period : float
        Median time between the first samples; 1 where they do not tell. [s]
    """

    log: OpenedLog
    plans: tuple[JointPlan, ...]
    begin: float
    period: float


@dataclass(frozen=True, slots=True)
class Chunk:
    """Consecutive rows of a log: converted usable ones, faults of the others, rows in all."""

    block: LogRows
    faults: RejectedRows
    rows: int


def plan_log(log: OpenedLog, plans: Iterable[JointPlan]) -> PlannedLog:
    """Return how a log will be read, with what its first rows tell of time."""
    plans = tuple(plans)
    conversion = plans[0].conversions[names.TIME]
    at, where = _column(plans[0], names.TIME), _column(plans[0], names.POSITION)
    known = time = np.empty(0)
    with suppress(UnreadableLog):  # reading it will tell
        first = next(iter(log.source.batches([at, where], _FIRST_BYTES)), None)
        if first is not None:
            known = first.values[at][np.isfinite(first.values[at])]
            time = first.values[at][np.isfinite(first.values[where])]
    steps = np.diff(time)
    steps = steps[steps > 0]
    return PlannedLog(
        log,
        plans,
        begin=float(known[0]) * conversion.factor if len(known) else np.nan,
        period=median(steps.tolist()) * conversion.factor if len(steps) else 1.0,
    )


def chunks_of(
    readings: Sequence[PlannedLog], batch_bytes: int
) -> Iterator[tuple[PlannedLog, Iterator[Chunk]]]:
    """Yield each log with its rows in order; parsing goes ahead in threads, across logs too.

    Taking the parts of a log that cannot be read to its end raises ``UnreadableLog``.

    Parameters
    ----------
    readings : sequence of PlannedLog
        The logs.
    batch_bytes : int
        How much of a log makes a part. [byte]
    """
    results = chain.from_iterable(in_order(_together(_tasks(readings, batch_bytes))))
    for number, group in groupby(results, key=lambda result: result.number):
        yield readings[number], _parts(group)


@dataclass(frozen=True, slots=True)
class _Result:
    """A part of the log with this number, or why it cannot be read further."""

    number: int
    part: Chunk | UnreadableLog


def _tasks(readings: Iterable[PlannedLog], batch_bytes: int) -> Iterator[ReadTask[_Result]]:
    """Yield the tasks of all logs one after the other; each log has at least one."""
    for number, reading in enumerate(readings):
        end: Chunk | UnreadableLog | None = Chunk(_no_rows(reading.plans), RejectedRows(), 0)
        columns = {reading.plans[0].channels.time.column}
        for plan in reading.plans:
            columns.update(_column(plan, name) for name in plan.conversions)
        try:
            for task in reading.log.source.tasks(columns, batch_bytes):
                yield ReadTask(partial(_done, number, reading, task), task.size)
                end = None
        except UnreadableLog as error:
            end = error
        if end is not None:
            yield ReadTask(partial(_Result, number, end), 0)


def _together(tasks: Iterable[ReadTask[_Result]]) -> Iterator[Callable[[], list[_Result]]]:
    """Yield the tasks, small ones together."""
    held: list[ReadTask[_Result]] = []
    held_bytes = 0
    for task in tasks:
        if held and held_bytes + task.size > _HANDED_OVER:
            yield partial(_all, held)
            held, held_bytes = [], 0
        held.append(task)
        held_bytes += task.size
    yield partial(_all, held)


def _all(tasks: Iterable[ReadTask[_Result]]) -> list[_Result]:
    return [task.read() for task in tasks]


def _done(number: int, reading: PlannedLog, task: ReadTask[RawBatch]) -> _Result:
    try:
        return _Result(number, _part(task.read(), reading))
    except UnreadableLog as error:
        return _Result(number, error)


def _parts(results: Iterable[_Result]) -> Iterator[Chunk]:
    for result in results:
        if isinstance(result.part, UnreadableLog):
            raise result.part
        yield result.part


def _part(batch: RawBatch, reading: PlannedLog) -> Chunk:
    """Return converted rows; unreadable ones and those without the required values go out."""
    faults = RejectedRows()
    for reason in sorted(set(batch.bad_reasons)):
        faults.add(batch.bad_lines[np.array(batch.bad_reasons) == reason], reason)
    block = _within_limits(_converted(batch, reading.plans), batch, reading, faults)
    required = [
        (plan.channels.joint, name)
        for plan in reading.plans
        for name in (names.POSITION, names.TORQUE, names.VELOCITY)
        if name in plan.conversions
    ]
    block = with_values(block, required, faults)
    return Chunk(block, faults, len(batch.lines) + len(batch.bad_lines))


def _no_rows(plans: Iterable[JointPlan]) -> LogRows:
    columns = {
        (plan.channels.joint, name): np.empty(0) for plan in plans for name in plan.conversions
    }
    return LogRows(np.empty(0, np.int64), np.empty(0), columns)


def _within_limits(
    block: LogRows, batch: RawBatch, reading: PlannedLog, faults: RejectedRows
) -> LogRows:
    """Return the rows without positions that contradict radians as the unit."""
    outside = np.zeros(len(block), bool)
    for plan in reading.plans:
        if plan.position_limit is None or not len(block):
            continue
        raw = batch.values[plan.channels.position.column]
        if -plan.position_limit <= raw.min() <= raw.max() <= plan.position_limit:
            continue
        out = np.isfinite(raw) & (np.abs(raw) > plan.position_limit)
        if out.sum() > max(_BEYOND, _BEYOND_SHARE * len(out)):
            _contradicted(reading.log, plan, batch, out)
        outside |= out
    if not outside.any():
        return block
    faults.add(block.lines[outside], "implausible_position")
    return block.take(~outside)


def _contradicted(log: OpenedLog, plan: JointPlan, batch: RawBatch, out: Flags) -> None:
    where = int(np.flatnonzero(out)[0])
    name = plan.channels.position.name
    value = batch.values[plan.channels.position.column][where]
    raise LogError(
        f"{log.file.path} line {batch.lines[where]}: {name} is {value:.4g}, but the beginnings of"
        f" the logs of run {log.run.name} looked like rad, which end at ±6.9; say which it is with"
        " --position-unit deg or rad"
    )


def _column(plan: JointPlan, name: str) -> int:
    channel: LogChannel = getattr(plan.channels, name)
    return channel.column


def _converted(batch: RawBatch, plans: Iterable[JointPlan]) -> LogRows:
    columns: dict[tuple[int, str], Array] = {}
    for plan in plans:
        for name, conversion in plan.conversions.items():
            values = batch.values[_column(plan, name)]
            if (conversion.factor, conversion.offset) != (1.0, 0.0):
                with np.errstate(over="ignore"):  # infinite ones are rejected
                    values = values * conversion.factor + conversion.offset
            if name in (names.MOTOR_TEMPERATURE, names.HOUSING_TEMPERATURE):
                values = plausible_temperature(values)
            columns[plan.channels.joint, name] = values
    time = next(values for (_, name), values in columns.items() if name == names.TIME)
    return LogRows(batch.lines, time, columns)
