"""Fetching ahead: a thread reads the next rows while the last ones are used."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

_Item = TypeVar("_Item")


def prefetch(items: Iterator[_Item]) -> Iterator[_Item]:
    """Yield the items of an iterator, while a thread fetches the next one."""
    with ThreadPoolExecutor(1) as pool:
        fetched = pool.submit(next, items, None)
        while (item := fetched.result()) is not None:
            fetched = pool.submit(next, items, None)
            yield item
