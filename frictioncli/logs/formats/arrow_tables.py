"""Parquet, Feather and Arrow files: columns of numbers, times and lists, streamed with pyarrow."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from frictioncli.arrays import Array
from frictioncli.logs.formats.arrow_batches import batches_of, column
from frictioncli.logs.formats.compression import refuse_compressed
from frictioncli.logs.formats.containers import (
    ContainerLog,
    Rows,
    first_names,
    unreadable_on_error,
    with_unit,
)
from frictioncli.logs.formats.episodes import EPISODE, TIME, EpisodeClock
from frictioncli.logs.log_source import CsvHints, Refusal, UnreadableLog
from frictioncli.parquet_footer import LargeFooter, large_footer

_PARQUET = b"PAR1"
_ARROW = b"ARROW1\0\0"
_FEATHER_1 = b"FEA1"
_OWN_METADATA = b"frictioncli"
"""Metadata key of the tables that this package writes."""
_BUFFER_BYTES = 1 << 20
_FULLY_BUFFERED = 32
_LEAST_BUFFER = 1 << 14
"""Columns beyond this number share their buffers, none has less. [byte]"""

_LARGEST_GROUP = 1 << 24
"""Longest description of one row group, of 150,000 columns. [byte]"""

_INSPECTED_ROWS = 512
_INSPECTED_FIELDS = 64
_MAX_LIST = 64
_UNIT_KEYS = (b"unit", b"units")
_NUMBER = r"^\s*[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?\s*$"
_PER_SECOND = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}

_Batches = Callable[[Path, Sequence[str], int], Iterator[pa.RecordBatch]]
"""Takes a file, field names and the number of rows to hold at a time; yields the fields."""


@dataclass(frozen=True, slots=True)
class _Leaf:
    """Location of a column's numbers in a table with nested fields.

    Attributes
    ----------
    path : tuple of str
        The field and the struct fields below it.
    element : int
        Index in a list.
    length : int
        Length of the list; 0 where there is none.
    """

    path: tuple[str, ...]
    element: int = 0
    length: int = 0

    @property
    def name(self) -> str:
        """The column's name: the path with dots, the index in the list in brackets."""
        return ".".join(self.path) + (f"[{self.element}]" if self.length else "")


def read_arrow(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open a Parquet or Feather (Arrow IPC) file; None when it is another format.

    Raises
    ------
    UnreadableLog
        If the file is damaged.
    """
    if head.startswith(_FEATHER_1):
        return Refusal("format_not_read", "Feather table of version 1; save it as version 2")
    batches: _Batches
    if head.startswith(_PARQUET):
        what, batches = "a Parquet table", _parquet_batches
    elif head.startswith(_ARROW):
        what, batches = "an Arrow table", batches_of
    else:
        return None
    compressed = refuse_compressed(path, what)
    if compressed is not None:
        return compressed
    with unreadable_on_error(f"cannot be read as {what}"):
        footer = _large_footer(path) if batches is _parquet_batches else None
        if footer is not None:
            batches = partial(_footer_batches, footer)
        metadata = next(footer.parts()) if footer is not None else None
        schema = _schema(path, metadata)
        if _OWN_METADATA in (schema.metadata or {}):
            return Refusal(
                "not_a_log",
                "a table written by frictioncli, not a log; name the original logs, or continue"
                " with -w and its folder",
            )
        fields = list(dict.fromkeys(schema.names))
        leaves: list[_Leaf] = []
        texts: list[str] = []
        for some, first in _first_rows(path, fields, metadata):
            if first is None or not first.num_rows:
                return Refusal("too_few_rows", f"{what} without rows; expected rows of numbers")
            leaves += [leaf for name in some for leaf in _leaves(column(first, name), (name,))]
            texts += [name for name in some if _holds_numbers_as_text(column(first, name))]
    if texts:
        return Refusal(
            "not_a_number",
            f"{what} whose columns {first_names(texts)} hold numbers as text; save them as numbers",
        )
    known = {field.name: field for field in reversed(schema)}  # the first of several of a name
    columns = tuple(with_unit(leaf.name, _unit(known[leaf.path[0]], leaf)) for leaf in leaves)
    return ContainerLog(path, columns, what, partial(_rows, path, batches, tuple(leaves)))


def _large_footer(path: Path) -> LargeFooter | None:
    footer = large_footer(path)
    if footer is not None and footer.longest > _LARGEST_GROUP:
        raise UnreadableLog(
            "a Parquet table with a row group of more than about 150,000 columns; save those of the"
            " joint alone"
        )
    return footer


def _schema(path: Path, metadata: pq.FileMetaData | None) -> pa.Schema:
    if metadata is not None:
        return metadata.schema.to_arrow_schema()
    if _is_parquet(path):
        return pq.read_schema(path)
    with pa.OSFile(str(path)) as source:
        return pa.ipc.open_file(source).schema


def _is_parquet(path: Path) -> bool:
    with path.open("rb") as stream:
        return stream.read(len(_PARQUET)) == _PARQUET


def _first_rows(
    path: Path, fields: Sequence[str], metadata: pq.FileMetaData | None
) -> Iterator[tuple[Sequence[str], pa.RecordBatch | None]]:
    """Yield a few fields after the other with their first rows: each holds a page and a buffer."""
    if not _is_parquet(path):
        yield fields, next(batches_of(path, fields, _INSPECTED_ROWS), None)
        return
    # opened once: that takes a time proportional to the number of all columns
    with _opened(path, _INSPECTED_FIELDS, metadata) as file:
        for begin in range(0, max(len(fields), 1), _INSPECTED_FIELDS):
            some = fields[begin : begin + _INSPECTED_FIELDS]
            yield some, next(_some_batches(file, some, _INSPECTED_ROWS), None)


def _opened(path: Path, fields: int, metadata: pq.FileMetaData | None = None) -> pq.ParquetFile:
    buffer = max(_BUFFER_BYTES // max(fields // _FULLY_BUFFERED, 1), _LEAST_BUFFER)
    # pre_buffer would hold the bytes of a whole row group in addition to its values
    return pq.ParquetFile(path, metadata=metadata, pre_buffer=False, buffer_size=buffer)


def _some_batches(
    file: pq.ParquetFile, fields: Sequence[str], rows: int
) -> Iterator[pa.RecordBatch]:
    left = sum(file.metadata.row_group(i).num_rows for i in range(file.num_row_groups))
    for batch in file.iter_batches(batch_size=rows, columns=list(fields), use_threads=False):
        left -= batch.num_rows
        yield batch
    if left:  # pyarrow takes the end of the file for that of a column
        raise ValueError(f"its last {left} rows are missing")


def _parquet_batches(
    path: Path, fields: Sequence[str], rows: int, metadata: pq.FileMetaData | None = None
) -> Iterator[pa.RecordBatch]:
    with _opened(path, len(fields), metadata) as file:
        yield from _some_batches(file, fields, rows)


def _footer_batches(
    footer: LargeFooter, path: Path, fields: Sequence[str], rows: int
) -> Iterator[pa.RecordBatch]:
    for part in footer.parts():
        yield from _parquet_batches(path, fields, rows, part)


def _leaves(array: pa.Array, path: tuple[str, ...]) -> Iterator[_Leaf]:
    """Yield the columns of numbers in a field; other types have none."""
    kind = array.type
    if pa.types.is_struct(kind):
        for field in kind:
            yield from _leaves(pc.struct_field(array, [field.name]), (*path, field.name))
    elif _is_list(kind) and _is_number(kind.value_type):
        # a row whose list has another length has no values
        lengths = pc.mode(pc.list_value_length(array)).to_pylist()
        usual = lengths[0] if lengths else {"mode": 0, "count": 0}
        if usual["mode"] <= _MAX_LIST and usual["count"] > len(array) / 2:
            yield from (_Leaf(path, element, usual["mode"]) for element in range(usual["mode"]))
    elif _is_number(kind):
        yield _Leaf(path)


def _is_list(kind: pa.DataType) -> bool:
    types = pa.types
    return types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)


def _is_number(kind: pa.DataType) -> bool:
    if pa.types.is_dictionary(kind):
        kind = kind.value_type
    checks = (
        pa.types.is_integer,
        pa.types.is_floating,
        pa.types.is_decimal,
        pa.types.is_boolean,
        _is_time,
    )
    return any(check(kind) for check in checks)


def _is_time(kind: pa.DataType) -> bool:
    return pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind)


def _holds_numbers_as_text(array: pa.Array) -> bool:
    """Return whether all texts of a column are numbers, and not all the same one."""
    kind = array.type.value_type if pa.types.is_dictionary(array.type) else array.type
    if not (pa.types.is_string(kind) or pa.types.is_large_string(kind)):
        return False
    cells = pc.drop_null(pc.cast(array, pa.string()))
    return len(pc.unique(cells)) > 1 and pc.all(pc.match_substring_regex(cells, _NUMBER)).as_py()


def _unit(field: pa.Field, leaf: _Leaf) -> str:
    """Return the unit in a field's metadata; "s" for times, which are converted to seconds."""
    for name in leaf.path[1:]:
        field = field.type.field(name)
    if _is_time(field.type):
        return "s"
    metadata = field.metadata or {}
    return next(
        (metadata[key].decode("utf-8", "replace") for key in _UNIT_KEYS if key in metadata), ""
    )


def _rows(
    path: Path, batches: _Batches, leaves: Sequence[_Leaf], columns: Sequence[int], rows: int
) -> Iterator[Rows]:
    """Yield the values of the given columns; see :class:`ContainerLog`."""
    fields = list(dict.fromkeys(leaves[column].path[0] for column in columns))
    names = [leaf.name for leaf in leaves]
    has_episodes = {EPISODE, TIME} <= set(names) and names.index(TIME) in columns
    fields += [EPISODE] * (has_episodes and EPISODE not in fields)
    clock = EpisodeClock()
    for batch in batches(path, fields, rows):
        values = {column: _values(batch, leaves[column]) for column in columns}
        if has_episodes:
            time, episode = names.index(TIME), _values(batch, leaves[names.index(EPISODE)])
            values[time] = clock.continued(values[time], episode)
        yield values


def _values(batch: pa.RecordBatch, leaf: _Leaf) -> Array:
    array = column(batch, leaf.path[0])
    if len(leaf.path) > 1:
        array = pc.struct_field(array, list(leaf.path[1:]))
    if not leaf.length:
        return _numbers(array)
    lengths = np.asarray(pc.fill_null(pc.list_value_length(array), 0).to_numpy())
    has_length = lengths == leaf.length
    values = np.full(len(array), np.nan)
    begin = np.cumsum(lengths) - lengths
    values[has_length] = _numbers(array.flatten())[begin[has_length] + leaf.element]
    return values


def _numbers(array: pa.Array) -> Array:
    """Return an array as numbers, NaN where a value is null; times in seconds."""
    if pa.types.is_dictionary(array.type):
        array = array.dictionary_decode()
    if _is_time(array.type):
        per_second = _PER_SECOND[array.type.unit]
        counts = pc.fill_null(array.view(f"int{array.type.bit_width}"), 0).to_numpy()
        # nanoseconds since 1970 have more digits than a float: whole seconds are converted apart
        rest = np.fmod(counts, per_second)
        seconds = (counts - rest) // per_second + rest / per_second
        return np.where(array.is_null().to_numpy(zero_copy_only=False), np.nan, seconds)
    if pa.types.is_boolean(array.type):
        array = array.cast(pa.uint8())
    numbers = pc.fill_null(array.cast(pa.float64(), safe=False), np.nan)
    # a copy, as the memory of the file is released after reading
    return np.array(numbers.to_numpy(zero_copy_only=False), np.float64)
