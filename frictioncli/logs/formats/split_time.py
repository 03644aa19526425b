"""Time that a log splits into two columns: seconds and nanoseconds, or date and time of day."""

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from frictioncli.logs.formats.continuous_clock import ContinuousClock
from frictioncli.logs.formats.delimited import DelimitedText
from frictioncli.logs.formats.moments import CLOCK, DAY
from frictioncli.logs.log_source import DerivedSource, LogSource, RawBatch, ReadTask

_NANOSECOND = 1e-9  # [s]
_NO_KEY = re.compile(r"[^a-z0-9]")
_SECONDS = re.compile(r"^(?P<stem>.*?)sec(?:onds|s)?$")
_NANOSECONDS = re.compile(r"^(?P<stem>.*?)n(?:ano)?sec(?:onds|s)?$")


def with_joined_time(source: LogSource) -> LogSource:
    """Return a source whose time is in one column and does not fall back at midnight.

    The names of seconds and nanoseconds have the same stem: ``tsec`` and ``tnsec``, ``ZeitInSec``
    and ``ZeitInNanoSec``, ``header.stamp.sec`` and ``header.stamp.nanosec``. A column of dates
    alone and one of times of day are known by their cells. Days are added to times of day without
    a date. Other sources are returned unchanged.
    """
    pair = _pair(source.columns)
    if pair is not None:
        return JoinedTime(source, *pair, _NANOSECOND)
    if not isinstance(source, DelimitedText):
        return source
    forms = source.dialect.dates
    days = [column for column, form in forms.items() if not form.has_clock]
    clocks = [column for column, form in forms.items() if form.order == CLOCK]
    if days and clocks:
        return JoinedTime(source, clocks[0], days[0], 1.0)
    return ContinuousClock(source, clocks[0], DAY) if clocks else source


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
class JoinedTime(DerivedSource):
    """A source whose time is the sum of two columns.

    Attributes
    ----------
    source : LogSource
        The log with two columns.
    seconds, rest : int
        The two columns. Both become the time; the second has no name.
    unit : float
        What a number in the second column stands for. [s]
    """

    seconds: int
    rest: int
    unit: float

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names, with ``time [s]`` for the joined column."""
        names = list(self.source.columns)
        names[self.seconds], names[self.rest] = "time [s]", ""
        return tuple(names)

    @property
    def form(self) -> str:
        """The file's form in words."""
        first, second = sorted((self.seconds, self.rest))
        names = f"{self.source.columns[first]} and {self.source.columns[second]}"
        return f"{self.source.form}, time from {names}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        for batch in self.source.batches(self._with_rest(columns), size):
            yield self._joined(batch)

    def tasks(self, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order the tasks that read the batches, each of at most about ``size`` bytes."""
        for task in self.source.tasks(self._with_rest(columns), size):
            yield ReadTask(partial(self._read, task), task.size)

    def _with_rest(self, columns: Collection[int]) -> set[int]:
        both = {self.seconds, self.rest}
        return {*columns, *(both if both.intersection(columns) else ())}

    def _read(self, task: ReadTask[RawBatch]) -> RawBatch:
        return self._joined(task.read())

    def _joined(self, batch: RawBatch) -> RawBatch:
        if self.rest not in batch.values:
            return batch
        with np.errstate(over="ignore", invalid="ignore"):  # infinite times are rejected later
            time = batch.values[self.seconds] + batch.values[self.rest] * self.unit
        values = {**batch.values, self.seconds: time, self.rest: time}
        return RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)
