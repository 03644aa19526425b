"""Rows of a log with all channels, and the lines that were rejected."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Flags, Numbers

NO_VALUES = "no_values"
"""A row of other signals: a logger that joins topics by time writes a row at every time stamp."""

REASONS = (
    "not_a_number",
    "missing_value",
    "wrong_field_count",
    "time_not_increasing",
    "duplicate_time",
    "implausible_position",
    "stale_first_rows",
    "no_neighbours",
    "outside_other_file",
    "implausible_value",
    NO_VALUES,
)
"""Why a row is rejected."""


@dataclass(frozen=True, slots=True)
class LogRows:
    """Consecutive rows of a log.

    Attributes
    ----------
    lines : ndarray of int, shape (rows,)
        Line of each row in the file, from 1.
    time : ndarray, shape (rows,)
        Time by the clock of the log. [s]
    columns : mapping of (int, str) to ndarray, shape (rows,)
        Joint and canonical name -> values in the unit used inside; NaN where there is none.
    """

    lines: Numbers
    time: Array
    columns: Mapping[tuple[int, str], Array]

    def __len__(self) -> int:
        return len(self.lines)

    def take(self, which: Flags | slice) -> "LogRows":
        """Return the selected rows."""
        columns = {name: values[which] for name, values in self.columns.items()}
        return LogRows(self.lines[which], self.time[which], columns)


def concatenate_rows(first: LogRows, second: LogRows) -> LogRows:
    """Return two sets of rows with the same columns, one after the other.

    Examples
    --------
    >>> import numpy as np
    >>> rows = LogRows(np.array([2, 3]), np.array([0.0, 0.1]), {})
    >>> concatenate_rows(rows, rows).lines
    array([2, 3, 2, 3])
    """
    return LogRows(
        np.concatenate((first.lines, second.lines)),
        np.concatenate((first.time, second.time)),
        {
            name: np.concatenate((values, second.columns[name]))
            for name, values in first.columns.items()
        },
    )


_MOST_REJECTED, _LARGEST_SHARE = 1_000_000, 0.8
"""A log with more rejected rows than both is given up: a few kB can unpack to 1e9 such rows."""


@dataclass(slots=True)
class RejectedRows:
    """Lines rejected so far, each array of lines with the indices of its ``REASONS``."""

    lines: list[Numbers] = field(default_factory=list)
    codes: list[NDArray[np.int8]] = field(default_factory=list)
    count: int = 0

    def add(self, lines: Numbers, reason: str) -> None:
        """Add lines that are rejected for one reason."""
        if len(lines):
            self.count += len(lines)
            self.lines.append(lines)
            self.codes.append(np.full(len(lines), REASONS.index(reason), np.int8))

    def extend(self, others: "RejectedRows") -> None:
        """Add the lines of another record."""
        self.count += others.count
        self.lines += others.lines
        self.codes += others.codes

    def are_hopeless(self, rows_read: int) -> bool:
        """Return whether a log with so many rejected rows is to be read no further."""
        return self.count > max(_MOST_REJECTED, _LARGEST_SHARE * rows_read)

    def counts(self) -> dict[str, int]:
        """Return reason -> number of lines, for the reasons that occur."""
        if not self.codes:
            return {}
        numbers = np.zeros(len(REASONS), int)
        for codes in self.codes:
            numbers += np.bincount(codes, minlength=len(REASONS))
        return {reason: int(n) for reason, n in zip(REASONS, numbers, strict=True) if n}

    def first_line(self, reason: str) -> Numbers:
        """Return the first line rejected for a reason, shape (1,)."""
        code = REASONS.index(reason)
        found = [lines[codes == code] for lines, codes in zip(self.lines, self.codes, strict=True)]
        return np.array([min(int(lines.min()) for lines in found if len(lines))])

    def in_line_order(self) -> tuple[Numbers, NDArray[np.int8]]:
        """Return all lines in ascending order, and the index of the reason of each."""
        if not self.lines:
            return np.empty(0, np.int64), np.empty(0, np.int8)
        lines, codes = np.concatenate(self.lines), np.concatenate(self.codes)
        order = np.argsort(lines, kind="stable")
        return lines[order], codes[order]
