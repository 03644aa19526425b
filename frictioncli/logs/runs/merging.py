"""Log merged from files that were recorded at once: rows of one, with columns of the others.

All files count their time from the same moment. The rows are those of the base file; columns of the
secondary files are given at its times.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.logs.log_source import LogSource, RawBatch, SequentialSource
from frictioncli.logs.samples.differentiation import max_gap
from frictioncli.logs.samples.log_rows import LogRows, RejectedRows
from frictioncli.logs.samples.row_checks import drop_non_increasing_time

_OUTSIDE = "outside_other_file"
_EDGE = 1e-3
"""Share of a period by which a sample may lie beyond the ends of a secondary file."""


@dataclass(frozen=True, slots=True)
class SecondaryFile:
    """A file whose columns are given at the times of the base file.

    Attributes
    ----------
    source : LogSource
        The file.
    time : int
        Its column of time.
    scale : float
        Factor from its unit of time to that of the base file. [-]
    period : float
        Median time between its rows, in the base file's unit.
    columns : tuple of int
        Its columns that are merged.
    zero_order_hold : frozenset of int
        Those of them that keep their value until the next one, as registers do; the others are
        interpolated linearly.
    """

    source: LogSource
    time: int
    scale: float
    period: float
    columns: tuple[int, ...]
    zero_order_hold: frozenset[int]


@dataclass(frozen=True, slots=True)
class MergedLog(SequentialSource):
    """The rows of a base file with the columns of secondary files behind its own.

    Attributes
    ----------
    base : LogSource
        The file whose rows are the samples; line numbers and texts are its own.
    time : int
        Its column of time.
    secondary : tuple of SecondaryFile
        The other files.
    columns : tuple of str
        Names of the base file's columns, then of the merged ones.
    """

    base: LogSource
    time: int
    secondary: tuple[SecondaryFile, ...]
    columns: tuple[str, ...]

    @property
    def path(self) -> Path:
        """The file whose rows are the samples."""
        return self.base.path

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that the samples come from."""
        others = (path for file in self.secondary for path in file.source.files)
        return (*self.base.files, *others)

    @property
    def form(self) -> str:
        """The form in words."""
        return f"{1 + len(self.secondary)} files of one trace: {self.base.form}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the base file's rows; rows for which a secondary file has no value are bad."""
        wanted = sorted(columns)
        base_columns = [column for column in wanted if column < len(self.base.columns)]
        alignments = self._alignments(wanted, size)
        for batch in self.base.batches({*base_columns, self.time}, size):
            time = batch.values[self.time]
            values = {column: batch.values[column] for column in base_columns}
            outside = np.zeros(len(time), bool)
            for alignment in alignments:
                merged, missing = alignment.values_at(time)
                values |= merged
                outside |= missing
            yield _with_merged(batch, values, outside)

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) of the base file for the given lines, which must be ascending."""
        return self.base.texts(lines, size)

    def _alignments(self, wanted: Sequence[int], size: int) -> list["_Alignment"]:
        alignments = []
        first = len(self.base.columns)
        for file in self.secondary:
            columns = {
                first + i: column for i, column in enumerate(file.columns) if first + i in wanted
            }
            first += len(file.columns)
            if columns:
                alignments.append(_Alignment(file, columns, size))
        return alignments


def _with_merged(batch: RawBatch, values: dict[int, Array], outside: Flags) -> RawBatch:
    """Return a batch with other values; the rows that lie outside become bad ones."""
    if not outside.any():
        return RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)
    bad = np.concatenate((batch.bad_lines, batch.lines[outside]))
    reasons = (*batch.bad_reasons, *[_OUTSIDE] * int(outside.sum()))
    order = np.argsort(bad, kind="stable")
    return RawBatch(
        batch.lines[~outside],
        {column: cells[~outside] for column, cells in values.items()},
        bad[order],
        tuple(reasons[i] for i in order),
    )


class _Alignment:
    """Reads a secondary file in step with the base file; holds one batch of it at a time.

    Parameters
    ----------
    file : SecondaryFile
        The file.
    columns : dict of int to int
        Column of the merged log -> column of the file.
    size : int
        Size of a batch in the file. [byte]
    """

    def __init__(self, file: SecondaryFile, columns: dict[int, int], size: int) -> None:
        self._file = file
        self._columns = columns
        self._held = frozenset(
            column for column, source in columns.items() if source in file.zero_order_hold
        )
        self._size = size
        self._restart()

    def values_at(self, time: Array) -> tuple[dict[int, Array], Flags]:
        """Return the merged columns at the base file's times, and the rows that have no value.

        Parameters
        ----------
        time : ndarray, shape (rows,)
            Times of the base file's rows, in any order.
        """
        values = {column: np.full(len(time), np.nan) for column in self._columns}
        pending = np.isfinite(time)
        missing = pending.copy()
        if pending.any() and np.median(time[pending]) < self._rows.begin:
            self._restart()  # a damaged time stamp led too far, or the base file's clock was reset
        self._fill(time, pending, values, missing, last=False)
        while np.any(pending & (time > self._rows.end)) and self._advance():
            self._fill(time, pending, values, missing, last=False)
        self._fill(time, pending, values, missing, last=True)
        return values, missing

    def _fill(
        self,
        time: Array,
        pending: Flags,
        values: dict[int, Array],
        missing: Flags,
        *,
        last: bool,
    ) -> None:
        """Fill in the values at times that the current rows cover; ``last``: at their end too."""
        # a held value is valid for a period; interpolation ends with the last row
        beyond = 1.0 if len(self._held) == len(self._columns) else _EDGE
        found = pending & self._rows.covers(time, beyond if last else 0.0)
        pending &= ~found
        for column, cells in self._rows.columns.items():
            if column in self._held:
                values[column][found] = self._rows.held_values(cells, time[found])
            else:
                values[column][found] = self._rows.interpolated_values(cells, time[found])
        missing[found] = len(self._held) < len(self._columns) and self._rows.in_gap(time[found])

    def _restart(self) -> None:
        """Read the file from its beginning."""
        self._batches = self._read()
        self._rows = next(self._batches, _NO_ROWS)

    def _advance(self) -> bool:
        """Go to the next rows; return False where there are none."""
        following = next(self._batches, None)
        if following is not None:
            self._rows = following
        return following is not None

    def _read(self) -> Iterator["_SecondaryRows"]:
        """Yield the rows of the file; each batch begins with the last row of the one before."""
        period = self._file.period
        last: _SecondaryRows | None = None
        for block in drop_non_increasing_time(self._blocks(), RejectedRows()):
            if not len(block):
                continue
            time = block.time
            columns = {column: block.columns[0, str(column)] for column in self._columns}
            if last is not None:
                time = np.concatenate((last.time[-1:], time))
                columns = {c: np.concatenate((last.columns[c][-1:], columns[c])) for c in columns}
            for column in self._held:
                columns[column] = _forward_filled(columns[column])
            last = _SecondaryRows(time, columns, period, first=last is None)
            yield last

    def _blocks(self) -> Iterator[LogRows]:
        file = self._file
        for batch in file.source.batches({file.time, *self._columns.values()}, self._size):
            time = batch.values[file.time] * file.scale
            finite = np.isfinite(time)
            columns = {
                (0, str(column)): batch.values[source][finite]
                for column, source in self._columns.items()
            }
            yield LogRows(batch.lines[finite], time[finite], columns)


@dataclass(frozen=True, slots=True)
class _SecondaryRows:
    """Consecutive rows of a secondary file in ascending time; ``first`` if the file begins there.

    Times and period are in the base file's unit.
    """

    time: Array
    columns: dict[int, Array]
    period: float
    first: bool

    @property
    def begin(self) -> float:
        """The earliest time that the rows cover."""
        edge = _EDGE * self.period if self.first else 0.0
        return float(self.time[0]) - edge if len(self.time) else np.inf

    @property
    def end(self) -> float:
        """Time of the last row."""
        return float(self.time[-1]) if len(self.time) else -np.inf

    def covers(self, time: Array, beyond: float) -> Flags:
        """Return which times lie within, or up to ``beyond`` periods after the last row."""
        return (time >= self.begin) & (time <= self.end + beyond * self.period)

    def interpolated_values(self, cells: Array, time: Array) -> Array:
        """Return the values of a column by linear interpolation."""
        return np.interp(time, self.time, cells) if len(self.time) else np.empty(0)

    def held_values(self, cells: Array, time: Array) -> Array:
        """Return the values of a column by zero-order hold."""
        row = np.searchsorted(self.time, time + _EDGE * self.period, side="right") - 1
        return cells[np.maximum(row, 0)]

    def in_gap(self, time: Array) -> Flags:
        """Return which times lie inside a gap between rows."""
        if len(self.time) < 2:
            return np.zeros(len(time), bool)
        after = np.clip(np.searchsorted(self.time, time), 1, len(self.time) - 1)
        since, until = time - self.time[after - 1], self.time[after] - time
        near = np.minimum(np.abs(since), np.abs(until)) <= _EDGE * self.period
        return (since + until > max_gap(self.period)) & ~near


_NO_ROWS = _SecondaryRows(np.empty(0), {}, 0.0, first=True)


def _forward_filled(cells: Array) -> Array:
    """Return a column in which empty cells hold the last value before them."""
    row = np.maximum.accumulate(np.where(np.isnan(cells), 0, np.arange(len(cells))))
    return cells[row]
