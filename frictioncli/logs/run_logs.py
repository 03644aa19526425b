"""Logs of one run: opened, planned, and read one after the other in the order of time."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.reading_plan import Constants, planned_logs
from frictioncli.logs.runs.discovery import LogRun
from frictioncli.logs.runs.manifest import RunManifest
from frictioncli.logs.runs.opening import RefusedLog, open_run
from frictioncli.logs.samples.chunks import LogChunk
from frictioncli.logs.samples.read_ahead import read_chunks
from frictioncli.logs.samples.timeline import DatedLog, RunClock, in_time_order
from frictioncli.logs.settings import IngestSettings


@dataclass(frozen=True, slots=True)
class RunLogs:
    """Logs of one run, ready to be read.

    Attributes
    ----------
    logs : tuple of DatedLog
        The logs that can be read, in the order of time.
    refused : tuple of RefusedLog
        The files that cannot be read, with the reason.
    """

    logs: tuple[DatedLog, ...]
    refused: tuple[RefusedLog, ...]

    def recordings(
        self, clock: RunClock, batch_bytes: int
    ) -> Iterator[tuple[DatedLog, float, Iterator[LogChunk]]]:
        """Yield each log with its start since the run's first sample [s], and its chunks.

        Parameters
        ----------
        clock : RunClock
            Time axis of the run; the caller places every recording on it before the next one.
        batch_bytes : int
            Size of a chunk in the file. [byte]
        """
        logs_with_chunks = read_chunks([log.planned for log in self.logs], batch_bytes)
        for log, (_, chunks) in zip(self.logs, logs_with_chunks, strict=True):
            yield log, clock.start_of(log), chunks


def plan_run(
    run: LogRun,
    manifest: RunManifest,
    settings: IngestSettings,
    channel_map: ChannelMap,
    opened: Callable[[Iterable[Path]], None] = lambda _: None,
    constants: Constants | None = None,
) -> RunLogs:
    """Open the logs of a run, survey their units, and put them in the order of time.

    Parameters
    ----------
    run : LogRun
        The run.
    manifest : RunManifest
        Its manifest.
    settings : IngestSettings
        Settings of the user.
    channel_map : ChannelMap
        Mapping file of the user.
    opened : callable, optional
        Called with the files of the logs that could be opened, before the survey reads them.
    constants : mapping of int to TorqueConstant or Refusal, optional
        Torque constants found, see :mod:`frictioncli.logs.found_constants`.

    Raises
    ------
    OptionError
        If one gear ratio or one torque constant is given for several joints.
    """
    logs, refused = open_run(run, settings, channel_map)
    opened(file for log in logs for file in log.source.files)
    planned, unusable = planned_logs(logs, settings, channel_map, constants)
    return RunLogs(tuple(in_time_order(planned, manifest.entries)), (*refused, *unusable))
