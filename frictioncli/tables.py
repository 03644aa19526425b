"""Parquet tables of the work folder: checked against their schema, with units and provenance.

Every file carries, per column, ``unit`` and ``description``, and in its own metadata under
``frictioncli`` a JSON object with the provenance and the *facts* that later stages need and that
are no column: ``torque_unit``, ``torque_side``, notes.
"""

import base64
import json
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar

import pyarrow as pa
import pyarrow.parquet as pq

from frictioncli.errors import TableError
from frictioncli.files import whole
from frictioncli.provenance import Provenance
from frictioncli.quantities import TORQUE
from frictioncli.schemas import Table

if TYPE_CHECKING:
    # takes longer to import than most logs to read
    import pandas as pd

_KEY = b"frictioncli"
_BATCH_ROWS = 1 << 17
_READ_BYTES = 1 << 20
_Item = TypeVar("_Item")
_GROUP_BYTES = 1 << 23
"""Rows are written this many bytes at a time: small groups make a file slow to read."""

_WRITTEN_ROWS = 1 << 16
"""Rows that are encoded at once: pyarrow's default, 1024, takes a third longer."""


class TableWriter:
    """Write a table batch by batch; the file takes its place when the block ends without error.

    ``provenance`` and ``facts`` stand at the end of the file and may be set until the block ends:
    some are known only when all rows have gone by.

    Parameters
    ----------
    path : Path
        The Parquet file to make.
    table : Table
        Its schema.
    provenance : Provenance
        What makes it.
    facts : mapping, optional
        What later stages must know beside the columns; ``torque_unit`` fills in the torque unit.

    Notes
    -----
    Numbers are split into their bytes before they are compressed with LZ4: logs then take half the
    time of pyarrow's defaults to write and to read, at about the same size.
    """

    def __init__(
        self,
        path: Path,
        table: Table,
        provenance: Provenance,
        facts: Mapping[str, Any] | None = None,
    ) -> None:
        self.provenance = provenance
        self.facts = facts or {}
        self._table = table
        self._schema = bare_schema(table)
        self._path = path
        self._stack = ExitStack()
        self._held: list[pa.Table] = []
        self._held_bytes = 0
        self.rows = 0

    def __enter__(self) -> Self:
        draft = self._stack.enter_context(whole(self._path))
        numbers = [f.name for f in self._schema if pa.types.is_floating(f.type)]
        labels = [name for name in self._schema.names if name not in numbers]
        counts = [f.name for f in self._schema if pa.types.is_integer(f.type)]
        self._writer = pq.ParquetWriter(
            draft,
            self._schema,
            compression="lz4",
            use_dictionary=labels,
            use_byte_stream_split=numbers,
            # of texts they take longer to make than the texts to write
            write_statistics=[*counts, "time"],
            write_batch_size=_WRITTEN_ROWS,
            # the schema with its metadata is stored at the end
            store_schema=False,
        )
        self._stack.push(self._ended)
        self._thread = self._stack.enter_context(ThreadPoolExecutor(1))
        self._writing: Future[None] | None = None
        return self

    def write(self, batch: "pa.RecordBatch | pa.Table | pd.DataFrame") -> None:
        """Append rows; columns are matched by name and those that are missing become null."""
        if not isinstance(batch, pa.RecordBatch | pa.Table):
            batch = pa.Table.from_pandas(batch, preserve_index=False)
        rows = conform(batch, self._table, self._schema)
        self.rows += rows.num_rows
        self._held.append(rows)
        self._held_bytes += rows.nbytes
        if self._held_bytes >= _GROUP_BYTES:
            self._flush()

    def close(self) -> None:
        """Put the file in its place; leaving the block then does no more."""
        self.__exit__(None, None, None)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._stack:
            if error is not None:
                raise error
            self._flush()
            self._written()

    def _flush(self) -> None:
        """Write what is held, in a thread: the caller goes on, one group of rows ahead."""
        self._written()
        if self._held:
            rows = pa.concat_tables(self._held).unify_dictionaries()
            self._writing = self._thread.submit(self._writer.write_table, rows)
        self._held, self._held_bytes = [], 0

    def _written(self) -> None:
        if self._writing is not None:
            self._writing.result()

    def _ended(self, kind: type[BaseException] | None, *_: object) -> None:
        with self._writer:
            if kind is None:
                schema = arrow_schema(self._table, self.provenance, self.facts)
                # as pyarrow itself stores a schema that it knows from the start
                stored = {b"ARROW:schema": base64.b64encode(schema.serialize())}
                self._writer.add_key_value_metadata(stored | schema.metadata)


def arrow_schema(table: Table, provenance: Provenance, facts: Mapping[str, Any]) -> pa.Schema:
    """Return the Arrow schema of a table with units, provenance and facts in its metadata."""
    torque_unit = facts.get("torque_unit", "N·m")
    fields = [
        pa.field(
            column.name,
            column.type,
            nullable=column.nullable,
            metadata={
                "unit": torque_unit if column.unit == TORQUE else column.unit,
                "description": column.description,
            },
        )
        for column in table.columns
    ]
    document = provenance.as_dict() | {"table": table.name, "row": table.row, "facts": dict(facts)}
    return pa.schema(fields, metadata={_KEY: json.dumps(document, ensure_ascii=False).encode()})


def bare_schema(table: Table) -> pa.Schema:
    """Return the Arrow schema of a table without metadata.

    What must be there is declared so: pages without marks of absence take half the time.
    """
    return pa.schema([pa.field(c.name, c.type, c.nullable) for c in table.columns])


def conform(rows: pa.RecordBatch | pa.Table, table: Table, schema: pa.Schema) -> pa.Table:
    """Return ``rows`` with the columns and types of ``table``.

    Raises
    ------
    TableError
        If a required column is missing or holds nulls, or a type cannot be converted.
    """
    if isinstance(rows, pa.RecordBatch):
        rows = pa.Table.from_batches([rows])
    missing = [name for name in table.required if name not in rows.column_names]
    if missing:
        raise TableError(f"{table.name}: columns {', '.join(missing)} are missing")
    columns = []
    for column in table.columns:
        if column.name not in rows.column_names:
            columns.append(pa.nulls(rows.num_rows, column.type))
            continue
        values = rows.column(column.name)
        if not values.type.equals(column.type):
            try:
                values = values.cast(column.type)
            except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
                raise TableError(
                    f"{table.name}: column {column.name} is {values.type}, expected {column.type}"
                ) from error
        if not column.nullable and values.null_count:
            raise TableError(
                f"{table.name}: column {column.name} has {values.null_count} empty values,"
                " expected none"
            )
        columns.append(values)
    return pa.table(columns, schema=schema)


def write(
    path: Path,
    rows: "pd.DataFrame | pa.Table",
    table: Table,
    provenance: Provenance,
    facts: Mapping[str, Any] | None = None,
) -> None:
    """Write a whole table."""
    with TableWriter(path, table, provenance, facts) as writer:
        writer.write(rows)


def read(path: Path, table: Table) -> "pd.DataFrame":
    """Read a whole table; labels come as plain strings, columns that may be null may be absent.

    Raises
    ------
    TableError
        If the file is missing, is no Parquet file, or lacks a column.
    """
    with _opened(path, table) as file:
        present = [name for name in table.names if name in file.schema_arrow.names]
        frame = file.read(columns=present).to_pandas()
    for column in table.columns:
        if column.name not in frame:
            frame[column.name] = pa.nulls(len(frame), pa.float64()).to_pandas()
        if frame[column.name].dtype == "category":
            frame[column.name] = frame[column.name].astype(frame[column.name].cat.categories.dtype)
    return frame[list(table.names)]


def batches(path: Path, table: Table, rows: int = _BATCH_ROWS) -> Iterator[pa.RecordBatch]:
    """Yield a table's rows in order, a bounded number at a time; of a folder, file by file.

    Raises
    ------
    TableError
        As :func:`read`, and if a required column holds nulls or a type cannot be converted.
    """
    for part in sorted(path.glob("*.parquet")) if path.is_dir() else [path]:
        with _opened(part, table) as file:
            present = [name for name in table.names if name in file.schema_arrow.names]
            # handing columns to other threads costs half as much as decoding them
            for batch in file.iter_batches(batch_size=rows, columns=present, use_threads=False):
                yield batch if _sound(batch, table) else _mended(batch, table, part)


def ahead(items: Iterator[_Item]) -> Iterator[_Item]:
    """Yield what an iterator yields, while a thread already fetches the next one."""
    with ThreadPoolExecutor(1) as pool:
        coming = pool.submit(next, items, None)
        while (item := coming.result()) is not None:
            coming = pool.submit(next, items, None)
            yield item


def _sound(batch: pa.RecordBatch, table: Table) -> bool:
    own = {column.name: column for column in table.columns}
    return all(
        values.type.equals(own[name].type) and (own[name].nullable or not values.null_count)
        for name, values in zip(batch.schema.names, batch.columns, strict=True)
    )


def _mended(batch: pa.RecordBatch, table: Table, path: Path) -> pa.RecordBatch:
    try:
        return conform(batch, table, bare_schema(table)).combine_chunks().to_batches()[0]
    except TableError as error:
        raise TableError(f"{path}: {error}") from error


def facts(path: Path) -> dict[str, Any]:
    """Return what earlier stages noted beside the columns; empty for a foreign file."""
    return dict(document(path).get("facts", {}))


def document(path: Path) -> dict[str, Any]:
    """Return the provenance and facts of a table; empty for a file made by something else."""
    if path.is_dir():
        path = next(iter(sorted(path.glob("*.parquet"))), path)
    try:
        metadata = pq.read_schema(path).metadata or {}
        return dict(json.loads(metadata.get(_KEY, b"{}")))
    except (OSError, pa.ArrowInvalid, ValueError) as error:
        raise TableError(f"{path}: cannot be read as Parquet ({error})") from error


@contextmanager
def _opened(path: Path, table: Table) -> Iterator[pq.ParquetFile]:
    if not path.exists():
        raise TableError(f"{path} is missing; run the stage that makes {table.name} first")
    try:
        # else a whole row group's bytes would be held beside its values
        file = pq.ParquetFile(path, pre_buffer=False, buffer_size=_READ_BYTES)
    except (OSError, pa.ArrowInvalid) as error:
        raise TableError(f"{path}: cannot be read as Parquet ({error})") from error
    with file:
        missing = [name for name in table.required if name not in file.schema_arrow.names]
        if missing:
            raise TableError(
                f"{path}: columns {', '.join(missing)} are missing, expected"
                f" {', '.join(table.required)}"
            )
        yield file
