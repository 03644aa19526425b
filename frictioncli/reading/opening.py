"""From a file to an opened log with its channels chosen, or the reason why not."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from frictioncli.reading.channels import Channel, JointChannels, assign, joint_in_name, recognise
from frictioncli.reading.discovery import LogFile, Run
from frictioncli.reading.formats import open_log
from frictioncli.reading.formats.base import Refusal, Source
from frictioncli.reading.mapping import ChannelMap, mapped_channels
from frictioncli.reading.settings import IngestSettings


@dataclass(frozen=True, slots=True)
class OpenedLog:
    """A log whose channels are known.

    ``channels`` are all recognised columns, ``joints`` the ones chosen per joint.
    """

    run: Run
    file: LogFile
    recording: str
    source: Source
    channels: tuple[Channel, ...]
    joints: tuple[JointChannels, ...]

    @property
    def layout(self) -> tuple[str, ...]:
        """What logs of one run must share to share their units: the run and the header."""
        return (self.run.name, *self.source.columns)


@dataclass(frozen=True, slots=True)
class RefusedLog:
    """A file that is not used as a whole."""

    run: Run
    file: LogFile
    recording: str
    refusal: Refusal


def open_run(
    run: Run, settings: IngestSettings, chart: ChannelMap
) -> tuple[list[OpenedLog], list[RefusedLog]]:
    """Open all files of a run; those that cannot be used come back with the reason."""
    found = [(file, open_log(file.path, chart.hints)) for file in run.files]
    stems = Counter(file.stem for file, source in found if not isinstance(source, Refusal))
    opened: list[OpenedLog] = []
    refused: list[RefusedLog] = []
    for file, source in found:
        if isinstance(source, Refusal):
            refused.append(RefusedLog(run, file, file.path.name, source))
            continue
        recording = file.stem if stems[file.stem] == 1 else file.path.name
        joint = _file_joint(file, settings, chart)
        channels = _channels(source.columns, chart, joint)
        if isinstance(channels, Refusal):
            refused.append(RefusedLog(run, file, recording, channels))
            continue
        joints = assign(channels, source.columns, joints=settings.joints, file_joint=joint)
        if isinstance(joints, Refusal):
            refused.append(RefusedLog(run, file, recording, joints))
            continue
        opened.append(OpenedLog(run, file, recording, source, channels, joints))
    return opened, refused


def _file_joint(file: LogFile, settings: IngestSettings, chart: ChannelMap) -> int:
    """Return the joint of columns that name none."""
    if chart.joint is not None:
        return chart.joint
    in_name = joint_in_name(file.stem)
    if in_name is not None:
        return in_name
    if settings.joints is not None and len(settings.joints) == 1:
        return settings.joints[0]
    return 1


def _channels(
    columns: Sequence[str], chart: ChannelMap, joint: int
) -> tuple[Channel, ...] | Refusal:
    if chart.channels:
        return mapped_channels(chart, columns, joint)
    return recognise(columns)
