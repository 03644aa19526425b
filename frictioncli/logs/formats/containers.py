"""Parts shared by the readers of binary containers: the log source, errors, column names."""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.recognition import recognise_channels
from frictioncli.logs.log_source import (
    MAX_ROW_TEXT,
    RawBatch,
    Refusal,
    SequentialSource,
    UnreadableLog,
)
from frictioncli.plain_text import printable

Rows = dict[int, Array]
"""Values of consecutive rows by column index, NaN where a value is missing."""

_MAX_REASON = 200
_NUMBER_BYTES = 8
_MIN_ROWS = 64


@dataclass(frozen=True, slots=True)
class ContainerLog(SequentialSource):
    """A table inside a binary container.

    Attributes
    ----------
    path : Path
        The file.
    columns : tuple of str
        Column names, with units in brackets where given.
    form : str
        The container in words.
    rows : callable
        Takes ascending column indices and the number of rows to hold at a time; yields
        :data:`Rows` in order.

    Notes
    -----
    Line numbers are row numbers from 1.
    """

    path: Path
    columns: tuple[str, ...]
    form: str
    rows: Callable[[Sequence[int], int], Iterator[Rows]]

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of numbers."""
        wanted = sorted(columns)
        rows_at_a_time = max(size // (_NUMBER_BYTES * max(len(wanted), 1)), _MIN_ROWS)
        line = 1
        with unreadable_on_error(f"cannot be read to its end as {self.form}"):
            for values in self.rows(wanted, rows_at_a_time):
                count = len(next(iter(values.values()), ()))
                if not count:
                    continue
                lines = np.arange(line, line + count, dtype=np.int64)
                yield RawBatch(lines, values, np.empty(0, np.int64), ())
                line += count

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending.

        The text of a row lists its values with their names.
        """
        named = [index for index, name in enumerate(self.columns) if name]
        position = 0
        for batch in self.batches(named, size):
            while position < len(lines) and lines[position] <= batch.lines[-1]:
                row = int(lines[position] - batch.lines[0])
                cells = (f"{self.columns[i]} {batch.values[i][row]:.9g}" for i in named)
                yield int(lines[position]), "; ".join(cells)[:MAX_ROW_TEXT]
                position += 1
            if position == len(lines):
                return


@contextmanager
def unreadable_on_error(problem: str) -> Iterator[None]:
    """Turn any exception that a container's library raises into an :class:`UnreadableLog`.

    Parameters
    ----------
    problem : str
        Beginning of the message, for example ``cannot be read as an Arrow table``.

    Raises
    ------
    UnreadableLog
        If anything is raised inside the block.
    """
    try:
        yield
    except UnreadableLog:
        raise
    except Exception as error:  # libraries raise anything, from KeyError to RuntimeError
        lines = str(error).strip().splitlines()
        why = lines[0][:_MAX_REASON] if lines else type(error).__name__
        raise UnreadableLog(f"{problem} ({why}); expected a whole file: copy it again") from error


def refuse_without_package(what: str, extra: str) -> Refusal:
    """Return the refusal of a container whose optional package is not installed.

    Parameters
    ----------
    what : str
        The container in words, for example ``an HDF5 file``.
    extra : str
        The optional extra that installs the package.
    """
    return Refusal(
        "package_missing",
        f"{what} is read with an optional package that is not installed here: pip install"
        f" 'frictioncli[{extra}]'",
    )


def with_unit(name: str, unit: str) -> str:
    """Return a column name with its unit in brackets, unless it has one or none is known.

    Examples
    --------
    >>> with_unit("torque", "N·m"), with_unit("torque [A]", "N·m"), with_unit("torque", "")
    ('torque [N·m]', 'torque [A]', 'torque')
    """
    return f"{name} [{unit}]" if unit and not split_unit(name)[1] else name


def recognised_quantities(columns: Sequence[str]) -> set[str]:
    """Return the quantities that column names are recognised as."""
    return {channel.quantity for channel in recognise_channels(columns)}


def first_names(names: Sequence[str], count: int = 6) -> str:
    """Return the first names for a message, and how many more there are.

    Examples
    --------
    >>> first_names(["a", "b", "c"], 2)
    'a, b and 1 more'
    """
    rest = len(names) - count
    shown = ", ".join(printable(name) for name in names[:count])
    return shown + (f" and {rest} more" if rest > 0 else "")
