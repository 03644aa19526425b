"""What binary containers share: a source of numbered rows, and what may go wrong with them."""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.logs.channels.recognition import recognise_channels, split_unit
from frictioncli.logs.log_source import RawBatch, Refusal, SequentialSource, UnreadableLog

Rows = dict[int, Array]
"""Column index to values of consecutive rows, NaN where there is none."""

_TEXT_LIMIT = 200
_NUMBER_BYTES = 8
_LEAST_ROWS = 64


@dataclass(frozen=True, slots=True)
class ContainerLog(SequentialSource):
    """A table inside a binary container.

    Attributes
    ----------
    path : Path
        The file.
    columns : tuple of str
        Column names, units in brackets where given.
    form : str
        The container in words.
    rows : callable
        Takes column indices (ascending) and how many rows to hold at a time, yields :data:`Rows`
        in order. Line numbers are row numbers from 1.
    """

    path: Path
    columns: tuple[str, ...]
    form: str
    rows: Callable[[Sequence[int], int], Iterator[Rows]]

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, about ``size`` bytes of numbers at a time."""
        wanted = sorted(columns)
        at_a_time = max(size // (_NUMBER_BYTES * max(len(wanted), 1)), _LEAST_ROWS)
        line = 1
        with readable(f"cannot be read to its end as {self.form}"):
            for values in self.rows(wanted, at_a_time):
                count = len(next(iter(values.values()), ()))
                if not count:
                    continue
                lines = np.arange(line, line + count, dtype=np.int64)
                yield RawBatch(lines, values, np.empty(0, np.int64), ())
                line += count

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the asked lines, which must be ascending.

        A row's text is its values with their names.
        """
        named = [index for index, name in enumerate(self.columns) if name]
        position = 0
        for batch in self.batches(named, size):
            while position < len(lines) and lines[position] <= batch.lines[-1]:
                row = int(lines[position] - batch.lines[0])
                cells = (f"{self.columns[i]} {batch.values[i][row]:.9g}" for i in named)
                yield int(lines[position]), "; ".join(cells)[:_TEXT_LIMIT]
                position += 1
            if position == len(lines):
                return


@contextmanager
def readable(what: str) -> Iterator[None]:
    """Turn whatever a container's library raises over a damaged file into an UnreadableLog.

    Parameters
    ----------
    what : str
        What then cannot be done, for the message.

    Raises
    ------
    UnreadableLog
        If anything is raised inside.
    """
    try:
        yield
    except UnreadableLog:
        raise
    except Exception as error:  # libraries raise anything, from KeyError to RuntimeError
        said = str(error).strip().splitlines()
        why = said[0][:_TEXT_LIMIT] if said else type(error).__name__
        raise UnreadableLog(f"{what} ({why}); expected a whole file: copy it again") from error


def lacks_package(what: str, extra: str) -> Refusal:
    """Return the refusal of a container whose optional package is not installed.

    Parameters
    ----------
    what : str
        The container, for example ``an HDF5 file``.
    extra : str
        The optional extra that brings the package.
    """
    return Refusal(
        "package_missing",
        f"{what} is read with an optional package that is not installed here: pip install"
        f" 'frictioncli[{extra}]'",
    )


def with_unit(name: str, unit: str) -> str:
    """Return a column name with its unit in brackets, unless it is unknown or there already."""
    return f"{name} [{unit}]" if unit and not split_unit(name)[1] else name


def quantities(columns: Sequence[str]) -> set[str]:
    """Return which quantities some columns hold by their names."""
    return {channel.quantity for channel in recognise_channels(columns)}


def listed(names: Sequence[str], most: int = 6) -> str:
    """Return names for a message, the first few of many."""
    rest = len(names) - most
    return ", ".join(names[:most]) + (f" and {rest} more" if rest > 0 else "")
