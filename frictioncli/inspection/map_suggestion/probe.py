"""The columns of a log that hold numbers, as far as its beginning shows."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.log_source import LogSource, RawBatch, UnreadableLog

_FIRST_BYTES = 1 << 16
_BATCH_BYTES = 1 << 20
_MOST_COLUMNS = 500
_MOST_VALUES = 8_000_000
_MOST_ROWS = 100_000
_FILLED = 0.9
"""Share of cells that must be numbers for a column to count."""


@dataclass(frozen=True, slots=True)
class Probe:
    """The beginning of a log.

    Attributes
    ----------
    names : tuple of str
        All column names, as they stand in the file.
    values : mapping of int to ndarray, shape (n,)
        Column to its values, for the columns that hold numbers that change.
    constants : mapping of int to float
        Column to its value, for those that do not.
    rows : int
        How many rows were looked at.
    """

    names: tuple[str, ...]
    values: Mapping[int, Array]
    constants: Mapping[int, float]
    rows: int


def probe(source: LogSource) -> Probe:
    """Read the beginning of a log: columns that a mapping file can name and that hold numbers.

    Of columns of one name only the first can be named.
    """
    names = source.columns
    nameable = [i for i, name in enumerate(names) if name.strip() and names.index(name) == i]
    numeric = [column for column in nameable[:_MOST_COLUMNS] if _numeric(source, column)]
    if not numeric:
        return Probe(names, {}, {}, 0)
    enough = min(_MOST_VALUES // len(numeric), _MOST_ROWS)
    kept: list[RawBatch] = []
    rows = 0
    with suppress(UnreadableLog):
        for batch in source.batches(numeric, _BATCH_BYTES):
            kept.append(batch)
            rows += len(batch.lines)
            if rows >= enough:
                break
    whole = {c: np.concatenate([b.values[c] for b in kept] or [np.empty(0)]) for c in numeric}
    good = np.ones(rows, bool)
    for cells in whole.values():
        good &= np.isfinite(cells)
    values = {column: values[good][:enough] for column, values in whole.items()}
    changing = {c: v for c, v in values.items() if len(v) and float(np.ptp(v)) > 0}
    constants = {c: float(v[0]) for c, v in values.items() if len(v) and c not in changing}
    return Probe(names, changing, constants, min(int(good.sum()), enough))


def _numeric(source: LogSource, column: int) -> bool:
    with suppress(UnreadableLog):
        first = next(iter(source.batches([column], _FIRST_BYTES)), None)
        if first is not None:
            cells = len(first.lines) + len(first.bad_lines)
            return bool(np.isfinite(first.values[column]).sum() > _FILLED * cells)
    return False
