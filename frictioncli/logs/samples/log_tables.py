"""What became of files and rows, as tables: ``recordings`` and ``rejected``."""

from collections.abc import Iterator, Sequence
from itertools import islice

import pyarrow as pa

from frictioncli.logs.runs.opening import OpenedLog, RefusedLog
from frictioncli.logs.samples.row_checks import REASONS, RejectedRows
from frictioncli.logs.samples.timeline import PlacedRecording

_REJECTED_ROWS = 1 << 15


def recording_rows(run: str, recordings: Sequence[PlacedRecording]) -> pa.Table:
    """Return the rows of ``recordings`` for a run: one per recording and joint."""
    rows = []
    for placed in recordings:
        recorded, entry = placed.recorded, placed.entry
        for plan in recorded.reading.plans:
            rows.append(
                {
                    "run": run,
                    "recording": recorded.log.recording,
                    "joint": plan.channels.joint,
                    "file": str(recorded.log.file.path),
                    "started_at": placed.started_at and placed.started_at.isoformat(),
                    "start": placed.start,
                    "phase": entry and entry.phase,
                    "payload": placed.payload,
                    "ambient": entry and entry.ambient,
                    "rows_read": recorded.rows_read,
                    "rows_kept": recorded.rows_kept,
                    "rows_rejected": sum(recorded.rejected.values()),
                    "period": recorded.reading.period,
                    "notes": "\n".join((*plan.notes, *plan.warnings)),
                }
            )
    return pa.Table.from_pylist(rows)


def rejected_rows(log: OpenedLog, faults: RejectedRows, batch_bytes: int) -> Iterator[pa.Table]:
    """Yield the rows of ``rejected`` for the lines of a log that were not kept."""
    lines, codes = faults.ascending()
    texts = log.source.texts(lines, batch_bytes)
    for start in range(0, len(lines), _REJECTED_ROWS):
        part = codes[start : start + _REJECTED_ROWS]
        found = list(islice(texts, len(part)))
        yield pa.table(
            {
                "run": [log.run.name] * len(part),
                "recording": [log.recording] * len(part),
                "row": [line for line, _ in found],
                "reason": [REASONS[code] for code in part],
                "text": [text for _, text in found],
            }
        )


def rejected_files(refused: Sequence[RefusedLog]) -> pa.Table:
    """Return the rows of ``rejected`` for files that are not used as a whole."""
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
