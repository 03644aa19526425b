"""Recordings of Universal Robots' ``record.py --binary``: two lines of text, then numbers."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from frictioncli.logs.formats.compression import open_bytes
from frictioncli.logs.formats.containers import ContainerLog, Rows, first_names
from frictioncli.logs.log_source import CsvHints, Refusal

_WHAT = "an RTDE recording (binary)"
_TYPES = {
    b"DOUBLE": ">f8",
    b"INT32": ">i4",
    b"UINT32": ">u4",
    b"UINT64": ">u8",
    b"UINT8": "u1",
    b"BOOL": "u1",
}
"""numpy type by RTDE type; values are big-endian and follow each other without gaps."""
_MAX_BLOCK = 1 << 22  # [byte]


def read_rtde(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open a binary RTDE recording; None when it is another format."""
    lines = head.split(b"\n", 2)
    types = lines[1].split() if len(lines) == 3 else []
    if not types or not set(types) <= set(_TYPES):
        return None
    names = lines[0].decode("utf-8", "replace").split()
    if len(names) != len(types):
        return Refusal(
            "wrong_field_count",
            f"{_WHAT} that names {len(names)} columns ({first_names(names)}) and {len(types)}"
            " types; expected as many",
        )
    row = np.dtype([(str(i), _TYPES[kind]) for i, kind in enumerate(types)])
    begin = len(head) - len(lines[2])
    return ContainerLog(path, tuple(names), _WHAT, partial(_rows, path, begin, row))


def _rows(
    path: Path, begin: int, row: np.dtype[np.void], columns: Sequence[int], rows: int
) -> Iterator[Rows]:
    """Yield the values of the given columns; see :class:`ContainerLog`."""
    rows_at_a_time = min(rows, max(_MAX_BLOCK // row.itemsize, 1))
    with open_bytes(path) as stream:
        stream.read(begin)
        while content := stream.read(rows_at_a_time * row.itemsize):
            complete, rest = divmod(len(content), row.itemsize)
            found = np.frombuffer(content, row, complete)
            yield {
                # an interrupted recording ends within a row, which has no values
                column: np.append(found[str(column)].astype(np.float64), [np.nan] * bool(rest))
                for column in columns
            }
