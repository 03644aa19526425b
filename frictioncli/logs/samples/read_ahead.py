"""Work done ahead in threads: results come in the order of the tasks, whoever was first."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")

THREADS = 2
"""Parsing and writing then keep two cores busy; a third thread gains little."""

_WAITING = 2
"""Results that may wait per thread: enough to even out, few enough to bound memory."""


def in_order(tasks: Iterable[Callable[[], T]]) -> Iterator[T]:
    """Yield what the tasks return, in their order; a few are done ahead in threads.

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
