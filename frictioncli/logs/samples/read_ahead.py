"""Logs read in chunks, parsed ahead in threads."""

from collections import deque
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import chain, groupby
from typing import TypeVar

from frictioncli.logs.log_source import RawBatch, ReadTask, UnreadableLog
from frictioncli.logs.samples.chunks import LogChunk, PlannedLog, convert_chunk, empty_chunk
from frictioncli.logs.samples.log_rows import RejectedRows

T = TypeVar("T")

THREADS = 2
"""Parsing and writing then keep two cores busy; a third thread gains little."""

_WAITING = 2
"""Results that may wait per thread: enough to even out, few enough to bound memory."""

_GROUP_BYTES = 1 << 21
"""Smaller tasks go to a thread in groups of this size: handing one over takes its own time."""

_GROUP_TASKS = 1 << 8
"""Results of a few rows take 2 kB each, whatever the size of the file."""


def read_chunks(
    logs: Sequence[PlannedLog], batch_bytes: int
) -> Iterator[tuple[PlannedLog, Iterator[LogChunk]]]:
    """Yield each log with its chunks in order; parsing runs ahead, into the next logs too.

    The iterator of chunks raises ``UnreadableLog`` where a log cannot be read further.

    Parameters
    ----------
    logs : sequence of PlannedLog
        The logs.
    batch_bytes : int
        Size of a chunk in the file. [byte]
    """
    given_up: set[int] = set()
    results = chain.from_iterable(in_order(_grouped(_tasks(logs, batch_bytes, given_up))))
    for number, group in groupby(results, key=lambda result: result.number):
        yield logs[number], _chunks(group, given_up)


def in_order(tasks: Iterable[Callable[[], T]]) -> Iterator[T]:
    """Yield the results of tasks in their order; a few are computed ahead in threads.

    Tasks are taken from the iterable in the caller's thread. An error of a task is raised where
    its result would come.
    """
    waiting: deque[Future[T]] = deque()
    pool = ThreadPoolExecutor(THREADS)
    try:
        for task in tasks:
            waiting.append(pool.submit(task))
            if len(waiting) > THREADS * _WAITING:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)


@dataclass(frozen=True, slots=True)
class _ChunkResult:
    """A chunk of the log with this number, or why the log cannot be read further."""

    number: int
    chunk: LogChunk | UnreadableLog


def _chunks(results: Iterable[_ChunkResult], given_up: set[int]) -> Iterator[LogChunk]:
    """Yield the chunks of a log up to where hardly any row was usable."""
    rows_read, rejected = 0, RejectedRows()
    for result in results:
        if isinstance(result.chunk, UnreadableLog):
            raise result.chunk
        rows_read += result.chunk.rows_read
        rejected.count += result.chunk.rejected.count
        if rejected.are_hopeless(rows_read):
            given_up.add(result.number)
        yield result.chunk
        if result.number in given_up:
            return


def _tasks(
    logs: Iterable[PlannedLog], batch_bytes: int, given_up: Container[int]
) -> Iterator[ReadTask[_ChunkResult]]:
    """Yield the tasks of all logs one after the other; each log has at least one."""
    for number, planned in enumerate(logs):
        last: LogChunk | UnreadableLog | None = empty_chunk(planned)
        try:
            for task in planned.log.source.tasks(planned.columns, batch_bytes):
                yield ReadTask(partial(_read, number, planned, task), task.size)
                last = None
                if number in given_up:
                    break
        except UnreadableLog as error:
            last = error
        if last is not None:
            yield ReadTask(partial(_ChunkResult, number, last), 0)


def _read(number: int, planned: PlannedLog, task: ReadTask[RawBatch]) -> _ChunkResult:
    try:
        return _ChunkResult(number, convert_chunk(task.read(), planned))
    except UnreadableLog as error:
        return _ChunkResult(number, error)


def _grouped(
    tasks: Iterable[ReadTask[_ChunkResult]],
) -> Iterator[Callable[[], list[_ChunkResult]]]:
    """Yield tasks that each do a group of consecutive small tasks."""
    group: list[ReadTask[_ChunkResult]] = []
    group_bytes = 0
    for task in tasks:
        if len(group) == _GROUP_TASKS or (group and group_bytes + task.size > _GROUP_BYTES):
            yield partial(_read_all, group)
            group, group_bytes = [], 0
        group.append(task)
        group_bytes += task.size
    yield partial(_read_all, group)


def _read_all(tasks: Iterable[ReadTask[_ChunkResult]]) -> list[_ChunkResult]:
    return [task.read() for task in tasks]
