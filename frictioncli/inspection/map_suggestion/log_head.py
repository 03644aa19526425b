"""The beginning of a log: its columns of numbers."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.survey import LARGEST
from frictioncli.logs.log_source import LogSource, RawBatch, UnreadableLog

_FIRST_BYTES = 1 << 16
_BATCH_BYTES = 1 << 20
_MAX_COLUMNS = 500
_MAX_VALUES = 8_000_000
_MAX_BAD_ROWS = 100_000
_MAX_ROWS = 100_000
_LEAST_FILLED = 0.9
"""Share of cells that must be numbers in a column of numbers."""


@dataclass(frozen=True, slots=True)
class LogHead:
    """The beginning of a log.

    Attributes
    ----------
    names : tuple of str
        All column names as they stand in the file.
    values : mapping of int to ndarray, shape (rows,)
        Values by column, for columns of numbers that change.
    constants : mapping of int to float
        Value by column, for columns of numbers that do not change.
    rows : int
        Number of rows.
    """

    names: tuple[str, ...]
    values: Mapping[int, Array]
    constants: Mapping[int, float]
    rows: int


def read_log_head(source: LogSource) -> LogHead:
    """Read the beginning of a log, without rows that lack a value.

    Only columns that a mapping file can name are read: of several columns with the same name the
    first.
    """
    names = source.columns
    nameable = [i for i, name in enumerate(names) if name.strip() and names.index(name) == i]
    numeric = [column for column in nameable[:_MAX_COLUMNS] if _is_numeric(source, column)]
    if not numeric:
        return LogHead(names, {}, {}, 0)
    most_rows = min(_MAX_VALUES // len(numeric), _MAX_ROWS)
    batches: list[RawBatch] = []
    rows = bad = 0
    with suppress(UnreadableLog):
        for batch in source.batches(numeric, _BATCH_BYTES):
            batches.append(batch)
            rows += len(batch.lines)
            bad += len(batch.bad_lines)
            if rows >= most_rows or bad > _MAX_BAD_ROWS:
                break
    cells = {c: np.concatenate([b.values[c] for b in batches] or [np.empty(0)]) for c in numeric}
    complete = np.ones(rows, bool)
    for column_cells in cells.values():
        complete &= np.abs(column_cells) < LARGEST
    values = {column: found[complete][:most_rows] for column, found in cells.items()}
    changing = {c: v for c, v in values.items() if len(v) and float(np.ptp(v)) > 0}
    constants = {c: float(v[0]) for c, v in values.items() if len(v) and c not in changing}
    return LogHead(names, changing, constants, min(int(complete.sum()), most_rows))


def _is_numeric(source: LogSource, column: int) -> bool:
    with suppress(UnreadableLog):
        first = next(iter(source.batches([column], _FIRST_BYTES)), None)
        if first is not None:
            cells = len(first.lines) + len(first.bad_lines)
            numbers = np.abs(first.values[column]) < LARGEST
            return bool(numbers.sum() > _LEAST_FILLED * cells)
    return False
