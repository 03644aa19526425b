"""What a reader of one file format gives: named raw columns in batches, or why it cannot."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from frictioncli.arrays import Array, Numbers

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a whole file cannot be used: a reason from a fixed list and a text for people."""

    reason: str
    text: str


@dataclass(frozen=True, slots=True)
class CsvHints:
    """What the user says of a text file's form; None where it is to be found.

    Attributes
    ----------
    delimiter : str or None
        ``;``, ``,``, tab or a blank (any run of blanks).
    decimal : str or None
        ``.`` or ``,``.
    encoding : str or None
        A Python encoding name.
    """

    delimiter: str | None = None
    decimal: str | None = None
    encoding: str | None = None


@dataclass(frozen=True, slots=True)
class RawBatch:
    """Consecutive rows of a log, as they stand in the file.

    Attributes
    ----------
    lines : ndarray of int, shape (n,)
        Line of each readable row in the file, from 1.
    values : dict of int to ndarray of float, shape (n,)
        Column index to values; NaN where the cell is empty.
    bad_lines : ndarray of int, shape (m,)
        Lines that could not be read.
    bad_reasons : tuple of str
        Why, one per bad line.
    """

    lines: Numbers
    values: dict[int, Array]
    bad_lines: Numbers
    bad_reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Task(Generic[T]):
    """Reading that may be done in a thread of its own; what it makes has about so many bytes."""

    read: Callable[[], T]
    size: int


class Source(Protocol):
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
        """Column names as they stand in the file, units in brackets where given."""
        ...

    @property
    def form(self) -> str:
        """The file's form in words, for example ``text, ';', decimal comma, UTF-8``."""
        ...

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, about ``size`` bytes of the file at a time."""
        ...

    def tasks(self, columns: Collection[int], size: int) -> Iterator[Task[RawBatch]]:
        """Yield in order what makes the batches, each of at most about ``size`` bytes."""
        ...

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the asked lines, which must be ascending."""
        ...


class OneStream:
    """What is the same for all sources of one file whose batches come one after the other."""

    @property
    def files(self: Source) -> tuple[Path, ...]:
        """All files that its samples come from."""
        return (self.path,)

    def tasks(self: Source, columns: Collection[int], size: int) -> Iterator[Task[RawBatch]]:
        """Yield in order what makes the batches; they are ready already."""
        for batch in self.batches(columns, size):
            yield Task(partial(_ready, batch), sum(v.nbytes for v in batch.values.values()))


def _ready(batch: RawBatch) -> RawBatch:
    return batch


class Reader(Protocol):
    """One file format: looks at a file's beginning and opens it, refuses it or passes it on."""

    def __call__(self, path: Path, head: bytes, hints: CsvHints) -> Source | Refusal | None:
        """Return the opened log, why it cannot be read, or None when it is another format."""
        ...
