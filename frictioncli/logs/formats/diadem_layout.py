"""Where the numbers of a DIAdem recording lie: files, types, positions."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import numpy as np

from frictioncli.logs.formats.diadem_header import DamagedHeader, Header, HeaderSection

_FILE, _STORAGE, _TYPE, _FIRST, _STEP = 211, 213, 214, 221, 222
_BYTE_ORDER = 112

_TYPES = {
    "REAL32": "f4",
    "REAL64": "f8",
    "INT16": "i2",
    "INT32": "i4",
    "WORD8": "u1",
    "WORD16": "u2",
    "WORD32": "u4",
}


@dataclass(frozen=True, slots=True)
class Place:
    """Where the numbers of a channel lie: byte of the first, bytes from one to the next.

    ``in_rows`` where the file is made of rows that hold one number of each channel.
    """

    file: Path
    dtype: np.dtype
    first: int
    step: int
    in_rows: bool

    def end(self, n: int) -> int:
        """Return the byte after the last of ``n`` numbers."""
        return self.first + (n - 1) * self.step + self.dtype.itemsize


def places(header: Header, explicit: Sequence[HeaderSection]) -> dict[str, Place]:
    """Return where the numbers of each explicit channel lie, by its section's name."""
    order = _byte_order(header.general)
    files = {c.text(_FILE): _samples_file(header.path, c) for c in explicit}
    dtypes = {c.where: _dtype(c, order) for c in explicit}
    blocks: dict[Path, list[HeaderSection]] = {}
    found: dict[str, Place] = {}
    for section in explicit:
        file, dtype = files[section.text(_FILE)], dtypes[section.where]
        storage = section.text(_STORAGE).upper()
        if storage == "BLOCK":
            blocks.setdefault(file, []).append(section)
        elif storage == "CHANNEL":
            first = (_pointer(section) - 1) * dtype.itemsize
            found[section.where] = Place(file, dtype, first, dtype.itemsize, in_rows=False)
        else:
            raise section.damaged(_STORAGE, "BLOCK or CHANNEL")
    for file, sections in blocks.items():
        found |= _interleaved(file, sections, dtypes)
    return found


def _interleaved(
    file: Path, sections: Sequence[HeaderSection], dtypes: dict[str, np.dtype]
) -> dict[str, Place]:
    """Return the places of channels that share each row of a file."""
    ordered = sorted(sections, key=_pointer)
    pointers = [_pointer(section) for section in ordered]
    widths = [dtypes[section.where].itemsize for section in ordered]
    told = {section.count(_STEP) for section in ordered} - {0, 1}
    values = told.pop() if len(told) == 1 else len(ordered)
    whole = pointers == list(range(1, len(pointers) + 1))
    partly = len(set(widths)) == 1 and len(set(pointers)) == len(pointers)
    if told or pointers[-1] > values or not (partly or (whole and values == len(ordered))):
        raise DamagedHeader(
            f"the channels of {file.name} lie at {_listed(pointers)} of {values} values per row"
            " (keys 221, 222); expected 1, 2, 3 without gap"
        )
    if whole:
        firsts = [sum(widths[:i]) for i in range(len(widths))]
    else:
        firsts = [(pointer - 1) * widths[0] for pointer in pointers]
    step = sum(widths) if values == len(ordered) else values * widths[0]
    return {
        section.where: Place(file, dtypes[section.where], first, step, in_rows=True)
        for section, first in zip(ordered, firsts, strict=True)
    }


def _pointer(section: HeaderSection) -> int:
    pointer = section.count(_FIRST, 1)
    if pointer < 1:
        raise section.damaged(_FIRST, "a position from 1")
    return pointer


def _byte_order(general: HeaderSection) -> str:
    """Return numpy's sign of the byte order; DIAdem calls little-endian ``High -> Low``."""
    text = general.text(_BYTE_ORDER, "High -> Low")
    if re.fullmatch(r"(?i)high\s*->\s*low", text):
        return "<"
    if re.fullmatch(r"(?i)low\s*->\s*high", text):
        return ">"
    raise general.damaged(_BYTE_ORDER, "'High -> Low' or 'Low -> High'")


def _dtype(section: HeaderSection, order: str) -> np.dtype:
    kind = section.text(_TYPE).upper()
    if kind not in _TYPES:
        raise section.damaged(_TYPE, f"one of {', '.join(_TYPES)}")
    return np.dtype(order + _TYPES[kind])


def _samples_file(header: Path, section: HeaderSection) -> Path:
    """Return the file of samples: the one named, else the header's name with its ending.

    Only the header's own folder is looked at, whatever folder the name has.

    Raises
    ------
    DamagedHeader
        If the name climbs out of the folder.
    """
    named = PureWindowsPath(section.text(_FILE))
    if ".." in named.parts or "\0" in named.name:
        raise section.damaged(_FILE, "a file in the header's own folder")
    beside = [header.with_name(named.name)] if named.name else []
    stem = header.name.split(".dat", 1)[0] if ".dat" in header.name else header.stem
    endings = dict.fromkeys((named.suffix or ".r64", ".r64", ".R64"))
    beside += [header.with_name(stem + ending) for ending in endings]
    return next((file for file in beside if file != header and is_file(file)), beside[0])


def is_file(path: Path) -> bool:
    """Return whether there is such a file, whatever a header has named it."""
    try:
        return path.is_file()
    except OSError:  # a name that no file can have
        return False


def _listed(numbers: Sequence[int]) -> str:
    shown = ", ".join(map(str, numbers[:8]))
    return shown + (", ..." if len(numbers) > 8 else "")
