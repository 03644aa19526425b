"""Logs to ``samples``: the first stage, and the only one that converts units."""

import tempfile
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from frictioncli.errors import FrictionError, LogError, MappingError
from frictioncli.provenance import Provenance, sha256
from frictioncli.reading import manifest
from frictioncli.reading.companion import started_at
from frictioncli.reading.discovery import Run, discover
from frictioncli.reading.formats.base import Refusal
from frictioncli.reading.history import known_temperatures
from frictioncli.reading.mapping import ChannelMap, read_map
from frictioncli.reading.opening import RefusedLog, open_run
from frictioncli.reading.planning import planned
from frictioncli.reading.recording import Recorded, read_recording
from frictioncli.reading.rows import REASONS
from frictioncli.reading.settings import IngestSettings
from frictioncli.reading.staircase import Knots
from frictioncli.reading.summary import IngestSummary, RejectedFile, grouped
from frictioncli.reading.timeline import Timeline, place
from frictioncli.reading.writing import write_tables

__all__ = ["IngestSettings", "IngestSummary", "ingest"]

_FEW = 4
_MISSING_CHANNEL = "mapped_column_missing"


def ingest(
    logs: Sequence[Path], work: Path, settings: IngestSettings | None = None
) -> IngestSummary:
    """Read logs and write ``samples``, ``recordings`` and ``rejected`` to the work folder.

    Parameters
    ----------
    logs : sequence of Path
        Log files, or folders of them; each folder is a run.
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
    chart = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    runs = discover(logs, besides=work)
    with _spool_folder(work) as folder:
        harvest = _Harvest()
        for run in runs:
            _read_run(run, settings, chart, Path(folder), harvest)
        if not harvest.recordings:
            raise _nothing_left(harvest.refused)
        facts = _facts(harvest)
        provenance = Provenance(
            "ingest", settings.as_dict(), _inputs(harvest.recordings, settings.map_file)
        )
        write_tables(
            work,
            harvest.timelines,
            harvest.temperatures,
            harvest.refused,
            provenance,
            facts,
            batch_bytes=settings.batch_bytes,
        )
    return _summary(harvest, facts)


@dataclass(slots=True)
class _Harvest:
    """What has been read so far; samples themselves lie in spool files."""

    timelines: dict[str, Timeline] = field(default_factory=dict)
    temperatures: dict[tuple[str, int], tuple[Knots | None, ...]] = field(default_factory=dict)
    refused: list[RefusedLog] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def recordings(self) -> list[Recorded]:
        """All recordings, run by run, in order of time."""
        return [placed.recorded for line in self.timelines.values() for placed in line.placed]


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


def _manifest(run: Run) -> tuple[dict[str, manifest.Entry], bool, list[str]]:
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


def _headers(recordings: Sequence[Recorded]) -> dict[str, datetime]:
    """Return file name -> start, of logs beside which a header tells it."""
    found = {r.log.file.path.name: started_at(r.log.file.path) for r in recordings}
    return {name: start for name, start in found.items() if start is not None}


def _read_run(
    run: Run, settings: IngestSettings, chart: ChannelMap, folder: Path, harvest: _Harvest
) -> None:
    """Read all logs of a run into spool files and put them in order of time."""
    entries, has_manifest, said = _manifest(run)
    harvest.warnings += said
    spools = Path(tempfile.mkdtemp(dir=folder))
    recorded = _read_logs(run, settings, chart, spools, harvest.refused)
    if not recorded:
        return
    headers = _headers(recorded)
    if headers:
        harvest.notes.append(
            f"run {run.name}: start times of {len(headers)} logs from the .dat headers beside them"
        )
    timeline = place(run.name, recorded, entries, headers, has_manifest)
    harvest.timelines[run.name] = timeline
    harvest.warnings += timeline.warnings
    for joint in timeline.joints:
        points = known_temperatures(timeline, joint)
        harvest.temperatures[run.name, joint] = points
        distinct = {id(known): known for known in points if known is not None}.values()
        if distinct:
            count = sum(known.n_changes for known in distinct)
            harvest.notes.append(
                f"run {run.name}: motor temperature of joint {joint} has steps of"
                f" {next(iter(distinct)).step:g} °C: rebuilt between {count} known changes"
            )


def _read_logs(
    run: Run, settings: IngestSettings, chart: ChannelMap, folder: Path, refused: list[RefusedLog]
) -> list[Recorded]:
    """Read the logs of a run; those that cannot be used join ``refused``."""
    opened, closed = open_run(run, settings, chart)
    refused += closed
    recorded: list[Recorded] = []
    for log, plans in planned(opened, settings, chart):
        stem = folder / str(len(refused) + len(recorded))
        result = (
            plans
            if isinstance(plans, Refusal)
            else read_recording(log, plans, stem, settings.batch_bytes)
        )
        if isinstance(result, Refusal):
            refused.append(RefusedLog(run, log.file, log.recording, result))
        else:
            recorded.append(result)
    return recorded


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


def _facts(harvest: _Harvest) -> dict[str, Any]:
    """Return what later stages must know beside the columns."""
    plans = [
        (f"{r.log.run.name}/{r.log.file.path.name}", plan)
        for r in harvest.recordings
        for plan in r.plans
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


def _inputs(recordings: Sequence[Recorded], map_file: Path | None) -> dict[str, str]:
    inputs = {f"{r.log.run.name}/{r.log.file.path.name}": r.log.file.path for r in recordings}
    if map_file is not None:
        inputs[map_file.name] = map_file
    return {name: sha256(path) for name, path in inputs.items()}


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


def _summary(harvest: _Harvest, facts: Mapping[str, Any]) -> IngestSummary:
    rejected: Counter[str] = Counter()
    samples: Counter[int] = Counter()
    recordings = harvest.recordings
    for recorded in recordings:
        rejected.update(REASONS[code] for code in recorded.rejected[1])
        samples.update({joint: recorded.rows_kept for joint in recorded.spools})
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
