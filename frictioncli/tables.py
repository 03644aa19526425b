"""Parquet tables of the work folder: checked against their schema, with units and provenance.

Every file carries, per column, ``unit`` and ``description``, and in its own metadata under
``frictioncli`` a JSON object with the provenance and the *facts* that later stages need and that
are no column: ``torque_unit``, ``torque_side``, notes.
"""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from frictioncli.errors import TableError
from frictioncli.files import whole
from frictioncli.provenance import Provenance
from frictioncli.quantities import TORQUE
from frictioncli.schemas import Table

_KEY = b"frictioncli"
_BATCH_ROWS = 1 << 17


class TableWriter:
    """Write a table batch by batch; the file takes its place when the block ends without error.

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
    """

    def __init__(
        self,
        path: Path,
        table: Table,
        provenance: Provenance,
        facts: Mapping[str, Any] | None = None,
    ) -> None:
        self._table = table
        self._schema = arrow_schema(table, provenance, facts or {})
        self._whole = whole(path)
        self.rows = 0

    def __enter__(self) -> Self:
        self._draft = self._whole.__enter__()
        self._writer = pq.ParquetWriter(
            self._draft,
            self._schema,
            compression="zstd",
            compression_level=1,
            use_dictionary=[f.name for f in self._schema if pa.types.is_dictionary(f.type)],
        )
        return self

    def write(self, batch: pa.RecordBatch | pa.Table | pd.DataFrame) -> None:
        """Append rows; columns are matched by name and those that are missing become null."""
        if isinstance(batch, pd.DataFrame):
            batch = pa.Table.from_pandas(batch, preserve_index=False)
        rows = conform(batch, self._table, self._schema)
        self._writer.write_table(rows)
        self.rows += rows.num_rows

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._writer.close()
        self._whole.__exit__(kind, error, trace)


def arrow_schema(table: Table, provenance: Provenance, facts: Mapping[str, Any]) -> pa.Schema:
    """Return the Arrow schema of a table with units, provenance and facts in its metadata."""
    torque_unit = facts.get("torque_unit", "N·m")
    fields = [
        pa.field(
            column.name,
            column.type,
            nullable=True,
            metadata={
                "unit": torque_unit if column.unit == TORQUE else column.unit,
                "description": column.description,
            },
        )
        for column in table.columns
    ]
    document = provenance.as_dict() | {"table": table.name, "row": table.row, "facts": dict(facts)}
    return pa.schema(fields, metadata={_KEY: json.dumps(document, ensure_ascii=False).encode()})


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
    rows: pd.DataFrame | pa.Table,
    table: Table,
    provenance: Provenance,
    facts: Mapping[str, Any] | None = None,
) -> None:
    """Write a whole table."""
    with TableWriter(path, table, provenance, facts) as writer:
        writer.write(rows)


def read(path: Path, table: Table) -> pd.DataFrame:
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
        if isinstance(frame[column.name].dtype, pd.CategoricalDtype):
            frame[column.name] = frame[column.name].astype(frame[column.name].cat.categories.dtype)
    return frame[list(table.names)]


def batches(path: Path, table: Table, rows: int = _BATCH_ROWS) -> Iterator[pa.RecordBatch]:
    """Yield a table's rows in order, a bounded number at a time.

    Raises
    ------
    TableError
        As :func:`read`.
    """
    for part in sorted(path.glob("*.parquet")) if path.is_dir() else [path]:
        with _opened(part, table) as file:
            present = [name for name in table.names if name in file.schema_arrow.names]
            yield from file.iter_batches(batch_size=rows, columns=present)


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
        # pre_buffer would hold a whole row group's bytes beside its values
        file = pq.ParquetFile(path, pre_buffer=False)
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
