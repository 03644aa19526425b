"""Check of a MATLAB file before 7.3, before scipy loads it: how deep, and how much it unpacks to.

scipy follows arrays in arrays by recursion in C, without a limit, and unpacks each variable whole.
Format: "MAT-File Format", The MathWorks, chapter 1, level 5.
"""

import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from frictioncli.logs.log_source import UnreadableLog

_HEADER_BYTES = 128
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _OBJECT, _FUNCTION, _OPAQUE = 1, 2, 3, 16, 17
_DEEPEST = 64
"""Most arrays in one another."""
_MOST_ELEMENTS = 5_000_000
_READ = 1 << 16  # [byte]
_KEPT = 1 << 20
"""Longest element whose content is looked at: dimensions, or names of fields. [byte]"""


class _Content:
    """Content of a variable, unpacked while it is read; ``before`` is what others unpacked to."""

    def __init__(
        self, stream: BinaryIO, size: int, before: int, most: int, *, packed: bool
    ) -> None:
        self.place = 0
        self._stream, self._left = stream, size
        self._before, self._most = before, most
        self._decoder = zlib.decompressobj() if packed else None
        self._known = b""

    def read(self, count: int) -> bytes:
        """Return the next bytes, fewer at the end."""
        parts = []
        while count and self._filled():
            part, self._known = self._known[:count], self._known[count:]
            parts.append(part)
            count -= len(part)
            self.place += len(part)
        return b"".join(parts)

    def skip(self, count: int) -> None:
        """Pass over bytes."""
        while count and self._filled():
            passed = min(count, len(self._known))
            self._known = self._known[passed:]
            count -= passed
            self.place += passed
        if count:
            raise EOFError

    def _filled(self) -> bool:
        """Return whether there are more bytes, and make some known."""
        while not self._known:
            if self._before + self.place > self._most:
                raise UnreadableLog(
                    f"MATLAB arrays that unpack to more than {self._most >> 20} MiB, which are"
                    " loaded at once; save them with -v7.3"
                )
            if self._decoder is not None and self._decoder.unconsumed_tail:
                self._known = self._decoder.decompress(self._decoder.unconsumed_tail, _READ)
                continue
            packed = self._stream.read(min(self._left, _READ))
            if not packed:
                return False
            self._left -= len(packed)
            self._known = (
                packed if self._decoder is None else self._decoder.decompress(packed, _READ)
            )
        return True


@dataclass(slots=True)
class _Matrix:
    """An array whose elements are being passed: flags, dimensions, name, then what it holds.

    Attributes
    ----------
    end : int
        Where it ends. [byte]
    kind : int
        Its class.
    parts, arrays : int
        Elements, and arrays among them, so far.
    expected : int
        Arrays that it has to hold.
    name_length : int
        Length of the name of a field.
    """

    end: int
    kind: int = 0
    parts: int = 0
    arrays: int = 0
    expected: int = 0
    name_length: int = 0

    @property
    def first_field(self) -> int | None:
        """Place of the element with the length of fields' names; None where it has no fields."""
        return {_STRUCT: 3, _OBJECT: 4}.get(self.kind)

    def add(self, content: bytes, order: str) -> None:
        """Take the next element that is no array."""
        if self.parts == 0:
            self.kind = struct.unpack_from(order + "I", content)[0] & 255
            self.expected = int(self.kind in (_FUNCTION, _OPAQUE))
        elif self.parts == 1 and self.kind in (_CELL, _STRUCT, _OBJECT):
            self.expected = math.prod(struct.unpack(f"{order}{len(content) // 4}i", content))
        elif self.parts == self.first_field:
            self.name_length = struct.unpack_from(order + "i", content)[0]
        elif self.first_field is not None and self.parts == self.first_field + 1:
            self.expected *= len(content) // max(self.name_length, 1)
        self.parts += 1


def check_matlab(path: Path, most: int) -> None:
    """Check that a file can be loaded; one that is damaged otherwise is left to scipy.

    Parameters
    ----------
    path : Path
        A MATLAB file before version 7.3.
    most : int
        Greatest length of its content. [byte]

    Raises
    ------
    UnreadableLog
        If arrays lie in one another deeper than any log needs, hold fewer arrays than they state,
        or the content is too long.
    """
    with path.open("rb") as stream:
        order = ">" if stream.read(_HEADER_BYTES)[-2:] == b"MI" else "<"
        elements = passed = 0
        while len(tag := stream.read(8)) == 8:
            kind, size = struct.unpack(order + "II", tag)
            begin = stream.tell()
            content = _Content(stream, size, passed, most, packed=kind == _COMPRESSED)
            try:
                if kind == _COMPRESSED:
                    kind, inner = struct.unpack(order + "II", content.read(8))
                    content.place = 0
                else:
                    inner = size
                if kind == _MATRIX:
                    elements = _pass_over(content, inner, order, elements)
            except (EOFError, struct.error, zlib.error):
                return
            passed += content.place
            stream.seek(begin + size)


def _pass_over(content: _Content, size: int, order: str, elements: int) -> int:
    """Pass over an array with all that lies in it; return the elements so far."""
    above = [_Matrix(size)]
    while above:
        matrix = above[-1]
        if content.place >= matrix.end:
            if matrix.arrays < matrix.expected:
                raise UnreadableLog(
                    "MATLAB arrays that contradict themselves: one holds fewer arrays than it"
                    " states; expected a whole file: copy it again"
                )
            above.pop()
            continue
        elements += 1
        if elements > _MOST_ELEMENTS:
            raise UnreadableLog("MATLAB arrays of too many parts; save those of the joint alone")
        kind, length = struct.unpack(order + "II", content.read(8))
        if kind == _MATRIX:
            matrix.arrays += 1
            if length:
                above.append(_Matrix(content.place + length))
            if len(above) > _DEEPEST:
                raise UnreadableLog(
                    f"MATLAB arrays in one another deeper than {_DEEPEST}; save those of the joint"
                    " alone"
                )
        elif kind >> 16:  # up to four bytes in the place of the length
            matrix.add(struct.pack(order + "I", length)[: kind >> 16], order)
        elif length <= _KEPT:
            matrix.add(content.read(length), order)
            content.skip(-length % 8)
        elif matrix.kind in (_CELL, _STRUCT, _OBJECT):
            raise UnreadableLog("MATLAB arrays with too many fields; save those of the joint alone")
        else:
            content.skip(length + -length % 8)
            matrix.parts += 1
    return elements
