"""A small log whose rows are known, and those of text that is delimited."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tests.logs.logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth(seconds=3.0)
TORQUE = TORQUE + np.round(np.arange(len(TIME)) * 0.001, 3)  # every row is one of a kind
CALM = np.full(len(TIME), 31.0)


def _as_is(content: bytes) -> bytes:
    return content


@dataclass(frozen=True, slots=True)
class Layout:
    """A folder of logs whose rows are known.

    Attributes
    ----------
    name : str
        Which layout.
    log : str
        File that is damaged most.
    head, rows : tuple of bytes
        Its lines before the first row, and its rows: one line each, without line ends.
    newline : bytes
        What ends a line.
    pack : callable
        From text as bytes to the file's content.
    others : mapping of str to bytes
        Further files of the folder.
    map_file : str or None
        Which of them is the mapping file.
    gear_ratio : float or None
        What the user says of a log of the motor's side.
    joint : int
        Whose rows they are; a damaged log may seem to have more.
    binary : bytes
        The log where it is no text; there are no lines then.
    joints : tuple of int or None
        Whose row each is, where a row is of one joint only.
    time : ndarray of float, shape (n,), or None
        Time of the rows from any begin; None where damage to a row changes that of later ones. [s]
    position : ndarray of float, shape (n,), or None
        What the rows say; None where damage to a row changes that of later ones. [deg]
    torque : ndarray of float, shape (n,)
        What the rows say. [N·m, or the log's own unit]
    """

    name: str
    log: str
    head: tuple[bytes, ...] = ()
    rows: tuple[bytes, ...] = ()
    newline: bytes = b"\n"
    pack: Callable[[bytes], bytes] = _as_is
    others: Mapping[str, bytes] = field(default_factory=dict)
    map_file: str | None = None
    gear_ratio: float | None = None
    joint: int = 2
    binary: bytes = b""
    joints: tuple[int, ...] | None = None
    time: NDArray[np.float64] | None = field(default_factory=lambda: TIME)
    position: NDArray[np.float64] | None = field(default_factory=lambda: POSITION)
    torque: NDArray[np.float64] = field(default_factory=lambda: TORQUE)

    def content(self, head: list[bytes] | None = None, rows: list[bytes] | None = None) -> bytes:
        """Return the log's bytes, with other lines where they are given."""
        if self.binary:
            return self.binary
        lines = [*(self.head if head is None else head), *(self.rows if rows is None else rows)]
        return self.pack(self.newline.join(lines) + self.newline)


def text_layout(
    name: str,
    columns: Mapping[str, NDArray[np.float64]],
    *,
    delimiter: str = ";",
    decimal: str = ".",
    encoding: str = "utf-8",
    bom: bool = False,
    digits: int = 9,
    **more,
) -> Layout:
    """Return a delimited layout; the truth is what the written digits say."""
    header = delimiter.join(columns).encode(encoding)
    rows = [
        delimiter.join(f"{value:.{digits}f}".replace(".", decimal) for value in row).encode()
        for row in zip(*columns.values(), strict=True)
    ]
    mark = b"\xef\xbb\xbf" if bom else b""
    return Layout(name, more.pop("log", "log.csv"), (mark + header,), tuple(rows), **more)
