"""Samples on their way to the table: one draft per joint, in the order of reading.

What a sample's row is can be known at once, but for two things: the order, as a run's joints follow
one another, and the motor temperature between the steps of its register, which needs the whole run.
Where neither matters the draft becomes the table as it is; else it is gone through once more.
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
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.samples import quantized_temperature
from frictioncli.logs.samples.row_checks import LogRows
from frictioncli.provenance import Provenance
from frictioncli.tables import TableWriter

_TABLE_ROWS = 1 << 17
"""Making a table of the rows of a short log takes longer than they do: so many are one."""

_AS_READ = (
    names.POSITION,
    names.VELOCITY,
    names.TORQUE,
    names.MOTOR_TEMPERATURE,
    names.HOUSING_TEMPERATURE,
    names.LOAD,
)

Temperatures = Mapping[tuple[str, int], Sequence[quantized_temperature.Knots | None]]
"""Run and joint -> known motor temperatures for each recording of the run."""


@dataclass(slots=True)
class _Stretch:
    """The rows of one recording in a draft; void when the recording turned out unusable."""

    run: str
    rows: int = 0
    void: bool = False


@dataclass(frozen=True, slots=True)
class _Piece:
    """Samples of one recording, with their time since the run's first one [s]."""

    run: str
    recording: str
    time: Array
    block: LogRows


@dataclass(slots=True)
class _JointDraft:
    """The samples of one joint; those of short logs are held until they make a table."""

    joint: int
    writer: TableWriter
    stretches: deque[_Stretch] = field(default_factory=deque)
    held: list[_Piece] = field(default_factory=list)
    held_rows: int = 0

    def add(self, piece: _Piece) -> None:
        """Take samples of the newest stretch."""
        self.stretches[-1].rows += len(piece.block)
        self.held.append(piece)
        self.held_rows += len(piece.block)
        if self.held_rows >= _TABLE_ROWS:
            self.write()

    def write(self) -> None:
        """Write what is held."""
        if self.held:
            self.writer.write(_table(self.held, self.joint))
        self.held, self.held_rows = [], 0


class SampleWriter:
    """Takes samples recording by recording and makes the table ``samples`` of them.

    Parameters
    ----------
    folder : Path
        Where the drafts may lie, on the disk of the table.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._stack = ExitStack()
        self._drafts: dict[int, _JointDraft] = {}
        self._label: tuple[str, str] = ("", "")
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

    def begin(self, run: str, recording: str, joints: Sequence[int], start: float) -> None:
        """Get ready for the samples of a recording, which starts at ``start`` [s] of its run."""
        self._label, self._start = (run, recording), start
        for joint in joints:
            if joint not in self._drafts:
                writer = TableWriter(self._path(joint), schemas.SAMPLES, Provenance("ingest"))
                self._drafts[joint] = _JointDraft(joint, self._stack.enter_context(writer))
            self._drafts[joint].stretches.append(_Stretch(run))

    def add(self, block: LogRows, time: Array) -> None:
        """Take samples of the recording begun last, ``time`` from its first sample [s]."""
        piece = _Piece(*self._label, time + self._start if self._start else time, block)
        for joint in {joint for joint, _ in block.columns}:
            self._drafts[joint].add(piece)

    def forget(self, joints: Sequence[int]) -> None:
        """Declare what was taken of the recording begun last void."""
        for joint in joints:
            self._drafts[joint].stretches[-1].void = True

    def finish(
        self,
        target: Path,
        temperatures: Temperatures,
        provenance: Provenance,
        facts: Mapping[str, Any],
    ) -> None:
        """Make the table: by run, joint and time, with the temperatures rebuilt.

        Parameters
        ----------
        target : Path
            The table's path, on the disk of the drafts.
        temperatures : Temperatures
            Known motor temperatures; runs and joints that are not there have no samples.
        provenance, facts
            As for :class:`TableWriter`.
        """
        for draft in self._drafts.values():
            draft.write()
            draft.writer.provenance, draft.writer.facts = provenance, facts
        self._stack.close()
        if self._is_final(temperatures):
            os.replace(self._path(next(iter(self._drafts))), target)
            return
        # else what reading has freed stays beside what this needs
        pa.default_memory_pool().release_unused()
        rows = {joint: _Rows(self._path(joint)) for joint in self._drafts}
        with TableWriter(target, schemas.SAMPLES, provenance, facts) as writer:
            for run in dict.fromkeys(run for run, _ in temperatures):
                for joint in sorted(joint for name, joint in temperatures if name == run):
                    for table in self._of_run(run, joint, rows[joint], temperatures[run, joint]):
                        writer.write(table)

    def _path(self, joint: int) -> Path:
        return self._folder / f"samples-{joint}.parquet"

    def _is_final(self, temperatures: Temperatures) -> bool:
        rebuilt = any(known is not None for knots in temperatures.values() for known in knots)
        void = any(one.void for draft in self._drafts.values() for one in draft.stretches)
        return len(self._drafts) == 1 and not rebuilt and not void

    def _of_run(
        self,
        run: str,
        joint: int,
        rows: "_Rows",
        knots: Sequence[quantized_temperature.Knots | None],
    ) -> Iterator[pa.Table]:
        """Yield the rows of a run, whose stretches follow one another in each draft."""
        known = iter(knots)
        stretches = self._drafts[joint].stretches
        while stretches and (stretches[0].run == run or stretches[0].void):
            stretch = stretches.popleft()
            points = None if stretch.void else next(known)
            for table in rows.take(stretch.rows):
                if not stretch.void:
                    yield table if points is None else _rebuilt(table, points)


class _Rows:
    """The rows of a draft, taken in order."""

    def __init__(self, path: Path) -> None:
        self._batches = tables.batches(path, schemas.SAMPLES)
        self._rest: pa.RecordBatch | None = None

    def take(self, count: int) -> Iterator[pa.Table]:
        """Yield the next rows, as many as asked for."""
        while count:
            batch = self._rest if self._rest is not None else next(self._batches)
            part = batch.slice(0, count)
            self._rest = batch.slice(count) if batch.num_rows > count else None
            count -= part.num_rows
            yield pa.Table.from_batches([part])


def _rebuilt(rows: pa.Table, points: quantized_temperature.Knots) -> pa.Table:
    reading = rows.column("motor_temperature_reading").to_numpy()
    smooth = quantized_temperature.rebuild(points, rows.column("time").to_numpy(), reading)
    at = rows.schema.get_field_index("motor_temperature")
    return rows.set_column(at, "motor_temperature", _column(smooth))


def _table(pieces: Sequence[_Piece], joint: int) -> pa.Table:
    """Return the samples of a joint, piece after piece; numbers are not copied."""
    rows = [len(piece.block) for piece in pieces]
    found = {
        name: pa.chunked_array([_column(_values(piece.block, joint, name)) for piece in pieces])
        for name in _AS_READ
        if any((joint, name) in piece.block.columns for piece in pieces)
    }
    if names.MOTOR_TEMPERATURE in found:
        found["motor_temperature_reading"] = found[names.MOTOR_TEMPERATURE]
    return pa.table(
        {
            "run": _repeated([piece.run for piece in pieces], rows),
            "recording": _repeated([piece.recording for piece in pieces], rows),
            "joint": pa.array(np.full(sum(rows), joint, np.int16)),
            "time": pa.chunked_array([pa.array(piece.time) for piece in pieces]),
            **found,
        }
    )


def _values(block: LogRows, joint: int, name: str) -> Array:
    values = block.columns.get((joint, name))
    return values if values is not None else np.full(len(block), np.nan)


def _column(values: Array) -> pa.Array:
    """Return a column; empty where a value is NaN."""
    return pa.array(values, from_pandas=bool(len(values)) and bool(np.isnan(values.min())))


def _repeated(texts: Sequence[str], rows: Sequence[int]) -> pa.DictionaryArray:
    """Return each text so many times."""
    codes = {text: code for code, text in enumerate(dict.fromkeys(texts))}
    each = np.array([codes[text] for text in texts], np.int32)
    labels = pa.array(np.repeat(each, rows))
    return pa.DictionaryArray.from_arrays(labels, pa.array(list(codes)), safe=False)
