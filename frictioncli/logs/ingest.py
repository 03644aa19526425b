"""Stage ``ingest``: logs to the table ``samples``; the only stage that converts units."""

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from frictioncli import schemas
from frictioncli.errors import FrictionError, LogError, MappingError
from frictioncli.files import atomic_write
from frictioncli.logs.channels.channel_map import ChannelMap, is_inline, read_map
from frictioncli.logs.found_constants import found_constants
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.reading_plan import Constants, wanted_constant
from frictioncli.logs.run_logs import RunLogs, plan_run
from frictioncli.logs.runs.discovery import LogRun, Logs, discover
from frictioncli.logs.runs.manifest import read_run_manifest
from frictioncli.logs.runs.opening import RefusedLog
from frictioncli.logs.samples.log_rows import RejectedRows
from frictioncli.logs.samples.log_tables import recording_rows, rejected_files, rejected_rows
from frictioncli.logs.samples.recording import read_recording
from frictioncli.logs.samples.sample_writer import SampleWriter
from frictioncli.logs.samples.temperature_register import run_knots
from frictioncli.logs.samples.timeline import RunClock, Timeline
from frictioncli.logs.settings import AUTO, IngestSettings
from frictioncli.logs.summary import IngestedLogs, IngestSummary
from frictioncli.provenance import Provenance, sha256
from frictioncli.tables import TableWriter
from frictioncli.workfiles import SAMPLES

__all__ = ["IngestSettings", "IngestSummary", "ingest"]

_FILES_NAMED = 4
"""Reasons named in the error that no log is usable."""

_MISSING_CHANNEL = "mapped_column_missing"

_HASHED_TOGETHER = 16
"""Files per task of the hashing thread: the threads have to wait for one another at each task."""


def ingest(logs: Logs, work: Path, settings: IngestSettings | None = None) -> IngestSummary:
    """Read logs and write ``samples``, ``recordings`` and ``rejected`` to the work folder.

    Parameters
    ----------
    logs : Logs
        Log files, or folders of them, each folder a run; or the runs by name.
    work : Path
        The work folder.
    settings : IngestSettings, optional
        Settings of the user.

    Returns
    -------
    IngestSummary
        What was read, kept and rejected, and the assumptions made.

    Raises
    ------
    LogError
        If no log is usable, or the logs differ in unit or side of the torque.
    MappingError
        If the mapping file or a manifest cannot be followed.
    """
    settings = settings or IngestSettings()
    channel_map = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    runs = discover(logs, excluded=work)
    with _temporary_folder(work) as name, ExitStack() as stack:
        folder = Path(name)
        outputs = _Outputs(
            stack.enter_context(SampleWriter(folder)),
            stack.enter_context(_table_writer(folder, schemas.REJECTED)),
            stack.enter_context(_BackgroundHasher()),
        )
        ingested = IngestedLogs()
        constants = found_constants(runs, settings, channel_map)
        for run in runs:
            _ingest_run(run, settings, channel_map, outputs, ingested, constants)
        if not ingested.recordings:
            raise _no_usable_log(ingested.refused)
        if wanted_constant(settings, channel_map) == AUTO and not constants:
            ingested.notes.append("no torque constant is needed: no torque is a motor current")
        facts = ingested.facts()
        inputs = _input_hashes(ingested, outputs.hasher, settings)
        provenance = Provenance("ingest", settings.as_dict(), inputs)
        _write_tables(folder, work, outputs, ingested, provenance, facts)
    return ingested.summary(facts)


class _BackgroundHasher:
    """SHA-256 of files, computed in a thread while logs are read.

    Leaving the context drops what is not computed yet.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1)
        self._tasks: list[Future[dict[Path, str]]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._pool.shutdown(cancel_futures=True)

    def add(self, files: Iterable[Path]) -> None:
        """Begin to hash files, each once."""
        distinct = list(dict.fromkeys(files))
        for start in range(0, len(distinct), _HASHED_TOGETHER):
            task = self._pool.submit(_hashes, distinct[start : start + _HASHED_TOGETHER])
            self._tasks.append(task)

    def hashes(self) -> dict[Path, str]:
        """Return the SHA-256 of all files once, waiting for those that are not computed yet."""
        tasks, self._tasks = self._tasks, []
        return {file: text for task in tasks for file, text in task.result().items()}


def _hashes(files: Sequence[Path]) -> dict[Path, str]:
    return {file: sha256(file) for file in files}


@dataclass(frozen=True, slots=True)
class _Outputs:
    """Writers of samples and rejected rows, and the hasher of the logs."""

    samples: SampleWriter
    rejected: TableWriter
    hasher: _BackgroundHasher


def _temporary_folder(work: Path) -> tempfile.TemporaryDirectory[str]:
    """Return a temporary folder on the disk of the work folder, which need not exist yet."""
    parent = work.resolve()
    while not parent.is_dir():
        if parent.exists():
            raise FrictionError(f"{work}: {parent} is a file; choose another folder with -w")
        parent = parent.parent
    try:
        return tempfile.TemporaryDirectory(prefix=".reading.", dir=parent)
    except OSError as error:
        raise FrictionError(
            f"{work}: cannot be written ({error.strerror}); choose another folder with -w"
        ) from error


def _table_writer(folder: Path, table: schemas.Table) -> TableWriter:
    return TableWriter(folder / f"{table.name}.parquet", table, Provenance("ingest"))


def _ingest_run(
    run: LogRun,
    settings: IngestSettings,
    channel_map: ChannelMap,
    outputs: _Outputs,
    ingested: IngestedLogs,
    constants: Constants,
) -> None:
    """Read all logs of a run."""
    manifest = read_run_manifest(run.folder, [file.path.name for file in run.files])
    logs = plan_run(run, manifest, settings, channel_map, outputs.hasher.add, constants)
    ingested.warnings += manifest.warnings
    ingested.refused += logs.refused
    clock = _read_logs(run, logs, settings.batch_bytes, outputs, ingested)
    timeline = clock.timeline(has_manifest=manifest.found)
    if timeline.placed:
        ingested.timelines[run.name] = timeline
        ingested.warnings += timeline.warnings
        _add_knots(run.name, timeline, ingested)


def _read_logs(
    run: LogRun, logs: RunLogs, batch_bytes: int, outputs: _Outputs, ingested: IngestedLogs
) -> RunClock:
    """Write the samples of all logs; those that turn out unusable are added to the refused."""
    clock = RunClock(run.name)
    continuous: set[int] = set()
    for dated, start, chunks in logs.recordings(clock, batch_bytes):
        log, joints = dated.planned.log, [plan.channels.joint for plan in dated.planned.plans]
        outputs.samples.begin_recording(run.name, log.recording, joints, start)
        rejected = RejectedRows()
        result = read_recording(
            dated.planned,
            chunks,
            rejected,
            outputs.samples.add,
            continuous,
            ingested.poses,
            dated.payloads,
        )
        if isinstance(result, Refusal):
            outputs.samples.discard_recording(joints)
            ingested.refused.append(RefusedLog(run, log.file, log.recording, result))
            continue
        clock.place(dated, result)
        continuous.update(joint for joint, reg in result.registers.items() if reg.continuous)
        for rows in rejected_rows(log, rejected, batch_bytes):
            outputs.rejected.write(rows)
    return clock


def _add_knots(run: str, timeline: Timeline, ingested: IngestedLogs) -> None:
    """Add the knots of the motor temperatures of a run."""
    for joint in timeline.joints:
        knots = run_knots(timeline.registers(joint), starts_known=timeline.known)
        ingested.knots[run, joint] = knots


def _write_tables(
    folder: Path,
    work: Path,
    outputs: _Outputs,
    ingested: IngestedLogs,
    provenance: Provenance,
    facts: Mapping[str, Any],
) -> None:
    """Complete the three tables in the temporary folder and move them to the work folder."""
    outputs.rejected.write(rejected_files(ingested.refused))
    outputs.rejected.provenance, outputs.rejected.facts = provenance, facts
    outputs.rejected.close()
    with _table_writer(folder, schemas.RECORDINGS) as recordings:
        recordings.provenance, recordings.facts = provenance, facts
        for run, timeline in ingested.timelines.items():
            for rows in recording_rows(run, timeline.placed):
                recordings.write(rows)
    outputs.samples.finish(folder / SAMPLES, ingested.knots, provenance, facts)
    for table in (schemas.REJECTED, schemas.RECORDINGS, schemas.SAMPLES):
        with atomic_write(work / f"{table.name}.parquet") as place:
            os.replace(folder / place.name, place)


def _input_hashes(
    ingested: IngestedLogs, hasher: _BackgroundHasher, settings: IngestSettings
) -> dict[str, str]:
    """Return run and file name -> SHA-256 of all files that samples come from."""
    hashes, map_file = hasher.hashes(), settings.map_file
    inputs = {
        f"{recording.log.run.name}/{file.name}": hashes[file]
        for recording in ingested.recordings
        for file in recording.log.source.files
    }
    if map_file is None or is_inline(map_file):
        return inputs
    return inputs | {map_file.name: sha256(map_file)}


def _no_usable_log(refused: Sequence[RefusedLog]) -> FrictionError:
    """Return the error that names the first few files and why they cannot be used."""
    # files that cannot be logs say little: name the logs first
    ordered = sorted(
        refused, key=lambda log: log.refusal.reason in ("not_a_log", "format_not_read")
    )
    # a file may hold several logs
    alike: dict[str, dict[Path, None]] = {}
    for log in ordered:
        alike.setdefault(log.refusal.text, {})[log.file.path] = None
    lines = []
    for text, paths in list(alike.items())[:_FILES_NAMED]:
        others = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
        lines.append(f"{next(iter(paths))}{others}: {text}")
    unnamed = sum(len(paths) for paths in list(alike.values())[_FILES_NAMED:])
    if unnamed:
        lines.append(f"and {unnamed} more files")
    kind = (
        MappingError if any(log.refusal.reason == _MISSING_CHANNEL for log in refused) else LogError
    )
    return kind("no usable log; " + "; ".join(lines))
