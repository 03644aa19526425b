"""Look at logs as they would be read, each in one pass, and write nothing."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import pandas as pd
import pyarrow as pa

from frictioncli.errors import LogError, MappingError
from frictioncli.inspection.brakes import closed_seconds
from frictioncli.inspection.findings import FileInspection
from frictioncli.inspection.monitors.log_monitor import LogMonitor
from frictioncli.inspection.other_clocks import other_clocks
from frictioncli.inspection.pair_check import NO_MOVES, Moves, segments_and_pairs
from frictioncli.inspection.sample_buffer import SampleBuffer, gathered
from frictioncli.inspection.sufficiency import JointSummary, Recordings, joint_data
from frictioncli.inspection.unit_reasons import other_remarks
from frictioncli.inspection.unusable_file import inspect_unusable
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.reading_plan import planned_logs
from frictioncli.logs.runs import manifest
from frictioncli.logs.runs.discovery import LogRun, discover
from frictioncli.logs.runs.opening import open_run
from frictioncli.logs.samples.chunks import Chunk, PlannedLog, chunks_of
from frictioncli.logs.samples.recording import RecordingSummary, record
from frictioncli.logs.samples.row_checks import RejectedRows
from frictioncli.logs.samples.timeline import DatedLog, RunClock, in_time_order
from frictioncli.logs.settings import IngestSettings
from frictioncli.pairs.settings import PairingSettings

_SPOOL = "samples.arrow"


@dataclass(frozen=True, slots=True)
class Inspection:
    """What logs hold.

    Attributes
    ----------
    files : tuple of FileInspection
        One per file, in the order of runs and names.
    joints : tuple of JointSummary
        What all of them together hold of each joint, and for which stages it suffices.
    remarks : tuple of str
        What is to be said of runs as a whole.
    """

    files: tuple[FileInspection, ...]
    joints: tuple[JointSummary, ...]
    remarks: tuple[str, ...]


def inspect(
    logs: Sequence[Path],
    settings: IngestSettings | None = None,
    pairing: PairingSettings | None = None,
) -> Inspection:
    """Look at logs as ``ingest`` would read them, and write nothing.

    Parameters
    ----------
    logs : sequence of Path
        Log files, or folders of them.
    settings : IngestSettings, optional
        What the user knows beyond the logs.
    pairing : PairingSettings, optional
        What makes a pair.

    Returns
    -------
    Inspection
        What each file holds, and what all of them suffice for.

    Raises
    ------
    LogError, MappingError
        If a path does not exist, or the mapping file cannot be followed.
    FrictionError
        If the temporary folder (variable TMPDIR) cannot hold the samples of a log for a while.
    """
    settings = settings or IngestSettings()
    pairing = pairing or PairingSettings()
    channel_map = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    harvest = _State()
    with tempfile.TemporaryDirectory(prefix="frictioncli-") as name:
        folder = Path(name)
        samples = _samples(discover(logs), settings, channel_map, folder / _SPOOL, harvest)
        moves, pairs = segments_and_pairs(gathered(samples), harvest.said, pairing, folder)
    return Inspection(
        files=tuple(_with_moves(file, moves) for file in harvest.files),
        joints=tuple(
            joint_data(
                joint,
                _in_all(moves, joint),
                harvest.recordings(joint),
                pairs[pairs["joint"] == joint],
            )
            for joint in harvest.joints
        ),
        remarks=tuple(harvest.remarks),
    )


@dataclass(slots=True)
class _State:
    """What has been seen so far."""

    files: list[FileInspection] = field(default_factory=list)
    dated: list[DatedLog] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    time_known: bool = True

    @property
    def joints(self) -> tuple[int, ...]:
        return tuple(sorted({plan.channels.joint for d in self.dated for plan in d.reading.plans}))

    def recordings(self, joint: int) -> Recordings:
        """Return what is known of the recordings of a joint."""
        runs = [
            dated.reading.log.run.name
            for dated in self.dated
            if any(plan.channels.joint == joint for plan in dated.reading.plans)
        ]
        return Recordings(len(set(runs)), len(runs), self.time_known)

    def said(self) -> pd.DataFrame:
        """Return phase and payload [kg] by run and recording, missing where nothing tells them."""
        rows = [
            (d.reading.log.run.name, d.reading.log.recording, d.entry and d.entry.phase, d.payload)
            for d in self.dated
        ]
        frame = pd.DataFrame(rows, columns=["run", "recording", "phase", "payload"])
        types = {"phase": object, "payload": float}
        return frame.astype(types).set_index(["run", "recording"])


def _samples(
    runs: Sequence[LogRun],
    settings: IngestSettings,
    channel_map: ChannelMap,
    spool: Path,
    harvest: _State,
) -> Iterator[pa.RecordBatch]:
    """Yield the samples of all logs, run by run in order of time; what is seen goes to harvest."""
    for run in runs:
        found: dict[Path, FileInspection] = {}
        opened, refused = open_run(run, settings, channel_map)
        usable, unusable = planned_logs(opened, settings, channel_map)
        for log in (*refused, *unusable):
            found[log.file.path] = inspect_unusable(
                run, log.file.path, log.refusal, channel_map, settings
            )
        clock = RunClock(run.name)
        queue = _in_time_order(run, usable, harvest)
        in_turn = chunks_of([dated.reading for dated in queue], settings.batch_bytes)
        for dated, (_, parts) in zip(queue, in_turn, strict=True):
            samples = SampleBuffer(
                spool, run.name, dated.reading.log.recording, clock.start_of(dated)
            )
            file, recorded = _look(dated.reading, parts, samples, settings)
            found[file.path] = file
            if recorded is not None:
                clock.place(dated, recorded)
                harvest.dated.append(dated)
                yield from samples.samples()
        timeline = clock.timeline(has_manifest=(run.folder / manifest.NAME).is_file())
        harvest.time_known &= timeline.known
        harvest.remarks += timeline.warnings
        harvest.files += [found[file.path] for file in run.files if file.path in found]


def _in_time_order(run: LogRun, usable: Sequence[PlannedLog], harvest: _State) -> list[DatedLog]:
    """Return the logs of a run in the order of their starts."""
    entries: Mapping[str, manifest.Entry] = {}
    path = run.folder / manifest.NAME
    if path.is_file():
        try:
            rows = manifest.read_manifest(path)
            entries = manifest.match(rows, [file.path.name for file in run.files])
        except MappingError as error:
            harvest.remarks.append(f"the manifest cannot be used: {error}")
    return in_time_order(usable, entries)


def _look(
    reading: PlannedLog, parts: Iterator[Chunk], samples: SampleBuffer, settings: IngestSettings
) -> tuple[FileInspection, RecordingSummary | None]:
    """Return what one log holds; its samples go to the spool."""
    watch, faults = LogMonitor(reading), RejectedRows()
    try:
        result = record(reading, watch.over(parts), faults, samples.add)
    except LogError as error:
        result = Refusal("contradicts_survey", str(error))
    samples.close()
    log = reading.log
    found = FileInspection(
        path=log.file.path,
        run=log.run.name,
        recording=log.recording,
        form=log.source.form,
        columns=len(log.source.columns),
        rows=watch.rows,
        rejected=faults.counts(),
        sampling=watch.sampling(),
        joints=watch.joints(settings.forced_units()),
        notes=tuple(dict.fromkeys(text for plan in reading.plans for text in other_remarks(plan))),
    )
    if isinstance(result, Refusal):
        return replace(found, reason=result.reason, refusal=result.text), None
    joints = tuple(
        replace(joint, brake_closed_s=closed_seconds(log.source, plan, settings.batch_bytes))
        for joint, plan in zip(found.joints, reading.plans, strict=True)
    )
    clocks = other_clocks(log.source, reading.plans[0], settings.batch_bytes)
    return replace(found, rows_kept=result.rows_kept, joints=joints, clocks=clocks), result


def _with_moves(file: FileInspection, moves: Moves) -> FileInspection:
    """Return the same with the constant-speed parts of each joint."""
    joints = tuple(
        replace(joint, moves=dict(moves.get((file.run, file.recording, joint.joint), NO_MOVES)))
        for joint in file.joints
    )
    return replace(file, joints=joints)


def _in_all(moves: Moves, joint: int) -> dict[str, int]:
    """Return how often a joint holds a constant speed in all recordings together."""
    own = [counts for (_, _, number), counts in moves.items() if number == joint]
    return {way: sum(counts[way] for counts in own) for way in NO_MOVES}
