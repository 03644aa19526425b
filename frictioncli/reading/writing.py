"""The second pass: spool files to the three tables, with final times and rebuilt temperatures."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from frictioncli import schemas
from frictioncli.provenance import Provenance
from frictioncli.reading import aliases as names
from frictioncli.reading import staircase
from frictioncli.reading.opening import RefusedLog
from frictioncli.reading.recording import Recorded
from frictioncli.reading.rows import REASONS
from frictioncli.reading.timeline import Placed, Timeline
from frictioncli.tables import TableWriter

_REJECTED_ROWS = 1 << 15
_GROUP_ROWS = 1 << 17
_MEASURED = (names.POSITION, names.VELOCITY, names.TORQUE)


def write_tables(
    work: Path,
    timelines: Mapping[str, Timeline],
    temperatures: Mapping[tuple[str, int], Sequence[staircase.Knots | None]],
    refused: Sequence[RefusedLog],
    provenance: Provenance,
    facts: Mapping[str, Any],
    batch_bytes: int,
) -> None:
    """Write ``samples``, ``recordings`` and ``rejected``; all of them appear, or none.

    Within a run samples are ordered by joint, then time. ``temperatures`` holds, per run and joint,
    the known motor temperatures for each recording.
    """
    with ExitStack() as stack:
        samples, recordings, rejected = (
            stack.enter_context(
                TableWriter(work / f"{table.name}.parquet", table, provenance, facts)
            )
            for table in (schemas.SAMPLES, schemas.RECORDINGS, schemas.REJECTED)
        )
        placed = [(run, one) for run, timeline in timelines.items() for one in timeline.placed]
        for table in _gathered(
            batch
            for run, timeline in timelines.items()
            for joint in timeline.joints
            for batch in _samples(run, timeline, joint, temperatures[run, joint])
        ):
            samples.write(table)
        for table in _gathered(_recording_rows(run, one) for run, one in placed):
            recordings.write(table)
        for table in _gathered(
            rows for run, one in placed for rows in _rejected_rows(run, one.recorded, batch_bytes)
        ):
            rejected.write(table)
        rejected.write(_rejected_files(refused))


def _gathered(parts: Iterable[pa.Table]) -> Iterator[pa.Table]:
    """Yield the rows in tables of some size: many small ones make a Parquet file slow to read."""
    held: list[pa.Table] = []
    rows = 0
    for part in parts:
        held.append(part)
        rows += part.num_rows
        if rows >= _GROUP_ROWS:
            yield pa.concat_tables(held).unify_dictionaries()
            held, rows = [], 0
    if held:
        yield pa.concat_tables(held).unify_dictionaries()


def _samples(
    run: str, timeline: Timeline, joint: int, temperatures: Sequence[staircase.Knots | None]
) -> Iterator[pa.Table]:
    for placed, points in zip(timeline.placed, temperatures, strict=True):
        spool = placed.recorded.spools.get(joint)
        if spool is None:
            continue
        with pa.OSFile(str(spool), "rb") as stream, pa.ipc.open_stream(stream) as batches:
            for batch in batches:
                yield _sample_rows(run, placed, joint, batch, points)


def _sample_rows(
    run: str,
    placed: Placed,
    joint: int,
    batch: pa.RecordBatch,
    points: staircase.Knots | None,
) -> pa.Table:
    columns = {name: batch.column(name).to_numpy() for name in batch.schema.names}
    time = columns[names.TIME] + placed.start
    reading = columns[names.MOTOR_TEMPERATURE]
    rebuilt = reading if points is None else staircase.rebuild(points, time, reading)
    n = batch.num_rows
    arrays = {
        "run": _label(run, n),
        "recording": _label(placed.recorded.log.recording, n),
        "joint": pa.array(np.full(n, joint, np.int16)),
        "time": pa.array(time),
        **{name: pa.array(columns[name]) for name in _MEASURED},
        "motor_temperature": pa.array(rebuilt, from_pandas=True),
        "housing_temperature": pa.array(columns[names.HOUSING_TEMPERATURE], from_pandas=True),
        "motor_temperature_reading": pa.array(reading, from_pandas=True),
        "load": pa.array(columns[names.LOAD], from_pandas=True),
    }
    return pa.table(arrays)


def _label(text: str, n: int) -> pa.DictionaryArray:
    return pa.DictionaryArray.from_arrays(pa.array(np.zeros(n, np.int32)), pa.array([text]))


def _recording_rows(run: str, placed: Placed) -> pa.Table:
    recorded, entry = placed.recorded, placed.entry
    n = len(recorded.plans)
    started_at = None if placed.started_at is None else placed.started_at.isoformat()
    columns: dict[str, Any] = {
        "run": [run] * n,
        "recording": [recorded.log.recording] * n,
        "joint": [plan.channels.joint for plan in recorded.plans],
        "file": [str(recorded.log.file.path)] * n,
        "started_at": pa.array([started_at] * n, pa.string()),
        "start": [placed.start] * n,
        "phase": pa.array([entry.phase if entry else None] * n, pa.string()),
        "payload": pa.array([entry.payload if entry else None] * n, pa.float64()),
        "ambient": pa.array([entry.ambient if entry else None] * n, pa.float64()),
        "rows_read": [recorded.rows_read] * n,
        "rows_kept": [recorded.rows_kept] * n,
        "rows_rejected": [len(recorded.rejected[0])] * n,
        "period": [recorded.period] * n,
        "notes": ["\n".join((*plan.notes, *plan.warnings)) for plan in recorded.plans],
    }
    return pa.table(columns)


def _rejected_rows(run: str, recorded: Recorded, batch_bytes: int) -> Iterator[pa.Table]:
    lines, codes = recorded.rejected
    texts = recorded.log.source.texts(lines, batch_bytes)
    for start in range(0, len(lines), _REJECTED_ROWS):
        part = codes[start : start + _REJECTED_ROWS]
        found = [next(texts) for _ in range(len(part))]
        yield pa.table(
            {
                "run": [run] * len(part),
                "recording": [recorded.log.recording] * len(part),
                "row": [line for line, _ in found],
                "reason": [REASONS[code] for code in part],
                "text": [text for _, text in found],
            }
        )


def _rejected_files(refused: Sequence[RefusedLog]) -> pa.Table:
    return pa.table(
        {
            "run": pa.array([log.run.name for log in refused], pa.string()),
            "recording": pa.array([log.recording for log in refused], pa.string()),
            "row": pa.nulls(len(refused), pa.int64()),
            "reason": pa.array([log.refusal.reason for log in refused], pa.string()),
            "text": pa.array(
                [f"{log.file.path.name}: {log.refusal.text}" for log in refused], pa.string()
            ),
        }
    )
