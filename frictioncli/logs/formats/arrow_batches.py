"""Batches of an Arrow file, read and not mapped, whatever their size.

The system ends a process that touches what another one has cut off a mapped file.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pyarrow as pa

from frictioncli.logs.formats.arrow_blocks import StoredBatch, blocks_of, refuse_above
from frictioncli.logs.formats.arrow_slices import StoredColumn, columns_of, slices

_WHOLE_BYTES = 1 << 26
"""Columns of a batch that are together larger are read a few rows at a time. [byte]"""


def batches_of(path: Path, fields: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
    """Yield fields of an Arrow file, a few rows at a time.

    Parameters
    ----------
    path : Path
        The file.
    fields : sequence of str
        Names of the fields; of several of a name the first is meant.
    rows : int
        Rows to hold at a time.

    Raises
    ------
    UnreadableLog
        If a batch has to be loaded whole and is too large for that.
    ValueError, pyarrow.ArrowException
        If the file is damaged, or is cut while it is read.
    """
    with path.open("rb") as stream, pa.OSFile(str(path)) as source:
        blocks, files = blocks_of(stream), {}
        schema = pa.ipc.open_file(source).schema
        for number in range(len(blocks.batches)):
            block = blocks.checked(number)
            if block is None:
                raise ValueError("a batch without rows")
            sliced = _read_in_slices(block, schema, fields, blocks.is_big_endian)
            whole = tuple(name for name in fields if name not in sliced)
            if whole not in files:
                places = [schema.get_all_field_indices(name)[0] for name in whole]
                options = pa.ipc.IpcReadOptions(included_fields=places)
                files[whole] = pa.ipc.open_file(source, options=options)
            if not sliced:
                batch = files[whole].get_batch(number)
                yield from (batch.slice(first, rows) for first in range(0, batch.num_rows, rows))
                continue
            columns: dict[str, StoredColumn | pa.Array] = dict(sliced)
            if whole:
                batch = files[whole].get_batch(number)
                columns |= {name: column(batch, name) for name in whole}
            yield from slices(stream, columns, block.rows, rows)


def column(batch: pa.RecordBatch, name: str) -> pa.Array:
    """Return a column by its name; the first where several have the same name."""
    return batch.column(batch.schema.get_all_field_indices(name)[0])


def _read_in_slices(
    block: StoredBatch, schema: pa.Schema, fields: Sequence[str], is_big_endian: bool
) -> dict[str, StoredColumn]:
    """Return the columns that are not loaded whole: where all are large, those that allow it."""
    if block.is_packed:
        return {}
    known = None if is_big_endian else columns_of(block, schema)
    if known is None:
        refuse_above(block.length, "is of")
        return {}
    wanted = {name: known[schema.get_all_field_indices(name)[0]] for name in fields}
    if sum(column.length for column in wanted.values()) <= _WHOLE_BYTES:
        return {}
    sliced = {name: column for name, column in wanted.items() if column.has_rows}
    left = sum(column.length for name, column in wanted.items() if name not in sliced)
    refuse_above(left, "has columns of another kind than numbers of")
    return sliced
