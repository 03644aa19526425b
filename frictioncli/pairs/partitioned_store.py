"""Tables on disk between two passes: pages of columns by key, so that memory stays bounded."""

import tempfile
from collections.abc import Hashable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Generic, Self, TypeVar

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.files import DRAFT, cannot_write

Columns = dict[str, NDArray]
Key = TypeVar("Key", bound=Hashable)

_HELD = 1 << 23
"""Bytes that wait in memory before they are written."""

_OVERHEAD = 256
"""Bytes that an array needs beside its values."""


class PartitionedStore(Generic[Key]):
    """Tables that belong together, in pages of some rows of each, by key.

    Parameters
    ----------
    folder : Path
        Where they may lie until the block ends.

    Raises
    ------
    FrictionError
        If that folder cannot be written to.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._stack = ExitStack()
        self._waiting: dict[Key, list[Mapping[str, Columns]]] = {}
        self._held = 0
        self._pages: dict[Key, list[int]] = {}
        self._writers: dict[str, pa.ipc.RecordBatchFileWriter] = {}
        self._readers: dict[str, pa.ipc.RecordBatchFileReader] = {}
        self._count = 0

    def __enter__(self) -> Self:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            box = tempfile.TemporaryDirectory(
                prefix=DRAFT, dir=self._folder, ignore_cleanup_errors=True
            )
        except OSError as error:
            raise cannot_write(self._folder, error) from error
        self._box = Path(self._stack.enter_context(box))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.close()

    def add(self, key: Key, tables: Mapping[str, Columns]) -> None:
        """Append rows of every table to a key's; all calls have the same tables and columns."""
        self._waiting.setdefault(key, []).append(tables)
        self._held += sum(
            values.nbytes + _OVERHEAD for table in tables.values() for values in table.values()
        )
        if self._held > _HELD:
            self._flush()

    @property
    def keys(self) -> list[Key]:
        """Keys in the order in which they came."""
        self._flush()
        return list(self._pages)

    def of(self, key: Key, *names: str) -> Iterator[tuple[Columns, ...]]:
        """Yield a key's rows page by page, of the tables named; nothing may be added any more."""
        self._flush()
        for number in self._pages[key]:
            yield tuple(self._page(name, number) for name in names)

    def _flush(self) -> None:
        try:
            for key, parts in self._waiting.items():
                for name in parts[0]:
                    self._write(name, _joined([part[name] for part in parts]))
                self._pages.setdefault(key, []).append(self._count)
                self._count += 1
        except OSError as error:
            raise cannot_write(self._folder, error) from error
        self._waiting, self._held = {}, 0

    def _write(self, name: str, columns: Columns) -> None:
        batch = pa.RecordBatch.from_pydict({key: pa.array(of) for key, of in columns.items()})
        if name not in self._writers:
            sink = self._stack.enter_context(pa.OSFile(str(self._box / name), "wb"))
            self._writers[name] = pa.ipc.new_file(
                sink, batch.schema, options=pa.ipc.IpcWriteOptions(compression="lz4")
            )
        self._writers[name].write_batch(batch)

    def _page(self, name: str, number: int) -> Columns:
        if name not in self._readers:
            self._writers[name].close()
            source = self._stack.enter_context(pa.OSFile(str(self._box / name), "rb"))
            self._readers[name] = pa.ipc.open_file(source)
        batch = self._readers[name].get_batch(number)
        return {key: batch.column(key).to_numpy(zero_copy_only=False) for key in batch.schema.names}


def _joined(parts: list[Columns]) -> Columns:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
