"""Time that a log splits into two columns, seconds and nanoseconds."""

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from frictioncli.arrays import Numbers
from frictioncli.logs.log_source import LogSource, RawBatch, ReadTask

_NO_KEY = re.compile(r"[^a-z0-9]")
_SECONDS = re.compile(r"^(?P<stem>.*?)sec(?:onds|s)?$")
_NANOSECONDS = re.compile(r"^(?P<stem>.*?)n(?:ano)?sec(?:onds|s)?$")


def with_joined_time(source: LogSource) -> LogSource:
    """Return a source whose first pair of seconds and nanoseconds is joined into one time.

    The names of a pair have the same stem: ``tsec`` and ``tnsec``, ``ZeitInSec`` and
    ``ZeitInNanoSec``, ``header.stamp.sec`` and ``header.stamp.nanosec``. A source without such a
    pair is returned unchanged.
    """
    pair = _pair(source.columns)
    return source if pair is None else JoinedTime(source, *pair)


def _pair(columns: Sequence[str]) -> tuple[int, int] | None:
    """Return the columns of seconds and nanoseconds, None where there is no pair."""
    plain = [_NO_KEY.sub("", column.lower()) for column in columns]
    parts: dict[str, int] = {}
    for index, name in enumerate(plain):
        found = _NANOSECONDS.match(name)
        if found is not None:
            parts.setdefault(found["stem"], index)
    for index, name in enumerate(plain):
        found = _SECONDS.match(name)
        if found is not None and parts.get(found["stem"], index) != index:
            return index, parts[found["stem"]]
    return None


@dataclass(frozen=True, slots=True)
class JoinedTime:
    """A source with the nanoseconds added to the seconds.

    Attributes
    ----------
    source : LogSource
        The log with two columns.
    seconds, nanoseconds : int
        The two columns. The first becomes the time, the second has no name.
    """

    source: LogSource
    seconds: int
    nanoseconds: int

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
        """Column names, with ``time [s]`` for the joined column."""
        names = list(self.source.columns)
        names[self.seconds], names[self.nanoseconds] = "time [s]", ""
        return tuple(names)

    @property
    def form(self) -> str:
        """The file's form in words."""
        seconds, nanoseconds = (self.source.columns[i] for i in (self.seconds, self.nanoseconds))
        return f"{self.source.form}, time from {seconds} and {nanoseconds}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        for batch in self.source.batches(self._with_nanoseconds(columns), size):
            yield self._joined(batch)

    def tasks(self, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order the tasks that read the batches, each of at most about ``size`` bytes."""
        for task in self.source.tasks(self._with_nanoseconds(columns), size):
            yield ReadTask(partial(self._read, task), task.size)

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending."""
        return self.source.texts(lines, size)

    def _with_nanoseconds(self, columns: Collection[int]) -> set[int]:
        return {*columns, *([self.nanoseconds] if self.seconds in columns else [])}

    def _read(self, task: ReadTask[RawBatch]) -> RawBatch:
        return self._joined(task.read())

    def _joined(self, batch: RawBatch) -> RawBatch:
        if self.nanoseconds not in batch.values:
            return batch
        values = dict(batch.values)
        if self.seconds in values:
            values[self.seconds] = values[self.seconds] + values[self.nanoseconds] * 1e-9
        return RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)
