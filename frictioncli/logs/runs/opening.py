"""Opening the files of a run: logs with their channels chosen, or the reason of refusal."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.channel_names import INTEGRATED, TIME, VELOCITY
from frictioncli.logs.channels.joint_channels import JointChannels, assign_channels
from frictioncli.logs.channels.mapped_channels import mapped_channels, with_side
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels
from frictioncli.logs.channels.units import is_count
from frictioncli.logs.formats import open_logs
from frictioncli.logs.log_source import LogSource, Refusal
from frictioncli.logs.runs.discovery import LogFile, LogRun
from frictioncli.logs.runs.file_joint import joint_of_file
from frictioncli.logs.runs.integrated_position import (
    IntegratedPosition,
    integrable,
    scale_to_degrees,
    with_position,
)
from frictioncli.logs.runs.joint_rows import parts_by_joint
from frictioncli.logs.runs.native_scale import ScaledLog, scale_raw_export
from frictioncli.logs.runs.sidecar import Sidecar, read_sidecar, with_own_text
from frictioncli.logs.runs.trace_files import duplicates_of_native, merge_trace
from frictioncli.logs.runs.trace_names import is_module, is_program, trace_of
from frictioncli.logs.settings import IngestSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenedLog:
    """A log whose channels have been chosen.

    Attributes
    ----------
    run : LogRun
        Its run.
    file : LogFile
        The file whose rows are its samples.
    recording : str
        Name of the recording, unique in the run; logs of one trace that hold different joints
        share it.
    source : LogSource
        Its raw columns, which may come from several files.
    channels : tuple of LogChannel
        All recognised columns.
    joints : tuple of JointChannels
        The columns chosen for each joint.
    sidecar : Sidecar
        Start and payload from the files next to it.
    """

    run: LogRun
    file: LogFile
    recording: str
    source: LogSource
    channels: tuple[LogChannel, ...]
    joints: tuple[JointChannels, ...]
    sidecar: Sidecar

    @property
    def layout(self) -> tuple[str, ...]:
        """What logs of one run must share to share their units: run, form and header."""
        return (self.run.name, self.source.form, *self.source.columns)


@dataclass(frozen=True, slots=True)
class RefusedLog:
    """A file that is not used as a whole, with the reason."""

    run: LogRun
    file: LogFile
    recording: str
    refusal: Refusal


def open_run(
    run: LogRun, settings: IngestSettings, channel_map: ChannelMap
) -> tuple[list[OpenedLog], list[RefusedLog]]:
    """Open all files of a run.

    Parameters
    ----------
    run : LogRun
        The run.
    settings : IngestSettings
        Joints to read.
    channel_map : ChannelMap
        Mapping file of the user; where it names columns, files of a trace are not merged.

    Returns
    -------
    opened : list of OpenedLog
        The logs that can be used.
    refused : list of RefusedLog
        The files that cannot be used. Files that belong to another log are in neither list: the
        samples of a native header, the motion information of a trace, and merged files.
    """
    paths = [file.path for file in run.files]
    found = dict(zip(run.files, open_logs(paths, channel_map.hints), strict=True))
    sources = {file: one for file, one in found.items() if not isinstance(one, Refusal)}
    refusals = {file: one for file, one in found.items() if isinstance(one, Refusal)}
    for file, native in duplicates_of_native(sources).items():
        del sources[file]
        refusals[file] = Refusal(
            "same_recording",
            f"the {native.path.suffix} of the same name has the same recording and is read instead",
        )
    sources = {file: scale_raw_export(source) for file, source in sources.items()}
    parts, missing = parts_by_joint(sources, settings, channel_map)
    sources = {part: source for of_file in parts.values() for part, source in of_file.items()}
    refusals |= missing
    choices = _choices(sources, settings, channel_map)
    for file, of_file in parts.items():
        told = [one for part in of_file if isinstance(one := choices.get(part), Refusal)]
        if told and len(told) == len(of_file):
            refusals[file] = told[0]
    usable = {file: one for file, one in choices.items() if not isinstance(one, Refusal)}
    recordings = _recording_names(run, usable)
    names = {folder: set(os.listdir(folder)) for folder in {file.path.parent for file in usable}}
    opened = [
        OpenedLog(
            run=run,
            file=file,
            recording=recordings[file],
            source=_scaled(choice, channel_map),
            channels=choice.channels,
            joints=choice.joints,
            sidecar=with_own_text(read_sidecar(file.path, names[file.path.parent]), choice.source),
        )
        for file, choice in usable.items()
    ]
    belonging = {path for source in sources.values() for path in source.files[1:]}
    traces = {_trace(file) for file in sources if is_module(file.stem)}
    refused = [
        RefusedLog(run, file, file.path.name, refusals[file])
        for file in run.files
        if file in refusals
        and file.path not in belonging
        and not (is_program(file.stem) and _trace(file) in traces)
    ]
    return opened, refused


@dataclass(frozen=True, slots=True)
class _Choice:
    """What is read of a file: its columns, merged ones included, chosen for each joint."""

    source: LogSource
    channels: tuple[LogChannel, ...]
    joints: tuple[JointChannels, ...]


def _choices(
    sources: Mapping[LogFile, LogSource], settings: IngestSettings, channel_map: ChannelMap
) -> dict[LogFile, _Choice | Refusal]:
    """Return what is read of each file, or why it is refused; files of a trace are merged."""
    traces = _traces(sources) if not channel_map.channels else []
    merged = {log.file: log for files in traces for log in merge_trace(files, settings.joints)}
    used = {path for log in merged.values() for path in log.source.files}
    choices: dict[LogFile, _Choice | Refusal] = {}
    choices_by_header: dict[tuple[tuple[str, ...], int], _Choice | Refusal] = {}
    for file, source in sources.items():
        joint = _file_joint(file, source, settings, channel_map)
        if file in merged:
            log = merged[file]
            choices[file] = _choose(log.source, log.channels, log.joints, file_joint=joint)
        elif file.path not in used:
            # logs of a folder mostly have the same columns
            key = source.columns, joint
            if key not in choices_by_header:
                channels = _channels(source.columns, channel_map, joint)
                choices_by_header[key] = _choose(
                    source, channels, settings.joints, file_joint=joint
                )
            choice = choices_by_header[key]
            if isinstance(choice, Refusal) and choice.reason == "no_position_channel":
                choices[file] = _without_position(source, choice, settings, channel_map, joint)
                continue
            choices[file] = (
                choice if isinstance(choice, Refusal) else replace(choice, source=source)
            )
    return choices


def _without_position(
    source: LogSource,
    refusal: Refusal,
    settings: IngestSettings,
    channel_map: ChannelMap,
    joint: int,
) -> _Choice | Refusal:
    """Return what is read of a log without position: that of one axis is integrated."""
    channels = _channels(source.columns, channel_map, joint)
    found = None if isinstance(channels, Refusal) else integrable(channels)
    if found is None or isinstance(channels, Refusal):
        return refusal
    time, velocity = found
    if is_count(velocity.unit) and VELOCITY not in channel_map.scales:
        text = (
            f"no position, and {velocity.name} counts pulses; give the speed of one pulse per"
            " time in deg/s with --map, as [scale] velocity = 0.0879"
        )
        return Refusal("unclear_velocity_unit", text)
    forced = {**channel_map.units, **settings.forced_units()}
    scale = scale_to_degrees(time, velocity, forced)
    for quantity in (TIME, VELOCITY):
        scale *= channel_map.scales.get(quantity, 1.0)
    integrated = IntegratedPosition(source, time.column, velocity.column, scale)
    known = with_position(channels, velocity, len(source.columns))
    return _choose(integrated, known, settings.joints, file_joint=joint)


def _scaled(choice: _Choice, channel_map: ChannelMap) -> LogSource:
    """Return the log with the columns that the map scales multiplied."""
    factors = {
        channel.column: channel_map.scales[channel.quantity]
        for channel in choice.channels
        if channel.quantity in channel_map.scales and channel.name != INTEGRATED
    }
    if not factors:
        return choice.source
    columns = range(len(choice.source.columns))
    scales = tuple((factors.get(column, 1.0), 0.0) for column in columns)
    return ScaledLog(choice.source, scales, "scaled by the map")


def _choose(
    source: LogSource,
    channels: tuple[LogChannel, ...] | Refusal,
    joints: tuple[int, ...] | None,
    *,
    file_joint: int,
) -> _Choice | Refusal:
    if isinstance(channels, Refusal):
        return channels
    chosen = assign_channels(channels, source.columns, joints=joints, file_joint=file_joint)
    return chosen if isinstance(chosen, Refusal) else _Choice(source, channels, chosen)


def _trace(file: LogFile) -> tuple[Path, str]:
    """Return folder and name, which the files of a trace have in common."""
    return file.path.parent, trace_of(file.stem)


def _traces(sources: Mapping[LogFile, LogSource]) -> list[list[tuple[LogFile, LogSource]]]:
    """Return the files of each trace, one per module."""
    traces: dict[tuple[Path, str], dict[str, tuple[LogFile, LogSource]]] = {}
    for file, source in sources.items():
        if is_module(file.stem):
            traces.setdefault(_trace(file), {}).setdefault(file.stem, (file, source))
    return [list(modules.values()) for modules in traces.values() if len(modules) > 1]


def _recording_names(run: LogRun, choices: Mapping[LogFile, _Choice]) -> dict[LogFile, str]:
    """Return a unique name of each recording: the trace's, the file's, or the path in the run.

    Files of one trace share a name if they hold different joints.
    """
    name_functions: tuple[Callable[[LogFile], str], ...] = (
        lambda file: trace_of(file.stem),
        lambda file: file.path.name,
        lambda file: file.path.relative_to(run.folder).as_posix(),
    )
    names: dict[LogFile, str] = {}
    used: set[str] = set()
    unnamed = list(choices)
    for name_of in name_functions:
        same: dict[str, list[LogFile]] = {}
        for file in unnamed:
            same.setdefault(name_of(file), []).append(file)
        for name, files in same.items():
            if name not in used and _may_share_name(files, choices):
                names |= dict.fromkeys(files, name)
                used.add(name)
        unnamed = [file for file in unnamed if file not in names]
    return names


def _may_share_name(files: Sequence[LogFile], choices: Mapping[LogFile, _Choice]) -> bool:
    """Return whether files may share a name: one file, or one trace without common joints."""
    joints = [channels.joint for file in files for channels in choices[file].joints]
    one_trace = len({_trace(file) for file in files}) == 1 and is_module(files[0].stem)
    one_trace |= len({file.path for file in files}) == 1
    return len(files) == 1 or (one_trace and len(set(joints)) == len(joints))


def _file_joint(
    file: LogFile, source: LogSource, settings: IngestSettings, channel_map: ChannelMap
) -> int:
    """Return the joint of columns whose names contain no joint number."""
    if channel_map.joint is not None:
        return channel_map.joint
    told = joint_of_file(file, source)
    if told is not None:
        return told
    if settings.joints is not None and len(settings.joints) == 1:
        return settings.joints[0]
    return 1


def _channels(
    columns: Sequence[str], channel_map: ChannelMap, joint: int
) -> tuple[LogChannel, ...] | Refusal:
    if channel_map.channels:
        return mapped_channels(channel_map, columns, joint)
    return tuple(with_side(channel, channel_map) for channel in recognise_channels(columns))
