"""Layout of the samples of a DIAdem recording: files, data types and positions."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import numpy as np

from frictioncli.logs.formats.diadem_header import DamagedHeader, Header, HeaderSection

_FILE, _STORAGE, _TYPE, _FIRST, _STEP = 211, 213, 214, 221, 222
_BYTE_ORDER = 112
_LITTLE_ENDIAN = re.compile(r"(?i)high\s*->\s*low")
_BIG_ENDIAN = re.compile(r"(?i)low\s*->\s*high")

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
class SampleLocation:
    """Location of a channel's numbers.

    Attributes
    ----------
    file : Path
        File of the samples.
    dtype : dtype
        Data type with byte order.
    first : int
        Offset of the first number. [byte]
    step : int
        Distance from one number to the next. [byte]
    in_rows : bool
        Whether the file consists of rows with one number of each channel.
    """

    file: Path
    dtype: np.dtype
    first: int
    step: int
    in_rows: bool

    def end(self, n: int) -> int:
        """Return the offset of the end of ``n`` numbers [byte]."""
        return self.first + (n - 1) * self.step + self.dtype.itemsize


def sample_locations(
    header: Header, explicit: Sequence[HeaderSection]
) -> dict[str, SampleLocation]:
    """Return the location of the numbers of each explicit channel, by the name of its section.

    Raises
    ------
    DamagedHeader
        If the header contradicts itself.
    """
    order = _byte_order(header.general)
    files = {c.text(_FILE): _samples_file(header.path, c) for c in explicit}
    dtypes = {c.where: _dtype(c, order) for c in explicit}
    blocks: dict[Path, list[HeaderSection]] = {}
    found: dict[str, SampleLocation] = {}
    for section in explicit:
        file, dtype = files[section.text(_FILE)], dtypes[section.where]
        storage = section.text(_STORAGE).upper()
        if storage == "BLOCK":
            blocks.setdefault(file, []).append(section)
        elif storage == "CHANNEL":
            first = (_pointer(section) - 1) * dtype.itemsize
            found[section.where] = SampleLocation(file, dtype, first, dtype.itemsize, in_rows=False)
        else:
            raise section.damaged(_STORAGE, "BLOCK or CHANNEL")
    for file, sections in blocks.items():
        found |= _interleaved(file, sections, dtypes)
    return found


def _interleaved(
    file: Path, sections: Sequence[HeaderSection], dtypes: dict[str, np.dtype]
) -> dict[str, SampleLocation]:
    """Return the locations of channels whose numbers alternate in a file."""
    ordered = sorted(sections, key=_pointer)
    pointers = [_pointer(section) for section in ordered]
    widths = [dtypes[section.where].itemsize for section in ordered]
    steps = {section.count(_STEP) for section in ordered} - {0, 1}
    values = steps.pop() if len(steps) == 1 else len(ordered)
    gapless = pointers == list(range(1, len(pointers) + 1))
    # gaps are allowed where all numbers have the same width
    separable = len(set(widths)) == 1 and len(set(pointers)) == len(pointers)
    if steps or pointers[-1] > values or not (separable or (gapless and values == len(ordered))):
        raise DamagedHeader(
            f"the channels of {file.name} lie at {_listed(pointers)} of {values} values per row"
            " (keys 221, 222); expected 1, 2, 3 without gap"
        )
    if gapless:
        firsts = [sum(widths[:i]) for i in range(len(widths))]
    else:
        firsts = [(pointer - 1) * widths[0] for pointer in pointers]
    step = sum(widths) if values == len(ordered) else values * widths[0]
    return {
        section.where: SampleLocation(file, dtypes[section.where], first, step, in_rows=True)
        for section, first in zip(ordered, firsts, strict=True)
    }


def _pointer(section: HeaderSection) -> int:
    pointer = section.count(_FIRST, 1)
    if pointer < 1:
        raise section.damaged(_FIRST, "a position from 1")
    return pointer


def _byte_order(general: HeaderSection) -> str:
    """Return numpy's byte order character; DIAdem calls little-endian ``High -> Low``."""
    text = general.text(_BYTE_ORDER, "High -> Low")
    if _LITTLE_ENDIAN.fullmatch(text):
        return "<"
    if _BIG_ENDIAN.fullmatch(text):
        return ">"
    raise general.damaged(_BYTE_ORDER, "'High -> Low' or 'Low -> High'")


def _dtype(section: HeaderSection, order: str) -> np.dtype:
    kind = section.text(_TYPE).upper()
    if kind not in _TYPES:
        raise section.damaged(_TYPE, f"one of {', '.join(_TYPES)}")
    return np.dtype(order + _TYPES[kind])


def _samples_file(header: Path, section: HeaderSection) -> Path:
    """Return the file of samples: the one named, else one named like the header.

    It is searched for only in the header's folder, whatever folder the header names.

    Raises
    ------
    DamagedHeader
        If the name leads outside the folder.
    """
    named = PureWindowsPath(section.text(_FILE))
    if ".." in named.parts or "\0" in named.name:
        raise section.damaged(_FILE, "a file in the header's own folder")
    candidates = [header.with_name(named.name)] if named.name else []
    stem = header.name.split(".dat", 1)[0] if ".dat" in header.name else header.stem
    suffixes = dict.fromkeys((named.suffix or ".r64", ".r64", ".R64"))
    candidates += [header.with_name(stem + suffix) for suffix in suffixes]
    return next((file for file in candidates if file != header and is_file(file)), candidates[0])


def is_file(path: Path) -> bool:
    """Return whether a file exists; False for a name that no file can have."""
    try:
        return path.is_file()
    except OSError:  # an invalid name
        return False


def _listed(numbers: Sequence[int]) -> str:
    shown = ", ".join(map(str, numbers[:8]))
    return shown + (", ..." if len(numbers) > 8 else "")
