"""Files that belong together: two formats of one recording, and the files of one trace."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels
from frictioncli.logs.formats.diadem import DiademRecording
from frictioncli.logs.log_source import LogSource, UnreadableLog
from frictioncli.logs.runs.discovery import LogFile
from frictioncli.logs.runs.merging import MergedLog, SecondaryFile
from frictioncli.logs.runs.trace_names import drive_of

_REGISTERS = (names.MOTOR_TEMPERATURE, names.HOUSING_TEMPERATURE)
_PERIOD_BYTES = 1 << 16


def duplicates_of_native(sources: Mapping[LogFile, LogSource]) -> dict[LogFile, LogFile]:
    """Return the files whose columns are all in the native recording of the same name.

    Parameters
    ----------
    sources : mapping of LogFile to LogSource
        The opened files.

    Returns
    -------
    dict of LogFile to LogFile
        The duplicate -> the native recording.
    """
    natives = {
        (file.path.parent, file.stem): file
        for file, source in sources.items()
        if isinstance(source, DiademRecording)
    }
    duplicates: dict[LogFile, LogFile] = {}
    for file, source in sources.items():
        native = natives.get((file.path.parent, file.stem))
        if native in (None, file) or isinstance(source, DiademRecording):
            continue
        if _names_without_units(source.columns) <= _names_without_units(sources[native].columns):
            duplicates[file] = native
    return duplicates


def _names_without_units(columns: Iterable[str]) -> set[str]:
    return {split_unit(column)[0] for column in columns}


@dataclass(frozen=True, slots=True)
class _Module:
    """A file of a trace; ``drive`` is the axis of a drive's file, None for the interpolator's."""

    file: LogFile
    source: LogSource
    drive: int | None
    channels: tuple[LogChannel, ...]
    time: LogChannel | None

    def joint_of(self, channel: LogChannel) -> int | None:
        """Return the joint of one of its columns."""
        return self.drive if channel.joint is None else channel.joint

    def names(self, columns: Iterable[int]) -> tuple[str, ...]:
        """Return the names of its columns; those of a drive with the number of its axis."""
        return tuple(self._name(self.source.columns[i], i) for i in columns)

    def _name(self, column: str, index: int) -> str:
        if self.drive is None or (self.time is not None and index == self.time.column):
            return column
        name, unit = split_unit(column)
        return f"{name}_A{self.drive}" + (f"[{unit}]" if unit else "")


@dataclass(frozen=True, slots=True)
class MergedTrace:
    """A file of a trace with columns merged from the others.

    Attributes
    ----------
    file : LogFile
        The file whose rows are the samples.
    source : LogSource
        Its columns and the merged ones.
    joints : tuple of int
        The joints whose torque it holds.
    """

    file: LogFile
    source: LogSource
    joints: tuple[int, ...]

    @property
    def channels(self) -> tuple[LogChannel, ...]:
        """The recognised columns."""
        base = self.source.base if isinstance(self.source, MergedLog) else self.source
        return recognise_channels(self.source.columns, first_merged=len(base.columns))


def merge_trace(
    files: Iterable[tuple[LogFile, LogSource]], joints: Collection[int] | None
) -> list[MergedTrace]:
    """Merge the files of one trace.

    The samples of a joint are the rows of the file with its best torque channel; of equal channels
    the drive's. Channels that this file lacks are merged from the others.

    Parameters
    ----------
    files : iterable of (LogFile, LogSource)
        The files of the trace, each of one module.
    joints : collection of int or None
        The joints wanted; None for all.

    Returns
    -------
    list of MergedTrace
        The files whose rows become samples; empty where nothing is merged.
    """
    modules = [_module(file, source) for file, source in files]
    traces = []
    for base, base_joints in _base_files(modules, joints):
        complements = [
            (module, _secondary_file(module, base))
            for module in modules
            if _complements(module, base, base_joints)
        ]
        secondary = [(module, file) for module, file in complements if file is not None]
        traces.append(MergedTrace(base.file, _merged_source(base, secondary), base_joints))
    return traces if any(isinstance(trace.source, MergedLog) for trace in traces) else []


def _merged_source(base: _Module, secondary: Sequence[tuple[_Module, SecondaryFile]]) -> LogSource:
    """Return the source of a base file with the columns of secondary files."""
    if base.time is None or not secondary:
        return base.source
    columns = base.names(range(len(base.source.columns)))
    for module, file in secondary:
        columns += module.names(file.columns)
    files = tuple(file for _, file in secondary)
    return MergedLog(base.source, base.time.column, files, columns)


def _module(file: LogFile, source: LogSource) -> _Module:
    channels = recognise_channels(source.columns)
    times = [channel for channel in channels if channel.quantity == names.TIME]
    time = min(times, key=lambda channel: channel.meaning.rank, default=None)
    return _Module(file, source, drive_of(file.stem), channels, time)


def _base_files(
    modules: Sequence[_Module], joints: Collection[int] | None
) -> list[tuple[_Module, tuple[int, ...]]]:
    """Return the files whose rows become samples, each with its joints."""
    best: dict[int, tuple[int, bool, int]] = {}
    for number, module in enumerate(modules):
        for channel in module.channels:
            joint = module.joint_of(channel)
            if channel.quantity != names.TORQUE or joint is None:
                continue
            rank = (channel.meaning.rank, module.drive is None, number)
            best[joint] = min(rank, best.get(joint, rank))
    joints_of: dict[int, list[int]] = {}
    for joint, (_, _, number) in sorted(best.items()):
        if joints is None or joint in joints:
            joints_of.setdefault(number, []).append(joint)
    return [(modules[number], tuple(found)) for number, found in joints_of.items()]


def _complements(module: _Module, base: _Module, joints: Collection[int]) -> bool:
    """Return whether a file may have columns for the base file: drives and interpolator may."""
    if base.drive is None:
        return module.drive in joints
    return module.drive is None


def _secondary_file(module: _Module, base: _Module) -> SecondaryFile | None:
    """Return a file as a secondary one of the base file; None where either has no times."""
    time = module.time
    if time is None or base.time is None:
        return None
    scale = _seconds(time) / _seconds(base.time)
    period = _period(module.source, time.column) * scale
    if not period:
        return None
    columns = tuple(i for i in range(len(module.source.columns)) if i != time.column)
    held = frozenset(c.column for c in module.channels if c.quantity in _REGISTERS)
    return SecondaryFile(module.source, time.column, scale, period, columns, held)


def _seconds(time: LogChannel) -> float:
    unit = units.canonical(time.unit or time.meaning.unit, names.TIME)
    return units.FACTORS[names.TIME][unit or "s"]


def _period(source: LogSource, time: int) -> float:
    """Return the median time between the first rows, in the file's unit; 0 where not known."""
    with suppress(UnreadableLog):  # reported when the whole log is read
        for batch in source.batches([time], _PERIOD_BYTES):
            steps = np.diff(batch.values[time])
            return float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    return 0.0
