"""A log made of files that were recorded at once: the samples of one, with columns of others.

Every file has its own times, counted from the same moment. The rows are those of one file; columns
of the others are given at its times.
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
"""A sample is within the other file up to this share of a period beyond its ends."""


@dataclass(frozen=True, slots=True)
class SecondaryFile:
    """A file whose columns are given at the times of another.

    Attributes
    ----------
    source : LogSource
        The file.
    time : int
        Its column of time.
    scale : float
        Factor from its time to that of the other file.
    period : float
        Usual time between its rows, in the other file's unit.
    columns : tuple of int
        Its columns that are lent.
    held : frozenset of int
        Those of them that keep their value until the next one, as registers do; the others are
        interpolated.
    """

    source: LogSource
    time: int
    scale: float
    period: float
    columns: tuple[int, ...]
    held: frozenset[int]


@dataclass(frozen=True, slots=True)
class MergedLog(SequentialSource):
    """The rows of ``base`` with columns of its lenders behind its own.

    Attributes
    ----------
    base : LogSource
        The file whose rows are the samples; line numbers and texts are its own.
    time : int
        Its column of time.
    lenders : tuple of SecondaryFile
        The other files.
    columns : tuple of str
        Names of the base's columns, then of those lent.
    """

    base: LogSource
    time: int
    lenders: tuple[SecondaryFile, ...]
    columns: tuple[str, ...]

    @property
    def path(self) -> Path:
        """The file whose rows are the samples."""
        return self.base.path

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that the samples come from."""
        others = (file for one in self.lenders for file in one.source.files)
        return (*self.base.files, *others)

    @property
    def form(self) -> str:
        """The form in words."""
        return f"{1 + len(self.lenders)} files of one trace: {self.base.form}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the base's rows; where a lender has no value for one, the row is bad."""
        wanted = sorted(columns)
        own = [column for column in wanted if column < len(self.base.columns)]
        followers = self._followers(wanted, size)
        for batch in self.base.batches({*own, self.time}, size):
            time = batch.values[self.time]
            values = {column: batch.values[column] for column in own}
            outside = np.zeros(len(time), bool)
            for follower in followers:
                lent, missing = follower.at(time)
                values |= lent
                outside |= missing
            yield _without(batch, values, outside)

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) of the base for the asked lines, which must be ascending."""
        return self.base.texts(lines, size)

    def _followers(self, wanted: Sequence[int], size: int) -> list["_Alignment"]:
        followers = []
        first = len(self.base.columns)
        for one in self.lenders:
            lent = {
                first + i: column for i, column in enumerate(one.columns) if first + i in wanted
            }
            first += len(one.columns)
            if lent:
                followers.append(_Alignment(one, lent, size))
        return followers


def _without(batch: RawBatch, values: dict[int, Array], outside: Flags) -> RawBatch:
    """Return the batch with other values, rows that lie outside joining the bad ones."""
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
    """Walks through a lender in step with the base; holds one batch of it at a time."""

    def __init__(self, lender: SecondaryFile, lent: dict[int, int], size: int) -> None:
        self._lender = lender
        self._lent = lent
        self._held = frozenset(c for c, own in lent.items() if own in lender.held)
        self._size = size
        self._begin()

    def at(self, time: Array) -> tuple[dict[int, Array], Flags]:
        """Return the lent columns at the base's times, and for which rows there is no value.

        Parameters
        ----------
        time : ndarray, shape (n,)
            Times of the base's rows, in any order.
        """
        values = {column: np.full(len(time), np.nan) for column in self._lent}
        sought = np.isfinite(time)
        missing = sought.copy()
        if sought.any() and np.median(time[sought]) < self._window.begin:
            self._begin()  # a damaged time stamp led too far ahead, or the base's clock was reset
        self._fill(time, sought, values, missing, last=False)
        while np.any(sought & (time > self._window.end)) and self._advance():
            self._fill(time, sought, values, missing, last=False)
        self._fill(time, sought, values, missing, last=True)
        return values, missing

    def _fill(
        self,
        time: Array,
        sought: Flags,
        values: dict[int, Array],
        missing: Flags,
        *,
        last: bool,
    ) -> None:
        """Fill in the values of rows that the window covers; ``last``: at its very end too."""
        # what is held stands for a period; a straight line ends with the last row
        beyond = 1.0 if len(self._held) == len(self._lent) else _EDGE
        found = sought & self._window.covers(time, beyond if last else 0.0)
        sought &= ~found
        for column, cells in self._window.columns.items():
            if column in self._held:
                values[column][found] = self._window.latest(cells, time[found])
            else:
                values[column][found] = self._window.between(cells, time[found])
        missing[found] = len(self._held) < len(self._lent) and self._window.in_gap(time[found])

    def _begin(self) -> None:
        self._windows = self._read()
        self._window = next(self._windows, _EMPTY)

    def _advance(self) -> bool:
        """Go to the next window; False where there is none."""
        following = next(self._windows, None)
        if following is not None:
            self._window = following
        return following is not None

    def _read(self) -> Iterator["_Window"]:
        """Yield the lender's rows; each window begins with the last row of the one before."""
        period = self._lender.period
        last: _Window | None = None
        for block in drop_non_increasing_time(self._blocks(), RejectedRows()):
            if not len(block):
                continue
            time = block.time
            columns = {column: block.columns[0, str(column)] for column in self._lent}
            if last is not None:
                time = np.concatenate((last.time[-1:], time))
                columns = {c: np.concatenate((last.columns[c][-1:], columns[c])) for c in columns}
            for column in self._held:
                columns[column] = _carried_on(columns[column])
            last = _Window(time, columns, period, first=last is None)
            yield last

    def _blocks(self) -> Iterator[LogRows]:
        lender = self._lender
        for batch in lender.source.batches({lender.time, *self._lent.values()}, self._size):
            time = batch.values[lender.time] * lender.scale
            good = np.isfinite(time)
            columns = {(0, str(c)): batch.values[own][good] for c, own in self._lent.items()}
            yield LogRows(batch.lines[good], time[good], columns)


@dataclass(frozen=True, slots=True)
class _Window:
    """Consecutive rows of a lender in ascending time; ``first`` where it begins there."""

    time: Array
    columns: dict[int, Array]
    period: float
    first: bool

    @property
    def begin(self) -> float:
        """The earliest time that it covers."""
        edge = _EDGE * self.period if self.first else 0.0
        return float(self.time[0]) - edge if len(self.time) else np.inf

    @property
    def end(self) -> float:
        """Time of its last row."""
        return float(self.time[-1]) if len(self.time) else -np.inf

    def covers(self, time: Array, beyond: float) -> Flags:
        """Return which times lie within, or up to some periods beyond the last row."""
        return (time >= self.begin) & (time <= self.end + beyond * self.period)

    def between(self, cells: Array, time: Array) -> Array:
        """Return a column on the straight lines between its rows."""
        return np.interp(time, self.time, cells) if len(self.time) else np.empty(0)

    def latest(self, cells: Array, time: Array) -> Array:
        """Return what a column last showed."""
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


_EMPTY = _Window(np.empty(0), {}, 0.0, first=True)


def _carried_on(cells: Array) -> Array:
    """Return a column with empty cells showing the last value before them."""
    row = np.maximum.accumulate(np.where(np.isnan(cells), 0, np.arange(len(cells))))
    return cells[row]
