"""Logs to ``samples``: the first stage, and the only one that converts units."""

import os
import tempfile
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frictioncli import schemas
from frictioncli.errors import FrictionError, LogError, MappingError
from frictioncli.files import whole
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.reading_plan import planned_logs
from frictioncli.logs.runs import manifest
from frictioncli.logs.runs.discovery import LogRun, Logs, discover
from frictioncli.logs.runs.hashing import Hashing
from frictioncli.logs.runs.opening import RefusedLog, open_run
from frictioncli.logs.samples.chunks import chunks_of
from frictioncli.logs.samples.log_tables import recording_rows, rejected_files, rejected_rows
from frictioncli.logs.samples.quantized_temperature import Knots
from frictioncli.logs.samples.recording import RecordingSummary, record
from frictioncli.logs.samples.row_checks import RejectedRows
from frictioncli.logs.samples.sample_writer import SampleWriter
from frictioncli.logs.samples.temperature_history import run_knots
from frictioncli.logs.samples.timeline import DatedLog, RunClock, Timeline, in_time_order
from frictioncli.logs.settings import IngestSettings
from frictioncli.logs.summary import IngestSummary, RejectedFile, grouped
from frictioncli.provenance import Provenance, sha256
from frictioncli.tables import TableWriter
from frictioncli.workfiles import SAMPLES

__all__ = ["IngestSettings", "IngestSummary", "ingest"]

_FEW = 4
_MISSING_CHANNEL = "mapped_column_missing"


def ingest(logs: Logs, work: Path, settings: IngestSettings | None = None) -> IngestSummary:
    """Read logs and write ``samples``, ``recordings`` and ``rejected`` to the work folder.

    Parameters
    ----------
    logs : Logs
        Log files, or folders of them, each folder a run; or the runs by name.
    work : Path
        The work folder.
    settings : IngestSettings, optional
        What the user knows beyond the logs.

    Returns
    -------
    IngestSummary
        What was read, kept, rejected and believed.

    Raises
    ------
    LogError
        If nothing usable is left, or logs of one call disagree in torque unit or side.
    MappingError
        If the mapping file or a manifest cannot be followed.
    """
    settings = settings or IngestSettings()
    channel_map = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    runs = discover(logs, excluded=work)
    with _spool_folder(work) as name, ExitStack() as stack:
        desk = _Context(
            settings,
            channel_map,
            stack.enter_context(SampleWriter(Path(name))),
            stack.enter_context(_writer(Path(name), schemas.REJECTED)),
            stack.enter_context(Hashing()),
        )
        harvest = _State()
        for run in runs:
            _read_run(run, desk, harvest)
        if not harvest.recordings:
            raise _nothing_left(harvest.refused)
        facts = _facts(harvest)
        provenance = Provenance("ingest", settings.as_dict(), _inputs(harvest, desk))
        _finish(Path(name), work, desk, harvest, provenance, facts)
    return _summary(harvest, facts)


@dataclass(frozen=True, slots=True)
class _Context:
    """What reading works with: settings, and where samples, rejected rows and hashes go."""

    settings: IngestSettings
    channel_map: ChannelMap
    drafts: SampleWriter
    rejected: TableWriter
    hashing: Hashing


@dataclass(slots=True)
class _State:
    """What has been read so far; samples themselves lie in drafts."""

    timelines: dict[str, Timeline] = field(default_factory=dict)
    temperatures: dict[tuple[str, int], tuple[Knots | None, ...]] = field(default_factory=dict)
    refused: list[RefusedLog] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def recordings(self) -> list[RecordingSummary]:
        """All recordings, run by run, in order of time."""
        return [placed.recorded for line in self.timelines.values() for placed in line.placed]


def _writer(folder: Path, table: schemas.Table) -> TableWriter:
    return TableWriter(folder / f"{table.name}.parquet", table, Provenance("ingest"))


def _finish(
    folder: Path,
    work: Path,
    desk: _Context,
    harvest: _State,
    provenance: Provenance,
    facts: Mapping[str, Any],
) -> None:
    """Write what is left to write and put the three tables into the work folder."""
    desk.rejected.write(rejected_files(harvest.refused))
    desk.rejected.provenance, desk.rejected.facts = provenance, facts
    desk.rejected.close()
    with _writer(folder, schemas.RECORDINGS) as recordings:
        recordings.provenance, recordings.facts = provenance, facts
        for run, timeline in harvest.timelines.items():
            recordings.write(recording_rows(run, timeline.placed))
    desk.drafts.finish(folder / SAMPLES, harvest.temperatures, provenance, facts)
    for table in (schemas.REJECTED, schemas.RECORDINGS, schemas.SAMPLES):
        with whole(work / f"{table.name}.parquet") as place:
            os.replace(folder / place.name, place)


def _spool_folder(work: Path) -> tempfile.TemporaryDirectory[str]:
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


def _manifest(run: LogRun) -> tuple[dict[str, manifest.Entry], bool, list[str]]:
    """Return file name -> manifest row, whether there is a manifest, and warnings."""
    path = run.folder / manifest.NAME
    if not path.is_file():
        return {}, False, []
    rows = manifest.read_manifest(path)
    matched = manifest.match(rows, [file.path.name for file in run.files])
    present = {entry.file for entry in matched.values()}
    present |= {path.name for path in run.folder.iterdir()}
    warnings = [
        f"{path} row {row.row}: {row.file} is not in the folder"
        for row in rows
        if row.file not in present
    ]
    return matched, True, warnings


def _read_run(run: LogRun, desk: _Context, harvest: _State) -> None:
    """Read all logs of a run in order of time."""
    entries, has_manifest, said = _manifest(run)
    harvest.warnings += said
    opened, refused = open_run(run, desk.settings, desk.channel_map)
    # hashed while the logs are looked at and read
    desk.hashing.ask(file for log in opened for file in log.source.files)
    found, unusable = planned_logs(opened, desk.settings, desk.channel_map)
    harvest.refused += refused + unusable
    clock = _read_logs(run, in_time_order(found, entries), desk, harvest)
    timeline = clock.timeline(has_manifest=has_manifest)
    if not timeline.placed:
        return
    harvest.timelines[run.name] = timeline
    harvest.warnings += timeline.warnings
    for joint in timeline.joints:
        points = run_knots(timeline, joint)
        harvest.temperatures[run.name, joint] = points
        distinct = {id(known): known for known in points if known is not None}.values()
        if distinct:
            count = sum(known.n_changes for known in distinct)
            harvest.notes.append(
                f"run {run.name}: motor temperature of joint {joint} has steps of"
                f" {next(iter(distinct)).step:g} °C: rebuilt between {count} known changes"
            )


def _read_logs(run: LogRun, queue: Sequence[DatedLog], desk: _Context, harvest: _State) -> RunClock:
    """Read logs one after the other; those that cannot be used join the refused."""
    clock = RunClock(run.name)
    size = desk.settings.batch_bytes
    smooth: set[int] = set()
    in_turn = chunks_of([dated.reading for dated in queue], size)
    for dated, (reading, parts) in zip(queue, in_turn, strict=True):
        log, joints = reading.log, [plan.channels.joint for plan in reading.plans]
        desk.drafts.begin(run.name, log.recording, joints, clock.start_of(dated))
        faults = RejectedRows()
        result = record(reading, parts, faults, desk.drafts.add, smooth)
        if isinstance(result, Refusal):
            desk.drafts.forget(joints)
            harvest.refused.append(RefusedLog(run, log.file, log.recording, result))
            continue
        clock.place(dated, result)
        smooth.update(joint for joint, shown in result.registers.items() if shown.smooth)
        for rows in rejected_rows(log, faults, size):
            desk.rejected.write(rows)
    return clock


def _common(what: str, values: Iterable[tuple[str, str]]) -> str:
    """Return the value that all logs share."""
    first: dict[str, str] = {}
    for name, value in values:
        first.setdefault(value, name)
    if len(first) > 1:
        found = "; ".join(f"{value} in {name}" for value, name in first.items())
        raise LogError(
            f"the logs differ in {what}: {found}; expected the same in all: read them in separate"
            " calls, choose joints, or choose the torque column with --map"
        )
    return next(iter(first))


def _facts(harvest: _State) -> dict[str, Any]:
    """Return what later stages must know beside the columns."""
    plans = [
        (f"{r.log.run.name}/{r.log.file.path.name}", plan)
        for r in harvest.recordings
        for plan in r.reading.plans
    ]
    total = len(harvest.recordings)
    notes = grouped(((name, text) for name, plan in plans for text in plan.notes), total)
    warnings = grouped(((name, text) for name, plan in plans for text in plan.warnings), total)
    return {
        "torque_unit": _common("torque unit", ((n, plan.torque_unit) for n, plan in plans)),
        "torque_side": _common("side of the torque", ((n, plan.torque_side) for n, plan in plans)),
        "notes": [*notes, *harvest.notes],
        "warnings": [*warnings, *harvest.warnings],
        "time_known": all(timeline.known for timeline in harvest.timelines.values()),
    }


def _inputs(harvest: _State, desk: _Context) -> dict[str, str]:
    """Return run and file name -> SHA-256 of all files that samples come from."""
    hashes, map_file = desk.hashing.found(), desk.settings.map_file
    inputs = {
        f"{r.log.run.name}/{file.name}": hashes[file]
        for r in harvest.recordings
        for file in r.log.source.files
    }
    return inputs if map_file is None else inputs | {map_file.name: sha256(map_file)}


def _nothing_left(refused: Sequence[RefusedLog]) -> FrictionError:
    """Return the error that names the first few files and why they cannot be used."""
    # what cannot be a log says little: name the text logs first
    ordered = sorted(
        refused, key=lambda log: log.refusal.reason in ("not_a_log", "format_not_read")
    )
    lines = [f"{log.file.path}: {log.refusal.text}" for log in ordered[:_FEW]]
    if len(ordered) > _FEW:
        lines.append(f"and {len(ordered) - _FEW} more files")
    kind = (
        MappingError if any(log.refusal.reason == _MISSING_CHANNEL for log in refused) else LogError
    )
    return kind("no usable log; " + "; ".join(lines))


def _summary(harvest: _State, facts: Mapping[str, Any]) -> IngestSummary:
    rejected: Counter[str] = Counter()
    samples: Counter[int] = Counter()
    recordings = harvest.recordings
    for recorded in recordings:
        rejected.update(recorded.rejected)
        samples.update(dict.fromkeys(recorded.joints, recorded.rows_kept))
    return IngestSummary(
        runs=tuple(harvest.timelines),
        files_read=len(recordings),
        files_rejected=tuple(
            RejectedFile(
                run=log.run.name,
                file=log.file.path.name,
                reason=log.refusal.reason,
                text=log.refusal.text,
            )
            for log in harvest.refused
        ),
        rows_read=sum(r.rows_read for r in recordings),
        rows_kept=sum(r.rows_kept for r in recordings),
        rows_rejected=dict(rejected),
        samples=dict(sorted(samples.items())),
        torque_unit=facts["torque_unit"],
        torque_side=facts["torque_side"],
        duration=sum(r.duration for r in recordings),
        time_known=facts["time_known"],
        notes=tuple(facts["notes"]),
        warnings=tuple(facts["warnings"]),
    )
