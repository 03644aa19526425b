"""Inspection of logs: what they hold and what they suffice for; nothing is written."""

import tempfile
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import pandas as pd
import pyarrow as pa

from frictioncli.errors import LogError, MappingError
from frictioncli.inspection.brakes import closed_seconds
from frictioncli.inspection.findings import FileInspection
from frictioncli.inspection.monitors.log_monitor import LogMonitor
from frictioncli.inspection.other_clocks import other_clocks
from frictioncli.inspection.pair_check import NO_SEGMENTS, SegmentCounts, segments_and_pairs
from frictioncli.inspection.sample_store import (
    SampleStore,
    combined,
    store_samples,
    stored_samples,
)
from frictioncli.inspection.sufficiency import JointSummary, RecordingCounts, joint_summary
from frictioncli.inspection.unit_reasons import other_remarks
from frictioncli.inspection.unusable_file import inspect_unusable
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.channels.channel_names import INTEGRATED
from frictioncli.logs.found_constants import found_constants
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.reading_plan import Constants
from frictioncli.logs.run_logs import plan_run
from frictioncli.logs.runs.discovery import LogRun, discover
from frictioncli.logs.runs.manifest import RunManifest, read_run_manifest
from frictioncli.logs.samples.chunks import LogChunk
from frictioncli.logs.samples.log_rows import RejectedRows
from frictioncli.logs.samples.poses import Poses
from frictioncli.logs.samples.recording import RecordingSummary, SampleSink, read_recording
from frictioncli.logs.samples.timeline import DatedLog, RunClock
from frictioncli.logs.settings import IngestSettings
from frictioncli.pairs.segments import without_angle
from frictioncli.pairs.settings import PairingSettings


@dataclass(frozen=True, slots=True)
class Inspection:
    """Result of an inspection.

    Attributes
    ----------
    files : tuple of FileInspection
        One per file, in the order of runs and names.
    joints : tuple of JointSummary
        What all files together hold of each joint, and for which stages it suffices.
    remarks : tuple of str
        Remarks on whole runs.
    """

    files: tuple[FileInspection, ...]
    joints: tuple[JointSummary, ...]
    remarks: tuple[str, ...]


def inspect(
    logs: Sequence[Path],
    settings: IngestSettings | None = None,
    pairing: PairingSettings | None = None,
) -> Inspection:
    """Inspect logs as ``ingest`` would read them, without writing anything.

    Parameters
    ----------
    logs : sequence of Path
        Log files, or folders of them.
    settings : IngestSettings, optional
        Settings of reading.
    pairing : PairingSettings, optional
        Settings of the stage ``pair``.

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
    runs = discover(logs)
    inspected = _InspectedLogs(found_constants(runs, settings, channel_map))
    with tempfile.TemporaryDirectory(prefix="frictioncli-") as name:
        folder = Path(name)
        samples = (
            batch
            for run in runs
            for batch in _inspect_run(run, settings, channel_map, folder, inspected)
        )
        segments, pairs, other_motion = segments_and_pairs(
            combined(samples), inspected.conditions, pairing, folder
        )
    found = {joint.joint: joint for file in inspected.files for joint in file.joints}
    inspected.remarks += other_motion.texts(pairs["joint"].unique().tolist())
    return Inspection(
        files=tuple(_with_segments(file, segments) for file in inspected.files),
        joints=tuple(
            joint_summary(
                joint,
                _total(segments, joint),
                inspected.recording_counts(joint),
                pairs[pairs["joint"] == joint],
                found[joint],
            )
            for joint in inspected.joints
        ),
        remarks=tuple(inspected.remarks),
    )


@dataclass(slots=True)
class _InspectedLogs:
    """Record of all logs inspected so far.

    ``constants`` holds the torque constants that were found, by joint. ``usable`` holds the logs
    whose samples can be used; ``time_known`` is false where start times are not known and were
    assumed.
    """

    constants: Constants
    files: list[FileInspection] = field(default_factory=list)
    usable: list[DatedLog] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    time_known: bool = True
    poses: Poses = field(default_factory=Poses)

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints of all usable logs."""
        return tuple(sorted({joint for dated in self.usable for joint in _joints(dated)}))

    def recording_counts(self, joint: int) -> RecordingCounts:
        """Return the numbers of recordings and runs of a joint."""
        runs = [dated.planned.log.run.name for dated in self.usable if joint in _joints(dated)]
        return RecordingCounts(len(set(runs)), len(runs), self.time_known)

    def conditions(self) -> pd.DataFrame:
        """Return phase and payload [kg] by run and recording, missing where not known."""
        rows = [
            (
                dated.planned.log.run.name,
                dated.planned.log.recording,
                dated.entry and dated.entry.phase,
                dated.payload,
            )
            for dated in self.usable
        ]
        frame = pd.DataFrame(rows, columns=["run", "recording", "phase", "payload"])
        types = {"phase": object, "payload": float}
        frame = frame.astype(types).set_index(["run", "recording"])
        # logs of different joints may be one recording
        return frame[~frame.index.duplicated()]


def _is_integrated(dated: DatedLog) -> bool:
    return any(plan.channels.position.name == INTEGRATED for plan in dated.planned.plans)


def _joints(dated: DatedLog) -> list[int]:
    return [plan.channels.joint for plan in dated.planned.plans]


def _inspect_run(
    run: LogRun,
    settings: IngestSettings,
    channel_map: ChannelMap,
    folder: Path,
    inspected: _InspectedLogs,
) -> Iterator[pa.RecordBatch]:
    """Yield the samples of all logs of a run in the order of time, and record what they hold."""
    manifest = _manifest(run, inspected)
    logs = plan_run(run, manifest, settings, channel_map, constants=inspected.constants)
    files: dict[Path, list[FileInspection]] = {}
    for log in logs.refused:
        found = inspect_unusable(run, log.file.path, log.refusal, channel_map, settings)
        files.setdefault(log.file.path, []).append(found)
    clock = RunClock(run.name)
    told = {*settings.forced_units(), *channel_map.units}
    for dated, start, chunks in logs.recordings(clock, settings.batch_bytes):
        with SampleStore(folder) as store:
            sink = partial(store_samples, store, dated.planned.log.recording, start)
            file, recording = _inspect_log(dated, chunks, sink, settings, told, inspected.poses)
            files.setdefault(file.path, []).append(file)
            if recording is not None:
                clock.place(dated, recording)
                inspected.usable.append(dated)
                stored = stored_samples(store, run.name)
                yield from map(without_angle, stored) if _is_integrated(dated) else stored
    timeline = clock.timeline(has_manifest=manifest.found)
    inspected.time_known &= timeline.known
    inspected.remarks += timeline.warnings
    for file_of_run in run.files:
        inspected.files += files.get(file_of_run.path, [])


def _manifest(run: LogRun, inspected: _InspectedLogs) -> RunManifest:
    """Return the manifest of a run; one that cannot be followed becomes a remark."""
    try:
        return read_run_manifest(run.folder, [file.path.name for file in run.files])
    except MappingError as error:
        inspected.remarks.append(f"the manifest cannot be used: {error}")
        return RunManifest({}, found=True)


def _inspect_log(
    dated: DatedLog,
    chunks: Iterator[LogChunk],
    sink: SampleSink,
    settings: IngestSettings,
    told: Collection[str],
    poses: Poses,
) -> tuple[FileInspection, RecordingSummary | None]:
    """Return what one log holds; its samples go to the sink, units of `told` are the user's."""
    planned = dated.planned
    monitor, rejected = LogMonitor(planned), RejectedRows()
    try:
        result = read_recording(
            planned,
            monitor.observe(chunks),
            rejected,
            sink,
            poses=poses,
            payloads=dated.payloads,
        )
    except LogError as error:
        result = Refusal("contradicts_survey", str(error))
    log = planned.log
    found = FileInspection(
        path=log.file.path,
        run=log.run.name,
        recording=log.recording,
        form=log.source.form,
        columns=len(log.source.columns),
        rows=monitor.rows_read,
        rejected=rejected.counts(),
        sampling=monitor.sampling(),
        joints=monitor.joints(told),
        notes=tuple(dict.fromkeys(text for plan in planned.plans for text in other_remarks(plan))),
    )
    if isinstance(result, Refusal):
        return replace(found, reason=result.reason, refusal=result.text), None
    joints = tuple(
        replace(joint, brake_closed_s=closed_seconds(log.source, plan, settings.batch_bytes))
        for joint, plan in zip(found.joints, planned.plans, strict=True)
    )
    clocks = other_clocks(log.source, planned.plans[0], settings.batch_bytes)
    return replace(found, rows_kept=result.rows_kept, joints=joints, clocks=clocks), result


def _with_segments(file: FileInspection, segments: SegmentCounts) -> FileInspection:
    """Return a file with the constant-speed segments of each joint."""
    joints = tuple(
        replace(
            joint, moves=dict(segments.get((file.run, file.recording, joint.joint), NO_SEGMENTS))
        )
        for joint in file.joints
    )
    return replace(file, joints=joints)


def _total(segments: SegmentCounts, joint: int) -> dict[str, int]:
    """Return the constant-speed segments of a joint in all recordings together."""
    counts_of_joint = [counts for (_, _, number), counts in segments.items() if number == joint]
    return {
        direction: sum(counts[direction] for counts in counts_of_joint) for direction in NO_SEGMENTS
    }
