"""Rows of a batch of an Arrow file that is too large to load whole.

pyarrow loads whole columns of a batch, which may be as long as the file. Of most columns any rows
can be read on their own: each has a buffer with one bit per row that tells which are there, and a
buffer of values or, of texts and lists, of their ends.
Format: https://arrow.apache.org/docs/format/Columnar.html.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Numbers
from frictioncli.logs.formats.arrow_blocks import StoredBatch, read_bytes

_BITS = 8
_BEGINS = {"large_": np.dtype("<i8")}
"""Numbers that tell where the values of a row begin, by the beginning of the type's name."""


@dataclass(frozen=True, slots=True)
class StoredColumn:
    """A column of a batch, or a part of a nested one.

    Attributes
    ----------
    kind : pyarrow.DataType
        Type of its values.
    buffers : tuple of (int, int)
        Location in the file and length of each buffer. [byte]
    parts : tuple of StoredColumn
        What a list or a structure is made of.
    """

    kind: pa.DataType
    buffers: tuple[tuple[int, int], ...]
    parts: tuple["StoredColumn", ...] = ()

    @property
    def length(self) -> int:
        """Length of all buffers, in bytes."""
        own = sum(length for _, length in self.buffers)
        return own + sum(part.length for part in self.parts)

    @property
    def has_rows(self) -> bool:
        """Whether any rows can be read."""
        if _has_begins(self.kind):
            return all(_is_plain(part.kind) for part in self.parts)
        if _is_group(self.kind):
            return all(part.has_rows and not _has_begins(part.kind) for part in self.parts)
        return _is_plain(self.kind)

    def rows(self, stream: BinaryIO, begin: int, end: int) -> pa.Array:
        """Return rows; of structures and lists of one length from a multiple of eight on.

        Raises
        ------
        ValueError
            If the file is damaged, or ends before.
        """
        first = begin // _BITS * _BITS  # rows whose bits are in one byte are read together
        there, *others = self.buffers
        buffers = [_bits(stream, there, first, end) if there[1] else None]
        parts: list[pa.Array] = []
        if _is_group(self.kind):
            size = self.kind.list_size if pa.types.is_fixed_size_list(self.kind) else 1
            parts = [part.rows(stream, first * size, end * size) for part in self.parts]
        elif _has_begins(self.kind):
            begins = self._begins(stream, first, end)
            low, high = int(begins[0]), int(begins[-1])
            buffers.append(pa.py_buffer(begins - low))
            parts = [part.rows(stream, low, high) for part in self.parts]
            buffers += [_part(stream, texts, low, high) for texts in others[1:]]
        elif pa.types.is_boolean(self.kind):
            buffers.append(_bits(stream, others[0], first, end))
        else:
            width = self.kind.bit_width // _BITS
            buffers.append(_part(stream, others[0], first * width, end * width))
        whole = pa.Array.from_buffers(self.kind, end - first, buffers, children=parts)
        return whole.slice(begin - first)

    def _begins(self, stream: BinaryIO, first: int, end: int) -> Numbers:
        kind = next((k for name, k in _BEGINS.items() if str(self.kind).startswith(name)), None)
        number = kind or np.dtype("<i4")
        content = _part(
            stream, self.buffers[1], first * number.itemsize, (end + 1) * number.itemsize
        )
        begins: Numbers = np.frombuffer(content, number)
        if begins[0] < 0 or (np.diff(begins) < 0).any():
            raise ValueError("the ends of a column's texts or lists are damaged")
        return begins


def columns_of(block: StoredBatch, schema: pa.Schema) -> list[StoredColumn] | None:
    """Return the columns of a batch; None where a type is of an unknown number of buffers.

    Parameters
    ----------
    block : StoredBatch
        The batch.
    schema : pyarrow.Schema
        Its fields.
    """
    left = iter(block.buffers)
    columns = [_column(field.type, left) for field in schema]
    known = [column for column in columns if column is not None]
    return known if len(known) == len(columns) and next(left, None) is None else None


def slices(
    stream: BinaryIO, columns: Mapping[str, StoredColumn | pa.Array], count: int, rows: int
) -> Iterator[pa.RecordBatch]:
    """Yield the rows of columns, a few at a time.

    Parameters
    ----------
    stream : file
        The file.
    columns : mapping of str to StoredColumn or pyarrow.Array
        Those to read by their names, or the whole of them.
    count : int
        Rows of the batch.
    rows : int
        Rows to hold at a time.
    """
    step = max(rows // _BITS, 1) * _BITS
    for begin in range(0, count, step):
        end = min(begin + step, count)
        yield pa.RecordBatch.from_arrays(
            [
                column.rows(stream, begin, end)
                if isinstance(column, StoredColumn)
                else column.slice(begin, end - begin)
                for column in columns.values()
            ],
            names=list(columns),
        )


def _column(kind: pa.DataType, left: Iterator[tuple[int, int]]) -> StoredColumn | None:
    """Take the buffers of a column; None where it is of a type whose number of them varies."""
    types = pa.types
    if isinstance(kind, pa.BaseExtensionType):
        return None
    if types.is_null(kind):
        return StoredColumn(kind, ())
    inner: list[pa.DataType] = []
    if _is_group(kind):
        number, inner = 1, [kind.field(index).type for index in range(kind.num_fields)]
    elif types.is_list(kind) or types.is_large_list(kind):
        number, inner = 2, [kind.value_type]
    elif _has_begins(kind):
        number = 3
    elif types.is_dictionary(kind) or _is_plain(kind):
        number = 2
    else:
        return None
    buffers = tuple(next(left, (0, 0)) for _ in range(number))
    parts = [_column(part, left) for part in inner]
    known = tuple(part for part in parts if part is not None)
    return StoredColumn(kind, buffers, known) if len(known) == len(parts) else None


def _is_plain(kind: pa.DataType) -> bool:
    """Return whether the value of a row is as long as that of any other."""
    types = pa.types
    return bool(
        types.is_primitive(kind) or types.is_decimal(kind) or types.is_fixed_size_binary(kind)
    )


def _is_group(kind: pa.DataType) -> bool:
    """Return whether a row has as many values of its parts as any other."""
    return bool(pa.types.is_struct(kind) or pa.types.is_fixed_size_list(kind))


def _has_begins(kind: pa.DataType) -> bool:
    """Return whether a buffer tells where the values of each row begin."""
    types = pa.types
    checks = (
        *(types.is_list, types.is_large_list, types.is_string, types.is_large_string),
        *(types.is_binary, types.is_large_binary),
    )
    return any(check(kind) for check in checks)


def _bits(stream: BinaryIO, buffer: tuple[int, int], begin: int, end: int) -> pa.Buffer:
    return _part(stream, buffer, begin // _BITS, -(-end // _BITS))


def _part(stream: BinaryIO, buffer: tuple[int, int], begin: int, end: int) -> pa.Buffer:
    """Return bytes of a buffer."""
    place, length = buffer
    if end > length:
        raise ValueError("a column is shorter than the table")
    return pa.py_buffer(read_bytes(stream, place + begin, end - begin))
