"""HDF5 files: the datasets of one group, streamed with h5py (optional extra ``hdf5``)."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.channel_names import POSITION, TIME, TORQUE
from frictioncli.logs.formats.compression import refuse_compressed
from frictioncli.logs.formats.containers import (
    ContainerLog,
    Rows,
    first_names,
    recognised_quantities,
    refuse_without_package,
    unreadable_on_error,
    with_unit,
)
from frictioncli.logs.log_source import CsvHints, Refusal

if TYPE_CHECKING:
    import h5py

_MAGIC = b"\x89HDF\r\n\x1a\n"
_USER_BLOCKS = (0, 512, 1024, 2048)
"""Possible offsets of the HDF5 content; MATLAB writes 512 bytes of its own before it. [byte]"""
_WHAT = "an HDF5 file"
_NUMBER_KINDS = "iufb"
_MAX_WIDTH = 64
"""Most numbers per row of one dataset."""
_MAX_CHUNK = 1 << 24
"""Largest chunk of a dataset, which is decompressed at once. [byte]"""
_MOST_OBJECTS, _DEEPEST = 50_000, 32
"""Most groups and datasets of a file, and most groups in one another."""
_EMPTY_BYTES, _LARGEST_RATIO = 1 << 26, 2048
"""A larger dataset must not be larger than what is stored of it by more than this factor, twice
what gzip can reach: a file of 2 kB can promise 1e13 rows that were never written. [byte, -]"""
_MATLAB_ATTRIBUTE = "MATLAB_class"
_MAX_UNIT = 40
"""Longest text that is taken as a unit. [characters]"""


@dataclass(frozen=True, slots=True)
class _DatasetColumn:
    """Location of a column's numbers in the file.

    Attributes
    ----------
    dataset : str
        Path of the dataset.
    length : int
        Number of rows.
    unit : str
        Unit in the dataset's attributes; "" where there is none.
    is_transposed : bool
        Whether rows run along the second axis, as MATLAB writes them.
    field : str
        Field of a compound type; "" where the dataset holds plain numbers.
    element : int
        Index in the row.
    width : int
        Numbers per row.
    """

    dataset: str
    length: int
    unit: str
    is_transposed: bool = False
    field: str = ""
    element: int = 0
    width: int = 1

    def name_in(self, group: str) -> str:
        """Return the column's name: its path from a group on, with dots."""
        path = self.dataset.removeprefix(group).strip("/").replace("/", ".")
        named = ".".join(part for part in (path, self.field) if part)
        return with_unit(named + (f"[{self.element}]" if self.width > 1 else ""), self.unit)


@dataclass(frozen=True, slots=True)
class _Table:
    """The columns of equal length in a group and its subgroups."""

    group: str
    leaves: tuple[_DatasetColumn, ...]

    @property
    def length(self) -> int:
        """Number of rows."""
        return self.leaves[0].length

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names."""
        return tuple(leaf.name_in(self.group) for leaf in self.leaves)


def read_hdf5(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open an HDF5 file (also MATLAB's since 7.3); None when it is another format.

    Of several groups, the one with a joint's time, position and torque is read. A file with
    several such groups is refused, as they are different recordings.

    Raises
    ------
    UnreadableLog
        If the file is damaged.
    """
    if not any(head.startswith(_MAGIC, begin) for begin in _USER_BLOCKS):
        return None
    compressed = refuse_compressed(path, _WHAT)
    if compressed is not None:
        return compressed
    try:
        import h5py
    except ImportError:
        return refuse_without_package(_WHAT, "hdf5")
    with unreadable_on_error(f"cannot be read as {_WHAT}"), h5py.File(path, "r") as file:
        tables = _tables(file)
        if isinstance(tables, Refusal):
            return tables
        table = _choose_table(tables)
        if isinstance(table, Refusal):
            return table
        names = sorted({leaf.dataset for leaf in table.leaves})
        refused = next(filter(None, (_unreadable(file[name]) for name in names)), None)
        if refused is not None:
            return refused
    used = set(table.leaves)
    others = sorted({leaf.dataset for t in tables for leaf in t.leaves if leaf not in used})
    form = f"{_WHAT}, group {table.group}" if table.group != "/" else _WHAT
    if others:
        form += f" (left out: {first_names(others)})"
    return ContainerLog(path, table.columns, form, partial(_rows, path, table.leaves))


def _tables(file: "h5py.File") -> list[_Table] | Refusal:
    """Return the columns of each group by their length, outer groups first."""
    import h5py

    groups = ["/"]
    leaves: list[_DatasetColumn] = []
    visited = 0

    def visit(name: str, item: Any) -> bool | None:
        nonlocal visited
        visited += 1
        if isinstance(item, h5py.Group):
            groups.append(f"/{name}")
        elif isinstance(item, h5py.Dataset):
            leaves.extend(_leaves(item))
        return True if visited > _MOST_OBJECTS or name.count("/") > _DEEPEST else None  # the end

    # follows hard links only, so that it never reaches another file
    if file.visititems(visit):
        return Refusal(
            "format_not_read",
            f"{_WHAT} of more than {_MOST_OBJECTS} groups and datasets, or {_DEEPEST} groups in one"
            " another; save one recording alone",
        )
    below: dict[str, dict[int, list[_DatasetColumn]]] = {group: {} for group in groups}
    for leaf in leaves:
        for group in _groups_above(leaf.dataset):
            below[group].setdefault(leaf.length, []).append(leaf)
    return [
        _Table(group, tuple(of_length[length]))
        for group, of_length in below.items()
        for length in sorted(of_length, reverse=True)
    ]


def _groups_above(path: str) -> list[str]:
    """Return the groups that a dataset or group lies in, outer ones first."""
    parts = path.strip("/").split("/")[:-1]
    return ["/", *("/" + "/".join(parts[:depth]) for depth in range(1, len(parts) + 1))]


def _leaves(dataset: "h5py.Dataset") -> Iterator[_DatasetColumn]:
    """Yield the columns of numbers in a dataset; other types have none."""
    if dataset.external or dataset.is_virtual or dataset.ndim not in (1, 2):
        return  # data in other files are not read
    name, unit = dataset.name, _unit(dataset)
    if dataset.dtype.names is not None:
        for field in dataset.dtype.names if dataset.ndim == 1 else ():
            kind = dataset.dtype[field]
            width = int(np.prod(kind.shape))
            if kind.base.kind in _NUMBER_KINDS and len(kind.shape) < 2 and width <= _MAX_WIDTH:
                for element in range(width):
                    yield _DatasetColumn(name, len(dataset), unit, False, field, element, width)
    elif dataset.dtype.kind in _NUMBER_KINDS:
        is_transposed = dataset.ndim == 2 and (
            _MATLAB_ATTRIBUTE in dataset.attrs or dataset.shape[0] == 1
        )
        length, width = (*dataset.shape, 1)[:2] if not is_transposed else dataset.shape[::-1]
        if width <= _MAX_WIDTH:
            for element in range(width):
                yield _DatasetColumn(
                    name, int(length), unit, is_transposed, "", element, int(width)
                )


def _unit(dataset: "h5py.Dataset") -> str:
    """Return the unit in a dataset's attributes; "" where there is none or it is no text."""
    for key in ("unit", "units"):
        kind = dataset.attrs.get_id(key).dtype if key in dataset.attrs else None
        if kind is None or kind.kind not in "SUO":
            continue
        value = dataset.attrs[key]
        text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
        if isinstance(text, str) and len(text) <= _MAX_UNIT:
            return text.strip()
    return ""


def _choose_table(tables: Sequence[_Table]) -> _Table | Refusal:
    """Return the table with a joint's time, position and torque.

    Without one, the table with the most columns is returned, as a mapping file may name them.
    """
    if not tables:
        return Refusal("not_a_log", f"{_WHAT} without columns of numbers")
    complete = [
        table
        for table in tables
        if {TIME, POSITION, TORQUE} <= recognised_quantities(table.columns)
    ]
    # the columns of a group are also columns of the groups that contain it
    known = {(table.group, table.length) for table in complete}
    outer = [
        table
        for table in complete
        if table.group == "/"
        or not any((group, table.length) in known for group in _groups_above(table.group))
    ]
    if len(outer) > 1:
        return Refusal(
            "several_recordings",
            f"{_WHAT} with several recordings, in groups"
            f" {first_names([table.group for table in outer])}; save each in a file of its own",
        )
    return outer[0] if outer else max(tables, key=lambda table: len(table.leaves))


def _unreadable(dataset: "h5py.Dataset") -> Refusal | None:
    """Return why the rows of a dataset cannot be read part by part, None where they can."""
    if math.prod(dataset.chunks or ()) * dataset.dtype.itemsize > _MAX_CHUNK:
        return Refusal(
            "format_not_read",
            f"{_WHAT} whose dataset {dataset.name} is stored in parts of more than"
            f" {_MAX_CHUNK >> 20} MiB; store it in smaller chunks: h5repack -l CHUNK=4096",
        )
    promised = math.prod(dataset.shape) * dataset.dtype.itemsize
    stored = dataset.id.get_storage_size()
    if promised > max(_EMPTY_BYTES, _LARGEST_RATIO * stored):
        return Refusal(
            "format_not_read",
            f"{_WHAT} whose dataset {dataset.name} declares {promised} bytes and stores {stored};"
            " save only the rows that were written",
        )
    return None


def _rows(
    path: Path, leaves: Sequence[_DatasetColumn], columns: Sequence[int], rows: int
) -> Iterator[Rows]:
    """Yield the values of the given columns; see :class:`ContainerLog`."""
    import h5py

    with h5py.File(path, "r", rdcc_nbytes=_MAX_CHUNK) as file:
        wanted = {column: leaves[column] for column in columns}
        datasets = {leaf.dataset: file[leaf.dataset] for leaf in wanted.values()}
        keys = {(leaf.dataset, leaf.field, leaf.is_transposed) for leaf in wanted.values()}
        for begin in range(0, leaves[0].length, rows):
            part = slice(begin, begin + rows)
            blocks = {key: _block(datasets[key[0]], part, key[1], key[2]) for key in keys}
            yield {
                column: blocks[leaf.dataset, leaf.field, leaf.is_transposed][:, leaf.element]
                for column, leaf in wanted.items()
            }


def _block(dataset: "h5py.Dataset", rows: slice, field: str, is_transposed: bool) -> Array:
    """Return a slice of rows of a dataset, shape (rows, width)."""
    values = dataset[:, rows].T if is_transposed else dataset[rows]
    if field:
        values = values[field]
    return np.asarray(values, np.float64).reshape(len(values), -1)
