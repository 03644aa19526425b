"""Logs without a column of time: it is made from the number of the row and a constant period."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.logs.log_source import DerivedSource, RawBatch


@dataclass(frozen=True, slots=True)
class RowClock(DerivedSource):
    """A source with a further column: the time since the first row, damaged rows included.

    Attributes
    ----------
    source : LogSource
        The log.
    period : float
        Time from row to row. [s]
    """

    period: float

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names, the time last."""
        return (*self.source.columns, "time [s]")

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"{self.source.form}, {self.period:g} s per row"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        made, rows = len(self.source.columns), 0
        # rows are damaged or not by the columns that are read: one must be
        wanted = {column for column in columns if column != made} or {0}
        for batch in self.source.batches(wanted, size):
            lines = np.sort(np.concatenate((batch.lines, batch.bad_lines)))
            values = {column: batch.values[column] for column in columns if column != made}
            if made in columns:
                place = rows + np.searchsorted(lines, batch.lines)
                values[made] = np.asarray(place * self.period, np.float64)
            rows += len(lines)
            yield RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)
