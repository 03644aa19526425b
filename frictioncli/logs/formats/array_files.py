"""Arrays of numbers saved by NumPy (``.npy``, ``.npz``) and by MATLAB before 7.3 (``.mat``)."""

import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictioncli.logs.formats.containers import (
    ContainerLog,
    Rows,
    first_names,
    unreadable_on_error,
)
from frictioncli.logs.formats.matlab_check import check_matlab
from frictioncli.logs.log_source import CsvHints, Refusal, UnreadableLog

_NPY = b"\x93NUMPY"
_ZIP = b"PK\x03\x04"
_MAT = b"MATLAB 5.0 MAT-file"
_NUMBER_KINDS = "iufb"
_MAX_WIDTH = 64
"""Most columns of one array."""
_MOST_BYTES = 1 << 30
"""Most that a packed file may unpack to: all of it is loaded at once. [byte]"""


def read_array_file(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open a file of arrays; None when it is another format.

    Arrays of one length are columns, matrices several ones. Names in structures are joined by dots.

    Raises
    ------
    UnreadableLog
        If the file is damaged.
    """
    if head.startswith(_NPY):
        what = "a NumPy array"
    elif head.startswith(_ZIP) and _holds_arrays(path):
        what = "NumPy arrays"
    elif head.startswith(_MAT):
        what = "MATLAB arrays"
    else:
        return None
    with unreadable_on_error(f"cannot be read as {what}"):
        _check(path, head)
        arrays = _arrays(path)
    lengths = Counter(len(values) for values in arrays.values() if len(values) > 1)
    if not lengths:
        return Refusal("not_a_log", f"{what} without columns of numbers")
    rows = max(lengths, key=lambda length: (lengths[length], length))
    columns = tuple(name for name, values in arrays.items() if len(values) == rows)
    others = [name for name in arrays if name not in columns]
    form = what + (f" (left out: {first_names(others)})" if others else "")
    return ContainerLog(path, columns, form, partial(_rows, path, columns))


def _holds_arrays(path: Path) -> bool:
    """Return whether a zip archive is one of NumPy arrays."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (OSError, zipfile.BadZipFile):
        return False
    return bool(names) and all(name.endswith(".npy") for name in names)


def _check(path: Path, head: bytes) -> None:
    """Raise if a file unpacks to too much, or has too many arrays in one another."""
    if head.startswith(_MAT):
        check_matlab(path, _MOST_BYTES)
    elif head.startswith(_ZIP):
        with zipfile.ZipFile(path) as archive:
            length = sum(part.file_size for part in archive.infolist())
        if length > _MOST_BYTES:
            raise UnreadableLog(
                f"NumPy arrays that unpack to {length >> 20} MiB, which are loaded at once, more"
                f" than {_MOST_BYTES >> 20}; save them as Parquet or CSV"
            )


def _arrays(path: Path) -> dict[str, NDArray]:
    """Return the columns of numbers in a file by name."""
    with path.open("rb") as stream:
        is_matlab = stream.read(len(_MAT)) == _MAT
    content: Any
    if is_matlab:
        from scipy.io import loadmat  # takes longer to import than most logs to read

        content = loadmat(path, simplify_cells=True)
        return _columns({k: v for k, v in content.items() if not k.startswith("__")})
    # objects, which may run code when they are loaded, are refused
    content = np.load(path, allow_pickle=False)
    if isinstance(content, np.ndarray):
        return _columns({"": content})
    with content:
        found = {name: _plain(content, name) for name in content.files}
    return _columns({name: array for name, array in found.items() if array is not None})


def _plain(content: Any, name: str) -> NDArray | None:
    """Return an array of an archive; None where it holds objects, which are not loaded."""
    try:
        array = content[name]
    except ValueError:
        return None
    return array if isinstance(array, np.ndarray) else None


def _columns(content: Mapping[str, Any]) -> dict[str, NDArray]:
    """Return arrays as columns; vectors that lie on their side are turned."""
    found: dict[str, NDArray] = {}
    lengths = Counter(
        max(v.shape) for v in content.values() if isinstance(v, np.ndarray) and v.ndim and v.size
    )
    usual = max(lengths, key=lambda n: (lengths[n], n), default=0)
    for name, value in content.items():
        if isinstance(value, Mapping):
            found |= {f"{name}.{key}": column for key, column in _columns(value).items()}
            continue
        if not isinstance(value, np.ndarray) or not value.size:
            continue
        if value.dtype.names is not None:
            fields = {field: value[field] for field in value.dtype.names}
            prefix = f"{name}." if name else ""
            found |= {f"{prefix}{key}": column for key, column in _columns(fields).items()}
            continue
        if value.dtype.kind not in _NUMBER_KINDS or value.ndim not in (1, 2):
            continue
        table = value[:, np.newaxis] if value.ndim == 1 else value
        if table.shape[0] != usual and table.shape[1] == usual:
            table = table.T
        if table.shape[1] > _MAX_WIDTH:
            continue
        for element in range(table.shape[1]):
            single = table.shape[1] == 1
            label = f"{name}[{element}]" if name else f"column {element + 1}"
            found[name if single and name else label] = table[:, element]
    return found


def _rows(path: Path, names: Sequence[str], columns: Sequence[int], rows: int) -> Iterator[Rows]:
    """Yield the values of the given columns; see :class:`ContainerLog`."""
    arrays = _arrays(path)
    chosen = {column: arrays[names[column]] for column in columns}
    length = max((len(values) for values in chosen.values()), default=0)
    for begin in range(0, length, rows):
        part = slice(begin, begin + rows)
        yield {column: np.asarray(values[part], float) for column, values in chosen.items()}
