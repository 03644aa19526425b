"""Parquet tables of the work folder: checked against their schema, with units and provenance.

The metadata of every column hold ``unit`` and ``description``. The metadata of the file hold, under
``frictioncli``, a JSON object with the provenance and the *facts*, which are what later stages need
beside the columns: ``torque_unit``, ``torque_side``, notes.
"""

import base64
import json
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import pyarrow as pa
import pyarrow.parquet as pq

from frictioncli.errors import TableError
from frictioncli.files import atomic_write, is_there
from frictioncli.parquet_footer import row_groups
from frictioncli.provenance import Provenance
from frictioncli.quantities import TORQUE
from frictioncli.schemas import Table
from frictioncli.workfiles import missing_text

if TYPE_CHECKING:
    # importing it takes longer than reading most logs
    import pandas as pd

_METADATA_KEY = b"frictioncli"
_BATCH_ROWS = 1 << 17
_READ_BYTES = 1 << 20
_GROUP_BYTES = 1 << 23
"""Rows are written this many bytes at a time: small groups make a file slow to read."""

_MORE_ROWS = 50_000_000
"""Groups grow with the table, up to four times: their descriptions stay in memory."""

_WRITTEN_ROWS = 1 << 16
"""Rows that are encoded at once: pyarrow's default, 1024, takes a third longer."""


class TableWriter:
    """Write a table batch by batch; the file appears when the block ends without error.

    ``provenance`` and ``facts`` are written at the end of the file and may be set until then, as
    some are known only after all rows.

    Parameters
    ----------
    path : Path
        The Parquet file to write.
    table : Table
        Its schema.
    provenance : Provenance
        Its origin.
    facts : mapping, optional
        What later stages need beside the columns; ``torque_unit`` sets the torque unit.

    Notes
    -----
    Numbers are split into bytes before they are compressed with LZ4. Logs are then written and read
    in half the time of pyarrow's defaults, at about the same size.
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
        self._buffer: list[pa.Table] = []
        self._buffer_bytes = 0
        self.rows = 0

    def __enter__(self) -> Self:
        draft = self._stack.enter_context(atomic_write(self._path))
        numbers = [f.name for f in self._schema if pa.types.is_floating(f.type)]
        labels = [name for name in self._schema.names if name not in numbers]
        counts = [f.name for f in self._schema if pa.types.is_integer(f.type)]
        self._writer = pq.ParquetWriter(
            draft,
            self._schema,
            compression="lz4",
            use_dictionary=labels,
            use_byte_stream_split=numbers,
            # statistics of texts would take longer than writing the texts
            write_statistics=[*counts, "time"],
            write_batch_size=_WRITTEN_ROWS,
            # the schema with its metadata is stored at the end
            store_schema=False,
        )
        self._stack.push(self._finish)
        self._thread = self._stack.enter_context(ThreadPoolExecutor(1))
        self._writing: Future[None] | None = None
        return self

    def write(self, batch: "pa.RecordBatch | pa.Table | pd.DataFrame") -> None:
        """Append rows; columns are matched by name, and missing ones become null."""
        if not isinstance(batch, pa.RecordBatch | pa.Table):
            batch = pa.Table.from_pandas(batch, preserve_index=False)
        rows = conform(batch, self._table, self._schema)
        self.rows += rows.num_rows
        self._buffer.append(rows)
        self._buffer_bytes += rows.nbytes
        if self._buffer_bytes >= _GROUP_BYTES * min(1 + self.rows // _MORE_ROWS, 4):
            self._flush()

    def close(self) -> None:
        """Finish the file; leaving the block then has no further effect."""
        self.__exit__(None, None, None)

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        with self._stack:
            if error is not None:
                raise error
            self._flush()
            self._wait()

    def _flush(self) -> None:
        """Write the buffered rows in a thread, so that the caller continues with the next ones."""
        self._wait()
        if self._buffer:
            rows = pa.concat_tables(self._buffer).unify_dictionaries()
            self._writing = self._thread.submit(self._writer.write_table, rows)
        self._buffer, self._buffer_bytes = [], 0

    def _wait(self) -> None:
        if self._writing is not None:
            self._writing.result()

    def _finish(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            with self._writer:
                if kind is None:
                    self._writer.add_key_value_metadata(self._stored_metadata())
        finally:
            del self._writer  # it holds the metadata, 20 MB for 100,000 logs

    def _stored_metadata(self) -> dict[bytes, bytes]:
        schema = arrow_schema(self._table, self.provenance, self.facts)
        # as pyarrow itself stores a schema that it knows from the start
        return {b"ARROW:schema": base64.b64encode(schema.serialize()), **schema.metadata}


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
    return pa.schema(
        fields, metadata={_METADATA_KEY: json.dumps(document, ensure_ascii=False).encode()}
    )


def bare_schema(table: Table) -> pa.Schema:
    """Return the Arrow schema of a table without metadata.

    Required columns are declared as not nullable, which halves the time to read and write them.
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
    """Write a table; parameters as of :class:`TableWriter`."""
    with TableWriter(path, table, provenance, facts) as writer:
        writer.write(rows)


def read(path: Path, table: Table) -> "pd.DataFrame":
    """Read a table; labels become plain strings, and nullable columns may be absent.

    Raises
    ------
    TableError
        If the file is missing, is no Parquet file, or lacks a column.
    """
    with _opened(path, table) as file:
        present = _present(table, file.schema_arrow)
        frame = _conformed(file.read(columns=list(present.names)), present, path).to_pandas()
    for column in table.columns:
        if column.name not in frame:
            frame[column.name] = pa.nulls(len(frame), pa.float64()).to_pandas()
        if frame[column.name].dtype == "category":
            frame[column.name] = frame[column.name].astype(frame[column.name].cat.categories.dtype)
    return frame[list(table.names)]


def batches(path: Path, table: Table, rows: int = _BATCH_ROWS) -> Iterator[pa.RecordBatch]:
    """Yield the rows of a table in order and in batches; those of a folder file by file.

    Raises
    ------
    TableError
        As :func:`read`, and if a required column holds nulls or a type cannot be converted.
    """
    for part in sorted(path.glob("*.parquet")) if path.is_dir() else [path]:
        for groups in row_groups(part):
            with _opened(part, table, groups) as file:
                present = _present(table, file.schema_arrow).names
                # passing columns to other threads costs half as much as decoding them
                for batch in file.iter_batches(rows, columns=list(present), use_threads=False):
                    if not _conforms(batch, table):
                        batch = _conformed(batch, table, part).combine_chunks().to_batches()[0]
                    yield batch


def _conforms(batch: pa.RecordBatch, table: Table) -> bool:
    columns = ((one, batch.column(one.name)) for one in _present(table, batch.schema).columns)
    return all(v.type.equals(one.type) and (one.nullable or not v.null_count) for one, v in columns)


def _present(table: Table, schema: pa.Schema) -> Table:
    return replace(table, columns=tuple(c for c in table.columns if c.name in schema.names))


def _conformed(rows: pa.RecordBatch | pa.Table, table: Table, path: Path) -> pa.Table:
    try:
        return conform(rows, table, bare_schema(table))
    except TableError as error:
        raise TableError(f"{path}: {error}") from error


def facts(path: Path) -> dict[str, Any]:
    """Return the facts of a table; empty for a file that another program wrote."""
    return dict(metadata(path).get("facts", {}))


def metadata(path: Path) -> dict[str, Any]:
    """Return the provenance and facts of a table; empty for a file that another program wrote."""
    if not is_there(path):
        raise TableError(missing_text(path))
    if path.is_dir():
        path = next(iter(sorted(path.glob("*.parquet"))), path)
    try:
        groups = next(row_groups(path))
        metadata = (pq.read_schema(path) if groups is None else groups).metadata or {}
        return dict(json.loads(metadata.get(_METADATA_KEY, b"{}")))
    except (OSError, pa.ArrowInvalid, ValueError) as error:
        raise TableError(f"{path}: cannot be read as Parquet ({error})") from error


@contextmanager
def _opened(
    path: Path, table: Table, groups: pq.FileMetaData | None = None
) -> Iterator[pq.ParquetFile]:
    if not is_there(path):
        raise TableError(missing_text(path))
    try:
        # otherwise the bytes of a whole row group would be held beside its values
        file = pq.ParquetFile(path, metadata=groups, pre_buffer=False, buffer_size=_READ_BYTES)
    except (OSError, pa.ArrowInvalid) as error:
        raise TableError(f"{path}: cannot be read as Parquet ({error})") from error
    with file:
        missing = [name for name in table.required if name not in file.schema_arrow.names]
        if missing:
            lacking, expected = (", ".join(names) for names in (missing, table.required))
            raise TableError(f"{path}: columns {lacking} are missing, expected {expected}")
        yield file
