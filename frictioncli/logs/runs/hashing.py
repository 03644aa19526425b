"""SHA-256 of the logs, made in a thread while they are looked at and read."""

from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from types import TracebackType
from typing import Self

from frictioncli.provenance import sha256

_TOGETHER = 16
"""So many files are handed over at once: each time the threads have to wait for one another."""


class Hashing:
    """Hashes files in the order of asking; leaving the block gives up what is not done yet."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1)
        self._asked: list[Future[dict[Path, str]]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._pool.shutdown(cancel_futures=True)

    def ask(self, files: Iterable[Path]) -> None:
        """Begin to hash files; each is hashed once."""
        distinct = list(dict.fromkeys(files))
        for start in range(0, len(distinct), _TOGETHER):
            self._asked.append(self._pool.submit(_hashes, distinct[start : start + _TOGETHER]))

    def found(self) -> dict[Path, str]:
        """Return the hashes of all files asked for, when they are done."""
        return {file: text for some in self._asked for file, text in some.result().items()}


def _hashes(files: Sequence[Path]) -> dict[Path, str]:
    return {file: sha256(file) for file in files}
