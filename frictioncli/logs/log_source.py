"""The interface between file formats and the rest: an opened log, or why it is refused.

A format's reader returns a :class:`LogSource`, which gives the raw columns of one log in batches
of rows, or a :class:`Refusal`.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from frictioncli.arrays import Array, Numbers
from frictioncli.errors import LogError

T = TypeVar("T")

MAX_ROW_TEXT = 200
"""Longest text that is kept of a row. [characters]"""


class UnreadableLog(LogError):
    """A file that cannot be opened, or cannot be read to its end."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a whole file cannot be used.

    Attributes
    ----------
    reason : str
        One of a fixed list of reasons, for example ``no_torque_channel``.
    text : str
        What was found and what was expected, for the user.
    """

    reason: str
    text: str


@dataclass(frozen=True, slots=True)
class CsvHints:
    """What the user says about the form of a text file; None where it is to be detected.

    Attributes
    ----------
    delimiter : str or None
        ``;``, ``,``, tab, or a blank for any run of blanks.
    decimal : str or None
        ``.`` or ``,``.
    encoding : str or None
        A Python encoding name.
    period : float or None
        Time from row to row of a log without a column of time. [s]
    """

    delimiter: str | None = None
    decimal: str | None = None
    encoding: str | None = None
    period: float | None = None


@dataclass(frozen=True, slots=True)
class RawBatch:
    """Consecutive rows of a log with the values that stand in the file.

    Attributes
    ----------
    lines : ndarray of int, shape (n,)
        Line number of each readable row in the file, from 1.
    values : dict of int to ndarray of float, shape (n,)
        Values by column index; NaN where the cell is empty.
    bad_lines : ndarray of int, shape (m,)
        Line numbers of the rows that could not be read.
    bad_reasons : tuple of str
        The reason for each bad line.
    """

    lines: Numbers
    values: dict[int, Array]
    bad_lines: Numbers
    bad_reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ReadTask(Generic[T]):
    """A piece of reading that may run in its own thread.

    Attributes
    ----------
    read : callable
        Does the work and returns the result.
    size : int
        Approximate size of the result. [byte]
    """

    read: Callable[[], T]
    size: int


class LogSource(Protocol):
    """An opened log whose columns are known and whose rows can be streamed more than once."""

    @property
    def path(self) -> Path:
        """The file."""
        ...

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that its samples come from."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names as they stand in the file, with units in brackets where given."""
        ...

    @property
    def form(self) -> str:
        """The file's form in words, for example ``text, ';', decimal comma, UTF-8``."""
        ...

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        ...

    def tasks(self, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order the tasks that read the batches, each of at most about ``size`` bytes."""
        ...

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending."""
        ...


class SequentialSource:
    """Base of sources with one file whose batches can only be read one after the other."""

    @property
    def files(self: LogSource) -> tuple[Path, ...]:
        """All files that its samples come from."""
        return (self.path,)

    def tasks(self: LogSource, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order tasks whose batches are already read."""
        for batch in self.batches(columns, size):
            size_read = sum(values.nbytes for values in batch.values.values())
            yield ReadTask(partial(_identity, batch), size_read)


@dataclass(frozen=True, slots=True)
class DerivedSource(SequentialSource):
    """Base of sources that change or add to the rows of another one.

    Attributes
    ----------
    source : LogSource
        The other one.
    """

    source: LogSource

    @property
    def path(self) -> Path:
        """The file."""
        return self.source.path

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that its samples come from."""
        return self.source.files

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names as they stand in the file."""
        return self.source.columns

    @property
    def form(self) -> str:
        """The file's form in words."""
        return self.source.form

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending."""
        return self.source.texts(lines, size)


def _identity(batch: RawBatch) -> RawBatch:
    return batch
