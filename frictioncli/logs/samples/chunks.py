"""Chunks of a log: consecutive raw rows, converted to the units used inside and checked."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from statistics import median

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.errors import LogError
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.units import plausible_temperature
from frictioncli.logs.log_source import RawBatch, UnreadableLog
from frictioncli.logs.runs.opening import OpenedLog
from frictioncli.logs.samples.log_rows import LogRows, RejectedRows
from frictioncli.logs.samples.row_checks import drop_missing_values
from frictioncli.logs.samples.temperature_dropouts import without_dropouts

_FIRST_BYTES = 1 << 12
_NOTHING: Mapping[int, tuple[int, float]] = {}
"""Shared by all logs that have none: there may be 100,000."""

_TEMPERATURES = frozenset({names.MOTOR_TEMPERATURE, names.HOUSING_TEMPERATURE})

_MAX_OUTLIERS = 3
_MAX_OUTLIER_SHARE = 0.01
"""More rows of a chunk than this beyond the limit of position contradict the unit, not a row."""


@dataclass(frozen=True, slots=True)
class PlannedLog:
    """A log with the plan by which it is read.

    Attributes
    ----------
    log : OpenedLog
        The log.
    plans : tuple of JointPlan
        Columns and units of each joint.
    first_time : float
        Time of the first row by the clock of the log; NaN where it has none. [s]
    period : float
        Median time between the first samples; 1 where they do not show it. [s]
    others : mapping of int to (int, float)
        Joints that are not read but whose position is known: its column, and the factor to deg.
    """

    log: OpenedLog
    plans: tuple[JointPlan, ...]
    first_time: float
    period: float
    others: Mapping[int, tuple[int, float]]

    @property
    def columns(self) -> set[int]:
        """Indices of all columns that are read."""
        columns = {self.plans[0].channels.time.column}
        for plan in self.plans:
            columns.update(_column(plan, name) for name in plan.conversions)
        columns.update(column for column, _ in self.others.values())
        return columns


@dataclass(frozen=True, slots=True)
class LogChunk:
    """Consecutive rows of a log.

    Attributes
    ----------
    rows : LogRows
        The usable rows, converted.
    rejected : RejectedRows
        Lines of the others.
    rows_read : int
        Rows in all.
    """

    rows: LogRows
    rejected: RejectedRows
    rows_read: int


def plan_log(log: OpenedLog, plans: Iterable[JointPlan]) -> PlannedLog:
    """Return a log with its plan, and first time and period from its first rows.

    Parameters
    ----------
    log : OpenedLog
        The log.
    plans : iterable of JointPlan
        Columns and units of each joint.
    """
    plans = tuple(plans)
    conversion = plans[0].conversions[names.TIME]
    time_column = _column(plans[0], names.TIME)
    position_column = _column(plans[0], names.POSITION)
    finite = time = np.empty(0)
    with suppress(UnreadableLog):  # reported when the whole log is read
        first = next(iter(log.source.batches([time_column, position_column], _FIRST_BYTES)), None)
        if first is not None:
            finite = first.values[time_column][np.isfinite(first.values[time_column])]
            time = first.values[time_column][np.isfinite(first.values[position_column])]
    with np.errstate(over="ignore"):
        steps = np.diff(np.where(np.isinf(time), np.nan, time))
    steps = steps[steps > 0]
    return PlannedLog(
        log,
        plans,
        first_time=float(finite[0]) * conversion.factor if len(finite) else np.nan,
        period=median(steps.tolist()) * conversion.factor if len(steps) else 1.0,
        others=_other_positions(log.channels, plans) or _NOTHING,
    )


def _other_positions(
    channels: Iterable[LogChannel], plans: tuple[JointPlan, ...]
) -> dict[int, tuple[int, float]]:
    """Return column and factor of the positions of joints that are not read.

    They are in the unit of the positions that are read and have the same name but for the number.
    """
    factors = {
        plan.channels.position.family: plan.conversions[names.POSITION].factor
        for plan in plans
        if plan.channels.position.meaning.side != names.MOTOR_SIDE
    }
    known = {plan.channels.joint for plan in plans}
    return {
        channel.joint: (channel.column, factors[channel.family])
        for channel in channels
        if channel.quantity == names.POSITION
        and channel.joint is not None
        and channel.joint not in known
        and channel.family in factors
    }


def empty_chunk(planned: PlannedLog) -> LogChunk:
    """Return a chunk without rows."""
    columns = {
        (plan.channels.joint, name): np.empty(0)
        for plan in planned.plans
        for name in plan.conversions
    } | {(joint, names.POSITION): np.empty(0) for joint in planned.others}
    return LogChunk(LogRows(np.empty(0, np.int64), np.empty(0), columns), RejectedRows(), 0)


def convert_chunk(batch: RawBatch, planned: PlannedLog) -> LogChunk:
    """Convert raw rows, and reject those that are unreadable or lack a required value.

    Parameters
    ----------
    batch : RawBatch
        The rows as they stand in the file.
    planned : PlannedLog
        Their log.

    Raises
    ------
    LogError
        If positions contradict the unit that the survey found.
    """
    rejected = RejectedRows()
    for reason in sorted(set(batch.bad_reasons)):
        # an array of the texts would take 70 bytes per row
        is_reason = np.fromiter((one == reason for one in batch.bad_reasons), bool)
        rejected.add(batch.bad_lines[is_reason], reason)
    rows = _drop_implausible_positions(_converted(batch, planned), batch, planned, rejected)
    required = [
        (plan.channels.joint, name)
        for plan in planned.plans
        for name in (names.POSITION, names.TORQUE, names.VELOCITY)
        if name in plan.conversions
        # an integral of velocity has no largest value, and is there where the velocity is
        if (name, plan.channels.position.name) != (names.POSITION, names.INTEGRATED)
    ]
    rows = drop_missing_values(rows, required, rejected)
    return LogChunk(rows, rejected, len(batch.lines) + len(batch.bad_lines))


def _converted(batch: RawBatch, planned: PlannedLog) -> LogRows:
    columns: dict[tuple[int, str], Array] = {}
    with np.errstate(over="ignore"):  # infinite values are rejected later
        for joint, (column, factor) in planned.others.items():
            columns[joint, names.POSITION] = batch.values[column] * factor
    for plan in planned.plans:
        for name, conversion in plan.conversions.items():
            values = batch.values[_column(plan, name)]
            if (conversion.factor, conversion.offset) != (1.0, 0.0):
                with np.errstate(over="ignore"):  # infinite values are rejected later
                    values = values * conversion.factor + conversion.offset
            if name in _TEMPERATURES:
                values = plausible_temperature(values)
            columns[plan.channels.joint, name] = values
    time = next(values for (_, name), values in columns.items() if name == names.TIME)
    for (joint, name), values in columns.items():
        if name in _TEMPERATURES:
            columns[joint, name] = without_dropouts(time, values)
    return LogRows(batch.lines, time, columns)


def _drop_implausible_positions(
    rows: LogRows, batch: RawBatch, planned: PlannedLog, rejected: RejectedRows
) -> LogRows:
    """Return the rows whose raw positions agree with the unit rad, where that was inferred."""
    outside = np.zeros(len(rows), bool)
    for plan in planned.plans:
        if plan.position_limit is None or not len(rows):
            continue
        raw = batch.values[plan.channels.position.column]
        if -plan.position_limit <= raw.min() <= raw.max() <= plan.position_limit:
            continue
        out = np.isfinite(raw) & (np.abs(raw) > plan.position_limit)
        if out.sum() > max(_MAX_OUTLIERS, _MAX_OUTLIER_SHARE * len(out)):
            raise _contradicted_unit(planned.log, plan, batch, out)
        outside |= out
    if not outside.any():
        return rows
    rejected.add(rows.lines[outside], "implausible_position")
    return rows.take(~outside)


def _contradicted_unit(log: OpenedLog, plan: JointPlan, batch: RawBatch, out: Flags) -> LogError:
    where = int(np.flatnonzero(out)[0])
    name = plan.channels.position.name
    value = batch.values[plan.channels.position.column][where]
    return LogError(
        f"{log.file.path} line {batch.lines[where]}: {name} is {value:.4g}, but the beginnings of"
        f" the logs of run {log.run.name} looked like rad, which end at ±6.9; give the unit"
        " with --position-unit deg or rad"
    )


def _column(plan: JointPlan, name: str) -> int:
    channel: LogChannel = getattr(plan.channels, name)
    return channel.column
