"""Writer of the table ``samples``: one file per joint while logs are read, one table in the end.

A row of the table is known as soon as it is read, but for two things: the order, as the joints of a
run follow one another, and the motor temperature between the changes of its register, which needs
the whole run. Where neither matters the file of the joint becomes the table as it is; else the
files are copied once more.
"""

import os
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import pyarrow as pa

from frictioncli import schemas, tables
from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.logs.samples.quantized_temperature import Knots, interpolate_temperature
from frictioncli.provenance import Provenance
from frictioncli.tables import TableWriter

_TABLE_ROWS = 1 << 17
"""Rows of short logs are collected up to this number: one large table is faster than many."""

_TABLE_PIECES = 1 << 10
"""Logs of a few rows take more memory for each array than for its numbers: no more may wait."""

_COPIED_CHANNELS = (
    names.POSITION,
    names.VELOCITY,
    names.TORQUE,
    names.MOTOR_TEMPERATURE,
    names.HOUSING_TEMPERATURE,
    names.LOAD,
    names.OTHER_SPEED,
    names.OTHER_JOINTS,
    names.POSE,
    names.PAYLOAD,
)

RunKnots = Mapping[tuple[str, int], Sequence[Knots | None]]
"""Run and joint -> knots of the motor temperature for each recording of the run."""


@dataclass(slots=True)
class _WrittenRecording:
    """Number of rows of a recording in a joint's file; discarded if it turned out unusable."""

    run: str
    rows: int = 0
    discarded: bool = False


@dataclass(frozen=True, slots=True)
class _SampleRows:
    """Rows of one recording, with their time since the run's first sample [s]."""

    run: str
    recording: str
    time: Array
    rows: LogRows


@dataclass(slots=True)
class _JointFile:
    """File with the samples of one joint; rows of short logs wait until they fill a table."""

    joint: int
    writer: TableWriter
    recordings: deque[_WrittenRecording] = field(default_factory=deque)
    waiting: list[_SampleRows] = field(default_factory=list)
    waiting_rows: int = 0

    def add(self, samples: _SampleRows) -> None:
        """Add rows of the newest recording."""
        self.recordings[-1].rows += len(samples.rows)
        self.waiting.append(samples)
        self.waiting_rows += len(samples.rows)
        if self.waiting_rows >= _TABLE_ROWS or len(self.waiting) >= _TABLE_PIECES:
            self.flush()

    def flush(self) -> None:
        """Write the rows that wait."""
        if self.waiting:
            self.writer.write(_table(self.waiting, self.joint))
        self.waiting, self.waiting_rows = [], 0


class SampleWriter:
    """Takes samples recording by recording and writes the table ``samples``.

    Parameters
    ----------
    folder : Path
        Folder for the files of the joints, on the same disk as the table.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._stack = ExitStack()
        self._files: dict[int, _JointFile] = {}
        self._run = self._recording = ""
        self._start = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def begin_recording(
        self, run: str, recording: str, joints: Sequence[int], start: float
    ) -> None:
        """Begin a recording of some joints, which starts at ``start`` [s] of its run."""
        self._run, self._recording, self._start = run, recording, start
        for joint in joints:
            if joint not in self._files:
                writer = TableWriter(self._path(joint), schemas.SAMPLES, Provenance("ingest"))
                self._files[joint] = _JointFile(joint, self._stack.enter_context(writer))
            self._files[joint].recordings.append(_WrittenRecording(run))

    def add(self, rows: LogRows, time: Array) -> None:
        """Add samples of the newest recording, ``time`` since its first sample [s]."""
        time = time + self._start if self._start else time
        samples = _SampleRows(self._run, self._recording, time, rows)
        for joint in {joint for joint, _ in rows.columns}:
            self._files[joint].add(samples)

    def discard_recording(self, joints: Sequence[int]) -> None:
        """Discard the newest recording of these joints."""
        for joint in joints:
            self._files[joint].recordings[-1].discarded = True

    def finish(
        self,
        target: Path,
        knots: RunKnots,
        provenance: Provenance,
        facts: Mapping[str, Any],
    ) -> None:
        """Write the table in the order of run, joint and time, with interpolated temperatures.

        Parameters
        ----------
        target : Path
            The table's path, on the same disk as the files of the joints.
        knots : RunKnots
            Knots of the motor temperatures; runs and joints that are not there have no samples.
        provenance, facts
            As for :class:`TableWriter`.
        """
        final = self._is_final(knots)
        for file in self._files.values():
            file.flush()
            if final:
                file.writer.provenance, file.writer.facts = provenance, facts
        self._stack.close()
        if final:
            os.replace(self._path(next(iter(self._files))), target)
            return
        # memory that reading has freed would otherwise add to what the copy needs
        pa.default_memory_pool().release_unused()
        readers = {joint: _RowReader(self._path(joint)) for joint in self._files}
        with TableWriter(target, schemas.SAMPLES, provenance, facts) as writer:
            for run in dict.fromkeys(run for run, _ in knots):
                for joint in sorted(joint for name, joint in knots if name == run):
                    for table in self._run_rows(run, joint, readers[joint], knots[run, joint]):
                        writer.write(table)

    def _path(self, joint: int) -> Path:
        return self._folder / f"samples-{joint}.parquet"

    def _is_final(self, knots: RunKnots) -> bool:
        """Return whether the only file is the table already."""
        interpolated = any(one is not None for of_joint in knots.values() for one in of_joint)
        discarded = any(one.discarded for file in self._files.values() for one in file.recordings)
        return len(self._files) == 1 and not interpolated and not discarded

    def _run_rows(
        self, run: str, joint: int, reader: "_RowReader", knots: Sequence[Knots | None]
    ) -> Iterator[pa.Table]:
        """Yield the rows of a run, whose recordings follow one another in the joint's file."""
        knots_of_recordings = iter(knots)
        recordings = self._files[joint].recordings
        while recordings and (recordings[0].run == run or recordings[0].discarded):
            recording = recordings.popleft()
            own_knots = None if recording.discarded else next(knots_of_recordings)
            for table in reader.read(recording.rows):
                if not recording.discarded:
                    yield table if own_knots is None else _interpolated(table, own_knots)


class _RowReader:
    """Reads the rows of a joint's file in order."""

    def __init__(self, path: Path) -> None:
        self._batches = tables.batches(path, schemas.SAMPLES)
        self._rest: pa.RecordBatch | None = None

    def read(self, count: int) -> Iterator[pa.Table]:
        """Yield the next ``count`` rows."""
        while count:
            batch = self._rest if self._rest is not None else next(self._batches)
            rows = batch.slice(0, count)
            self._rest = batch.slice(count) if batch.num_rows > count else None
            count -= rows.num_rows
            yield pa.Table.from_batches([rows])


def _interpolated(rows: pa.Table, knots: Knots) -> pa.Table:
    """Return rows with the motor temperature interpolated between knots."""
    reading = rows.column("motor_temperature_reading").to_numpy()
    temperature = interpolate_temperature(knots, rows.column("time").to_numpy(), reading)
    at = rows.schema.get_field_index("motor_temperature")
    return rows.set_column(at, "motor_temperature", _column(temperature))


def _table(samples: Sequence[_SampleRows], joint: int) -> pa.Table:
    """Return the samples of a joint in one table; numbers of a single log are not copied."""
    counts = [len(one.rows) for one in samples]
    channels = {
        name: _column(_joined([_values(one.rows, joint, name) for one in samples]))
        for name in _COPIED_CHANNELS
        if any((joint, name) in one.rows.columns for one in samples)
    }
    if names.MOTOR_TEMPERATURE in channels:
        channels["motor_temperature_reading"] = channels[names.MOTOR_TEMPERATURE]
    return pa.table(
        {
            "run": _repeated([one.run for one in samples], counts),
            "recording": _repeated([one.recording for one in samples], counts),
            "joint": pa.array(np.full(sum(counts), joint, np.int16)),
            "time": pa.array(_joined([one.time for one in samples])),
            **channels,
        }
    )


def _joined(parts: Sequence[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _values(rows: LogRows, joint: int, name: str) -> Array:
    values = rows.columns.get((joint, name))
    return values if values is not None else np.full(len(rows), np.nan)


def _column(values: Array) -> pa.Array:
    """Return a column; empty where a value is NaN."""
    return pa.array(values, from_pandas=bool(len(values)) and bool(np.isnan(values.min())))


def _repeated(texts: Sequence[str], counts: Sequence[int]) -> pa.DictionaryArray:
    """Return a dictionary column in which each text is repeated so many times."""
    codes = {text: code for code, text in enumerate(dict.fromkeys(texts))}
    each = np.array([codes[text] for text in texts], np.int32)
    labels = pa.array(np.repeat(each, counts))
    return pa.DictionaryArray.from_arrays(labels, pa.array(list(codes)), safe=False)
