"""HDF5 files: the datasets of one group, streamed with h5py (extra ``hdf5``)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.aliases import POSITION, TIME, TORQUE
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
"""Where the file proper may begin; MATLAB puts 512 bytes of its own before it."""
_WHAT = "an HDF5 file"
_NUMBERS = "iufb"
_WIDEST = 64
_CHUNK_BYTES = 1 << 24
"""The largest part of a dataset that is unpacked at once. [bytes]"""
_MATLAB = "MATLAB_class"
_LONGEST_UNIT = 40


@dataclass(frozen=True, slots=True)
class _Dataset:
    """Where a column's numbers are.

    Attributes
    ----------
    dataset : str
        Its path in the file.
    length : int
        Number of rows.
    unit : str
        By the dataset's attributes; "" where they tell none.
    by_columns : bool
        Rows run along the second axis, as MATLAB writes them.
    field : str
        Field of a table's rows; "" where the dataset holds plain numbers.
    element, width : int
        Place in the row, numbers per row.
    """

    dataset: str
    length: int
    unit: str
    by_columns: bool = False
    field: str = ""
    element: int = 0
    width: int = 1

    def name_in(self, group: str) -> str:
        """Return the column's name in a group: the path from there, with dots."""
        path = self.dataset.removeprefix(group).strip("/").replace("/", ".")
        named = ".".join(part for part in (path, self.field) if part)
        return with_unit(named + (f"[{self.element}]" if self.width > 1 else ""), self.unit)


@dataclass(frozen=True, slots=True)
class _Table:
    """Datasets of equal length in a group and below it."""

    group: str
    leaves: tuple[_Dataset, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of its columns."""
        return tuple(leaf.name_in(self.group) for leaf in self.leaves)


def read_hdf5(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open an HDF5 file (also MATLAB's since 7.3); None when it is another format.

    Of several groups, the one that holds a joint's time, position and torque is read; where
    several do, the file is refused, as they are different recordings.

    Raises
    ------
    UnreadableLog
        If it is damaged.
    """
    if not any(head.startswith(_MAGIC, begin) for begin in _USER_BLOCKS):
        return None
    packed = refuse_compressed(path, _WHAT)
    if packed is not None:
        return packed
    try:
        import h5py
    except ImportError:
        return refuse_without_package(_WHAT, "hdf5")
    with unreadable_on_error(f"cannot be read as {_WHAT}"), h5py.File(path, "r") as file:
        tables = _tables(file)
        table = _chosen(tables)
        if isinstance(table, Refusal):
            return table
        names = {leaf.dataset for leaf in table.leaves}
        large = sorted(name for name in names if _chunk_bytes(file[name]) > _CHUNK_BYTES)
        if large:
            return Refusal(
                "format_not_read",
                f"{_WHAT} whose dataset {large[0]} is stored in parts of more than"
                f" {_CHUNK_BYTES >> 20} MiB; store it in smaller chunks: h5repack -l CHUNK=4096",
            )
    others = sorted({leaf.dataset for t in tables for leaf in t.leaves if leaf not in table.leaves})
    form = f"{_WHAT}, group {table.group}" if table.group != "/" else _WHAT
    if others:
        form += f" (left out: {first_names(others)})"
    return ContainerLog(path, table.columns, form, partial(_rows, path, table.leaves))


def _tables(file: "h5py.File") -> list[_Table]:
    """Return each group's datasets by their length, outer groups first."""
    import h5py

    groups = ["/"]
    leaves: list[_Dataset] = []

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Group):
            groups.append(f"/{name}")
        elif isinstance(item, h5py.Dataset):
            leaves.extend(_leaves(item))

    # goes along hard links only, so never into another file
    file.visititems(visit)
    tables = []
    for group in groups:
        below = [leaf for leaf in leaves if leaf.dataset.startswith(f"{group.rstrip('/')}/")]
        for length in sorted({leaf.length for leaf in below}, reverse=True):
            tables.append(_Table(group, tuple(leaf for leaf in below if leaf.length == length)))
    return tables


def _leaves(dataset: "h5py.Dataset") -> Iterator[_Dataset]:
    """Yield the columns of numbers in a dataset; texts, references and objects have none."""
    if dataset.external or dataset.is_virtual or dataset.ndim not in (1, 2):
        return  # what lies in other files is not read
    name, unit = dataset.name, _unit(dataset)
    if dataset.dtype.names is not None:
        for field in dataset.dtype.names if dataset.ndim == 1 else ():
            kind = dataset.dtype[field]
            width = int(np.prod(kind.shape))
            if kind.base.kind in _NUMBERS and len(kind.shape) < 2 and width <= _WIDEST:
                for element in range(width):
                    yield _Dataset(name, len(dataset), unit, False, field, element, width)
    elif dataset.dtype.kind in _NUMBERS:
        turned = dataset.ndim == 2 and (_MATLAB in dataset.attrs or dataset.shape[0] == 1)
        length, width = (*dataset.shape, 1)[:2] if not turned else dataset.shape[::-1]
        if width <= _WIDEST:
            for element in range(width):
                yield _Dataset(name, int(length), unit, turned, "", element, int(width))


def _unit(dataset: "h5py.Dataset") -> str:
    """Return the unit in a dataset's attributes; "" where it is none or no text."""
    for key in ("unit", "units"):
        kind = dataset.attrs.get_id(key).dtype if key in dataset.attrs else None
        if kind is None or kind.kind not in "SUO":
            continue
        value = dataset.attrs[key]
        text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
        if isinstance(text, str) and len(text) <= _LONGEST_UNIT:
            return text.strip()
    return ""


def _chosen(tables: Sequence[_Table]) -> _Table | Refusal:
    """Return the one table that holds a joint's motion, else the widest: a map may name it."""
    if not tables:
        return Refusal("not_a_log", f"{_WHAT} without columns of numbers")
    moving = [
        table
        for table in tables
        if {TIME, POSITION, TORQUE} <= recognised_quantities(table.columns)
    ]
    # a table in a group is also one in the groups around it
    outer = [
        table
        for index, table in enumerate(moving)
        if not any(set(table.leaves) <= set(before.leaves) for before in moving[:index])
    ]
    if len(outer) > 1:
        return Refusal(
            "several_recordings",
            f"{_WHAT} with several recordings, in groups"
            f" {first_names([table.group for table in outer])}; save each in a file of its own",
        )
    return outer[0] if outer else max(tables, key=lambda table: len(table.leaves))


def _chunk_bytes(dataset: "h5py.Dataset") -> int:
    """Return how many bytes of a dataset are unpacked at once."""
    return int(np.prod(dataset.chunks or ())) * dataset.dtype.itemsize


def _rows(
    path: Path, leaves: Sequence[_Dataset], columns: Sequence[int], rows: int
) -> Iterator[Rows]:
    """Yield the values of the asked columns; see :class:`ContainerLog`."""
    import h5py

    with h5py.File(path, "r", rdcc_nbytes=_CHUNK_BYTES) as file:
        asked = {column: leaves[column] for column in columns}
        datasets = {leaf.dataset: file[leaf.dataset] for leaf in asked.values()}
        for begin in range(0, leaves[0].length, rows):
            part = slice(begin, begin + rows)
            blocks = {
                key: _block(datasets[key[0]], part, key[1], key[2])
                for key in {(leaf.dataset, leaf.field, leaf.by_columns) for leaf in asked.values()}
            }
            yield {
                column: blocks[leaf.dataset, leaf.field, leaf.by_columns][:, leaf.element]
                for column, leaf in asked.items()
            }


def _block(dataset: "h5py.Dataset", rows: slice, field: str, by_columns: bool) -> Array:
    """Return some rows of a dataset, shape (rows, numbers per row)."""
    values = dataset[:, rows].T if by_columns else dataset[rows]
    if field:
        values = values[field]
    return np.asarray(values, np.float64).reshape(len(values), -1)
