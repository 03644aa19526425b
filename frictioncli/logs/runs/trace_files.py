"""Which files belong together: two forms of one recording, and the files of one trace."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels, split_unit
from frictioncli.logs.formats.diadem import DiademRecording
from frictioncli.logs.log_source import LogSource, UnreadableLog
from frictioncli.logs.runs.discovery import LogFile
from frictioncli.logs.runs.merging import MergedLog, SecondaryFile
from frictioncli.logs.runs.trace_names import drive_of

_HELD = (names.MOTOR_TEMPERATURE, names.HOUSING_TEMPERATURE)
_PERIOD_BYTES = 1 << 16


def duplicates_of_native(sources: Mapping[LogFile, LogSource]) -> dict[LogFile, LogFile]:
    """Return the files that hold nothing beside a native recording of the same name.

    Returns
    -------
    dict of LogFile to LogFile
        The file that is not needed -> the native one.
    """
    natives = {
        (file.path.parent, file.stem): file
        for file, source in sources.items()
        if isinstance(source, DiademRecording)
    }
    doubles: dict[LogFile, LogFile] = {}
    for file, source in sources.items():
        native = natives.get((file.path.parent, file.stem))
        if native in (None, file) or isinstance(source, DiademRecording):
            continue
        if _bare(source.columns) <= _bare(sources[native].columns):
            doubles[file] = native
    return doubles


def _bare(columns: Iterable[str]) -> set[str]:
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
        """Return names of its columns; those of a drive with the number of its axis."""
        return tuple(self._name(self.source.columns[i], i) for i in columns)

    def _name(self, column: str, index: int) -> str:
        if self.drive is None or (self.time is not None and index == self.time.column):
            return column
        name, unit = split_unit(column)
        return f"{name}_A{self.drive}" + (f"[{unit}]" if unit else "")


@dataclass(frozen=True, slots=True)
class MergedTrace:
    """A file of a trace, with columns that others lend, for the joints whose torque it holds."""

    file: LogFile
    source: LogSource
    joints: tuple[int, ...]

    @property
    def channels(self) -> tuple[LogChannel, ...]:
        """The recognised columns."""
        own = (
            self.source.base.columns if isinstance(self.source, MergedLog) else self.source.columns
        )
        return recognise_channels(self.source.columns, first_merged=len(own))


def merged(
    files: Iterable[tuple[LogFile, LogSource]], joints: Collection[int] | None
) -> list[MergedTrace]:
    """Put the files of one trace together.

    A joint's samples are those of the file with its best torque channel; the drive's where two are
    equal. What this file lacks of the joint comes from the other one.

    Parameters
    ----------
    files : iterable of (LogFile, LogSource)
        The files of the trace, each of one module.
    joints : collection of int or None
        The joints wanted; None for all.

    Returns
    -------
    list of MergedTrace
        Those whose rows become samples; empty where none lends to another.
    """
    modules = [_module(file, source) for file, source in files]
    found = []
    for base, own in _bases(modules, joints):
        lending = [(m, _lender(m, base)) for m in modules if _lends(m, base, own)]
        lent = [(module, one) for module, one in lending if one is not None]
        found.append(MergedTrace(base.file, _with(base, lent), own))
    return found if any(isinstance(one.source, MergedLog) for one in found) else []


def _with(base: _Module, lent: Sequence[tuple[_Module, SecondaryFile]]) -> LogSource:
    """Return a file with the columns that others lend."""
    if base.time is None or not lent:
        return base.source
    columns = base.names(range(len(base.source.columns)))
    for module, one in lent:
        columns += module.names(one.columns)
    lenders = tuple(one for _, one in lent)
    return MergedLog(base.source, base.time.column, lenders, columns)


def _module(file: LogFile, source: LogSource) -> _Module:
    channels = recognise_channels(source.columns)
    times = [channel for channel in channels if channel.quantity == names.TIME]
    time = min(times, key=lambda channel: channel.meaning.rank, default=None)
    return _Module(file, source, drive_of(file.stem), channels, time)


def _bases(
    modules: Sequence[_Module], joints: Collection[int] | None
) -> list[tuple[_Module, tuple[int, ...]]]:
    """Return the files whose rows become samples, each with the joints that it serves."""
    best: dict[int, tuple[int, bool, int]] = {}
    for number, module in enumerate(modules):
        for channel in module.channels:
            joint = module.joint_of(channel)
            if channel.quantity != names.TORQUE or joint is None:
                continue
            rank = (channel.meaning.rank, module.drive is None, number)
            best[joint] = min(rank, best.get(joint, rank))
    served: dict[int, list[int]] = {}
    for joint, (_, _, number) in sorted(best.items()):
        if joints is None or joint in joints:
            served.setdefault(number, []).append(joint)
    return [(modules[number], tuple(own)) for number, own in served.items()]


def _lends(module: _Module, base: _Module, joints: Collection[int]) -> bool:
    """Return whether a file lends to the base: drives to the interpolator, and it to them."""
    if base.drive is None:
        return module.drive in joints
    return module.drive is None


def _lender(module: _Module, base: _Module) -> SecondaryFile | None:
    """Return what a file lends to another; None where either has no times."""
    time = module.time
    if time is None or base.time is None:
        return None
    scale = _seconds(time) / _seconds(base.time)
    period = _period(module.source, time.column) * scale
    if not period:
        return None
    columns = tuple(i for i in range(len(module.source.columns)) if i != time.column)
    held = frozenset(c.column for c in module.channels if c.quantity in _HELD)
    return SecondaryFile(module.source, time.column, scale, period, columns, held)


def _seconds(time: LogChannel) -> float:
    unit = units.canonical(time.unit or time.meaning.unit, names.TIME)
    return units.FACTORS[names.TIME][unit or "s"]


def _period(source: LogSource, time: int) -> float:
    """Return the median time between the first rows; 0 where they do not tell. [raw]."""
    with suppress(UnreadableLog):  # reading it will tell
        for batch in source.batches([time], _PERIOD_BYTES):
            steps = np.diff(batch.values[time])
            return float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    return 0.0
