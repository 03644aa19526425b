"""Column store on disk, partitioned by key."""

import tempfile
from collections.abc import Hashable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Generic, Self, TypeVar

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.files import DRAFT_PREFIX, cannot_write

Columns = dict[str, NDArray]
Key = TypeVar("Key", bound=Hashable)

_BUFFER_BYTES = 1 << 23
"""Bytes that wait in memory before they are written."""

_ARRAY_OVERHEAD = 256
"""Bytes that an array needs beside its values."""


class PartitionedStore(Generic[Key]):
    """Tables that belong together, with rows by key, in a temporary folder.

    Rows are read in batches, in the order in which they were added, so that memory stays bounded.

    Parameters
    ----------
    folder : Path
        Folder in which the temporary folder lies until the block ends.

    Raises
    ------
    FrictionError
        If that folder cannot be written to.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._stack = ExitStack()
        self._buffer: dict[Key, list[Mapping[str, Columns]]] = {}
        self._buffer_bytes = 0
        self._batches: dict[Key, list[int]] = {}
        self._writers: dict[str, pa.ipc.RecordBatchFileWriter] = {}
        self._readers: dict[str, pa.ipc.RecordBatchFileReader] = {}
        self._count = 0

    def __enter__(self) -> Self:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            temporary = tempfile.TemporaryDirectory(
                prefix=DRAFT_PREFIX, dir=self._folder, ignore_cleanup_errors=True
            )
        except OSError as error:
            raise cannot_write(self._folder, error) from error
        self._temporary = Path(self._stack.enter_context(temporary))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.close()

    def add(self, key: Key, tables: Mapping[str, Columns]) -> None:
        """Append rows of every table to a key; all calls have the same tables and columns."""
        self._buffer.setdefault(key, []).append(tables)
        self._buffer_bytes += sum(
            values.nbytes + _ARRAY_OVERHEAD
            for table in tables.values()
            for values in table.values()
        )
        if self._buffer_bytes > _BUFFER_BYTES:
            self._flush()

    @property
    def keys(self) -> list[Key]:
        """Keys in the order in which they were first added."""
        self._flush()
        return list(self._batches)

    def read(self, key: Key, *names: str) -> Iterator[tuple[Columns, ...]]:
        """Yield a key's rows of the named tables in batches; nothing may be added afterwards."""
        self._flush()
        for number in self._batches[key]:
            yield tuple(self._read_batch(name, number) for name in names)

    def _flush(self) -> None:
        try:
            for key, added in self._buffer.items():
                for name in added[0]:
                    self._write(name, _joined([tables[name] for tables in added]))
                self._batches.setdefault(key, []).append(self._count)
                self._count += 1
        except OSError as error:
            raise cannot_write(self._folder, error) from error
        self._buffer, self._buffer_bytes = {}, 0

    def _write(self, name: str, columns: Columns) -> None:
        batch = pa.RecordBatch.from_pydict({key: pa.array(of) for key, of in columns.items()})
        if name not in self._writers:
            sink = self._stack.enter_context(pa.OSFile(str(self._temporary / name), "wb"))
            self._writers[name] = pa.ipc.new_file(
                sink, batch.schema, options=pa.ipc.IpcWriteOptions(compression="lz4")
            )
        self._writers[name].write_batch(batch)

    def _read_batch(self, name: str, number: int) -> Columns:
        if name not in self._readers:
            self._writers[name].close()
            source = self._stack.enter_context(pa.OSFile(str(self._temporary / name), "rb"))
            self._readers[name] = pa.ipc.open_file(source)
        batch = self._readers[name].get_batch(number)
        return {key: batch.column(key).to_numpy(zero_copy_only=False) for key in batch.schema.names}


def _joined(tables: list[Columns]) -> Columns:
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
