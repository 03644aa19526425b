"""Rows of the tables ``recordings`` and ``rejected``."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import pyarrow as pa

from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.runs.opening import OpenedLog, RefusedLog
from frictioncli.logs.samples.log_rows import REASONS, RejectedRows
from frictioncli.logs.samples.timeline import PlacedRecording

_TABLE_ROWS = 1 << 15
_OBJECT_ROWS = 1 << 12
"""Rows that are objects of Python at a time: one takes 1 kB."""


def recording_rows(run: str, recordings: Sequence[PlacedRecording]) -> Iterator[pa.Table]:
    """Yield the rows of ``recordings`` for a run: one per recording and joint.

    Parameters
    ----------
    run : str
        Name of the run.
    recordings : sequence of PlacedRecording
        Its recordings.
    """
    rows = (
        _recording_row(run, placed, plan)
        for placed in recordings
        for plan in placed.recording.planned.plans
    )
    while some := list(islice(rows, _OBJECT_ROWS)):
        yield pa.Table.from_pylist(some)


def _recording_row(run: str, placed: PlacedRecording, plan: JointPlan) -> dict[str, Any]:
    recording, entry = placed.recording, placed.entry
    return {
        "run": run,
        "recording": recording.log.recording,
        "joint": plan.channels.joint,
        "file": str(recording.log.file.path),
        "started_at": placed.started_at and placed.started_at.isoformat(),
        "start": placed.start,
        "phase": entry and entry.phase,
        "payload": placed.payload,
        "ambient": entry and entry.ambient,
        "rows_read": recording.rows_read,
        "rows_kept": recording.rows_kept,
        "rows_rejected": sum(recording.rejected.values()),
        "period": recording.planned.period,
        "notes": "\n".join((*plan.notes, *plan.warnings)),
    }


def rejected_rows(log: OpenedLog, rejected: RejectedRows, batch_bytes: int) -> Iterator[pa.Table]:
    """Yield the rows of ``rejected`` for the lines of a log that were not kept.

    Parameters
    ----------
    log : OpenedLog
        The log.
    rejected : RejectedRows
        Its rejected lines.
    batch_bytes : int
        Size of a batch in the file. [byte]
    """
    lines, codes = rejected.in_line_order()
    texts = log.source.texts(lines, batch_bytes)
    for start in range(0, len(lines), _TABLE_ROWS):
        reasons = [REASONS[code] for code in codes[start : start + _TABLE_ROWS]]
        found = list(islice(texts, len(reasons)))
        yield pa.table(
            {
                "run": [log.run.name] * len(reasons),
                "recording": [log.recording] * len(reasons),
                "row": [line for line, _ in found],
                "reason": reasons,
                "text": [text for _, text in found],
            }
        )


def rejected_files(refused: Sequence[RefusedLog]) -> pa.Table:
    """Return the rows of ``rejected`` for whole files that are not used."""
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
