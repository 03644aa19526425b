"""From files to opened logs with their channels chosen, or the reason why not."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from frictioncli.logs.channels.channel_map import ChannelMap, mapped_channels
from frictioncli.logs.channels.recognition import (
    JointChannels,
    LogChannel,
    assign_channels,
    joint_in_name,
    recognise_channels,
)
from frictioncli.logs.formats import open_logs
from frictioncli.logs.log_source import LogSource, Refusal
from frictioncli.logs.runs.discovery import LogFile, LogRun
from frictioncli.logs.runs.native_scale import scaled
from frictioncli.logs.runs.sidecar import Sidecar, read_sidecar
from frictioncli.logs.runs.trace_files import duplicates_of_native, merged
from frictioncli.logs.runs.trace_names import is_module, is_program, trace_of
from frictioncli.logs.settings import IngestSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenedLog:
    """A log whose channels are known.

    Attributes
    ----------
    run : LogRun
        Where it belongs.
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
        The ones chosen per joint.
    sidecar : Sidecar
        What files beside it tell.
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
    """A file that is not used as a whole."""

    run: LogRun
    file: LogFile
    recording: str
    refusal: Refusal


def open_run(
    run: LogRun, settings: IngestSettings, channel_map: ChannelMap
) -> tuple[list[OpenedLog], list[RefusedLog]]:
    """Open all files of a run; those that cannot be used come back with the reason.

    Files that belong to others are not among either: samples of a native header, motion
    information of a trace, and what was merged. With columns named by a map nothing is merged.
    """
    paths = [file.path for file in run.files]
    found = dict(zip(run.files, open_logs(paths, channel_map.hints), strict=True))
    sources = {file: one for file, one in found.items() if not isinstance(one, Refusal)}
    refusals = {file: one for file, one in found.items() if isinstance(one, Refusal)}
    for file, native in duplicates_of_native(sources).items():
        del sources[file]
        refusals[file] = Refusal(
            "same_recording",
            f"the {native.path.suffix} of the same name holds the same recording and is read",
        )
    sources = {file: scaled(source) for file, source in sources.items()}
    choices = _choices(sources, settings, channel_map)
    refusals |= {file: one for file, one in choices.items() if isinstance(one, Refusal)}
    usable = {file: one for file, one in choices.items() if not isinstance(one, Refusal)}
    labels = _labels(run, usable)
    names = {folder: set(os.listdir(folder)) for folder in {file.path.parent for file in usable}}
    opened = [
        OpenedLog(
            run=run,
            file=file,
            recording=labels[file],
            source=choice.source,
            channels=choice.channels,
            joints=choice.joints,
            sidecar=read_sidecar(file.path, names[file.path.parent]),
        )
        for file, choice in usable.items()
    ]
    parts = {path for source in sources.values() for path in source.files[1:]}
    traces = {_trace(file) for file in sources if is_module(file.stem)}
    refused = [
        RefusedLog(run, file, file.path.name, refusals[file])
        for file in run.files
        if file in refusals
        and file.path not in parts
        and not (is_program(file.stem) and _trace(file) in traces)
    ]
    return opened, refused


@dataclass(frozen=True, slots=True)
class _Choice:
    """What is read of a file: the columns of its own and others' files, chosen per joint."""

    source: LogSource
    channels: tuple[LogChannel, ...]
    joints: tuple[JointChannels, ...]


def _choices(
    sources: Mapping[LogFile, LogSource], settings: IngestSettings, channel_map: ChannelMap
) -> dict[LogFile, _Choice | Refusal]:
    """Return what is read of each file, files of a trace merged, or why nothing can be."""
    traces = _traces(sources) if not channel_map.channels else []
    together = {one.file: one for files in traces for one in merged(files, settings.joints)}
    used = {path for one in together.values() for path in one.source.files}
    found: dict[LogFile, _Choice | Refusal] = {}
    alike: dict[tuple[tuple[str, ...], int], _Choice | Refusal] = {}
    for file, source in sources.items():
        joint = _file_joint(file, settings, channel_map)
        if file in together:
            one = together[file]
            found[file] = _chosen(one.source, one.channels, one.joints, file_joint=joint)
        elif file.path not in used:
            # logs of a folder mostly have the same columns
            key = source.columns, joint
            if key not in alike:
                channels = _channels(source.columns, channel_map, joint)
                alike[key] = _chosen(source, channels, settings.joints, file_joint=joint)
            choice = alike[key]
            found[file] = choice if isinstance(choice, Refusal) else replace(choice, source=source)
    return found


def _chosen(
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
    """Return what the files of a trace have in common."""
    return file.path.parent, trace_of(file.stem)


def _traces(sources: Mapping[LogFile, LogSource]) -> list[list[tuple[LogFile, LogSource]]]:
    """Return the files of each trace, one per module."""
    traces: dict[tuple[Path, str], dict[str, tuple[LogFile, LogSource]]] = {}
    for file, source in sources.items():
        if is_module(file.stem):
            traces.setdefault(_trace(file), {}).setdefault(file.stem, (file, source))
    return [list(modules.values()) for modules in traces.values() if len(modules) > 1]


def _labels(run: LogRun, choices: Mapping[LogFile, _Choice]) -> dict[LogFile, str]:
    """Return the name of each recording: the trace's, else the file's, else with its folder.

    Files of one trace share their name where they hold different joints.
    """
    naming: tuple[Callable[[LogFile], str], ...] = (
        lambda file: trace_of(file.stem),
        lambda file: file.path.name,
        lambda file: file.path.relative_to(run.folder).as_posix(),
    )
    labels: dict[LogFile, str] = {}
    taken: set[str] = set()
    left = list(choices)
    for name_of in naming:
        same: dict[str, list[LogFile]] = {}
        for file in left:
            same.setdefault(name_of(file), []).append(file)
        for name, files in same.items():
            if name not in taken and _distinct(files, choices):
                labels |= dict.fromkeys(files, name)
                taken.add(name)
        left = [file for file in left if file not in labels]
    return labels


def _distinct(files: Sequence[LogFile], choices: Mapping[LogFile, _Choice]) -> bool:
    """Return whether files may share a name: one, or parts of one trace without common joints."""
    joints = [own.joint for file in files for own in choices[file].joints]
    one_trace = len({_trace(file) for file in files}) == 1 and is_module(files[0].stem)
    return len(files) == 1 or (one_trace and len(set(joints)) == len(joints))


def _file_joint(file: LogFile, settings: IngestSettings, channel_map: ChannelMap) -> int:
    """Return the joint of columns that name none."""
    if channel_map.joint is not None:
        return channel_map.joint
    in_name = joint_in_name(file.stem)
    if in_name is not None:
        return in_name
    if settings.joints is not None and len(settings.joints) == 1:
        return settings.joints[0]
    return 1


def _channels(
    columns: Sequence[str], channel_map: ChannelMap, joint: int
) -> tuple[LogChannel, ...] | Refusal:
    if channel_map.channels:
        return mapped_channels(channel_map, columns, joint)
    return recognise_channels(columns)
