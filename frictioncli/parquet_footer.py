"""Footers of Parquet files that are too large to parse at once: their row groups part by part.

The footer describes every column of every row group, and pyarrow takes eight times its size to hold
it. Of a large one only the ends of the row groups are found here, and pyarrow is given footers of a
few row groups each. The file is read, not mapped: the system ends a process that touches what was
cut off a mapped file. Format: https://parquet.apache.org/docs/file-format/metadata, in the compact
protocol of Apache Thrift.
"""

import re
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO, TypeVar

import pyarrow as pa
import pyarrow.parquet as pq

from frictioncli.errors import TableError

_MAGIC = b"PAR1"
_TAIL_BYTES = 8
"""Length of the footer, and the magic number, at the end of a file. [byte]"""

_LARGE_BYTES = 1 << 23
"""Smaller footers are left to pyarrow. [byte]"""

_PART_BYTES = 1 << 22
"""Description of the row groups that are parsed at a time. [byte]"""

_MOST_PART_BYTES = 1 << 26
"""Longest description of one row group that is looked at. [byte]"""

_TRUE, _FALSE, _BYTE, _I16, _I32, _I64, _DOUBLE, _BINARY, _LIST, _SET, _MAP, _STRUCT = range(1, 13)
_INTEGERS = (_I16, _I32, _I64)
_ROW_GROUPS = 4
"""Number of the field with the row groups."""

_DEEPEST = 32

_Found = TypeVar("_Found")


def _headers(*kinds: int) -> bytes:
    """Return a class of the headers of fields of these kinds, whose number follows the last."""
    return b"".join(b"\\x%02x" % (step << 4 | kind) for kind in kinds for step in range(1, 16))


_INTEGER = rb"[\x80-\xff]{0,9}[\x00-\x7f]"
_TEXTS = b"|".join(b"\\x%02x.{%d}" % (length, length) for length in (8, *range(8), *range(9, 48)))
_PLAIN = rb"[%s]%s|[%s](?:%s)|[%s](?:\x15(?:%s)|\x25(?:%s){2}|\x35(?:%s){3})|[%s]" % (
    *(_headers(*_INTEGERS), _INTEGER, _headers(_BINARY), _TEXTS),
    *(_headers(_LIST), _INTEGER, _INTEGER, _INTEGER, _headers(_TRUE, _FALSE)),
)
_VARINT = re.compile(_INTEGER)
_FIELDS = re.compile(
    rb"(?:%s|[%s](?:%s)*+\x00|[%s](?:\x1c(?:%s)*+\x00|\x2c(?:(?:%s)*+\x00){2}))*+"
    % (_PLAIN, _headers(_STRUCT), _PLAIN, _headers(_LIST), _PLAIN, _PLAIN),
    re.DOTALL,
)
"""Fields one after the other of a structure, of the kinds that most fields of a footer have."""


@dataclass(frozen=True, slots=True)
class LargeFooter:
    """Location of a large footer, and of the row groups in it.

    Attributes
    ----------
    path : Path
        The file.
    header : int
        Location of the header of the list of row groups in the file. [byte]
    ends : array of int
        Location of the first row group, and the end of each. [byte]
    begin, end : int
        Location of the footer. [byte]
    """

    path: Path
    begin: int
    header: int
    ends: "array[int]"
    end: int

    @property
    def longest(self) -> int:
        """Greatest number of bytes that describe one row group."""
        return max(end - begin for begin, end in pairwise(self.ends))

    def parts(self) -> Iterator[pq.FileMetaData]:
        """Yield the metadata of a few row groups after the other."""
        with self.path.open("rb") as stream:
            before = _read(stream, self.begin, self.header)
            after = _read(stream, self.ends[-1], self.end)
            first = 0
            while first + 1 < len(self.ends):
                last = first + 1
                while last + 1 < len(self.ends) and (
                    self.ends[last + 1] - self.ends[first] <= _PART_BYTES
                ):
                    last += 1
                groups = _read(stream, self.ends[first], self.ends[last])
                yield _parsed(before + _list_header(last - first) + groups + after)
                first = last


def large_footer(path: Path) -> LargeFooter | None:
    """Return the footer of a Parquet file where it is large, else None.

    Raises
    ------
    ValueError
        If the footer is damaged.
    """
    with path.open("rb") as stream:
        size = stream.seek(0, 2)
        stream.seek(max(size - _TAIL_BYTES, 0))
        tail = stream.read()
        length = int.from_bytes(tail[:4], "little")
        if tail[4:] != _MAGIC or not _LARGE_BYTES < length <= size - _TAIL_BYTES:
            return None  # pyarrow tells what is wrong
        end = size - _TAIL_BYTES
        header, ends = _row_groups(_FooterParts(stream, end), end - length)
    return LargeFooter(path, end - length, header, ends, end)


def row_groups(path: Path) -> Iterator[pq.FileMetaData | None]:
    """Yield the metadata of a few row groups after the other; None where the footer is small.

    Parameters
    ----------
    path : Path
        A Parquet file; None is yielded for whatever is none.

    Raises
    ------
    TableError
        If the footer is large and damaged.
    """
    try:
        footer = large_footer(path) if path.is_file() else None
    except (OSError, ValueError) as error:
        raise TableError(f"{path}: cannot be read as Parquet ({error})") from error
    if footer is None:
        yield None
    else:
        yield from footer.parts()


@dataclass(slots=True)
class _FooterParts:
    """A footer that is read part by part.

    Attributes
    ----------
    stream : file
        The file.
    end : int
        End of the footer. [byte]
    content : bytes
        The part that was read last.
    begin : int
        Location of the part in the file. [byte]
    """

    stream: BinaryIO
    end: int
    content: bytes = b""
    begin: int = 0

    def found(self, find: Callable[[bytes, int], _Found], at: int) -> _Found:
        """Return what is found at a location, by its distance from the part's ``begin``.

        Raises
        ------
        ValueError
            If the footer is damaged, or one of its row groups is too long.
        """
        size = 0
        while True:
            try:
                return find(self.content, at - self.begin)
            except (AttributeError, IndexError, ValueError) as error:
                if size >= self.end - at:
                    raise ValueError("its footer is damaged") from error
                if size >= _MOST_PART_BYTES:
                    raise ValueError("its footer has a row group of too many columns") from error
            # begun, and perhaps not ended, in this part
            size = 4 * size or _PART_BYTES
            self.begin, self.content = at, b""
            self.content = _read(self.stream, at, min(at + size, self.end))


def _row_groups(parts: _FooterParts, at: int) -> tuple[int, "array[int]"]:
    """Return the location of the list of row groups, of the first and of the end of each."""
    header, count, first = parts.found(_list_of_row_groups, at)
    header, ends = header + parts.begin, array("Q", [first + parts.begin])
    for _ in range(count):
        ends.append(parts.found(_struct_end, ends[-1]) + parts.begin)
    return header, ends


def _list_of_row_groups(file: bytes, at: int) -> tuple[int, int, int]:
    """Return the location of the list, the number of row groups, the location of the first."""
    number = 0
    while head := file[at]:
        at += 1
        if head < 16:
            raise ValueError("a number of a field in the long form")
        number += head >> 4
        if number == _ROW_GROUPS and head & 15 == _LIST:
            break
        at = _value_end(file, at, head & 15, 0)
    else:
        raise ValueError("no row groups")
    count, kind, first = _list_of(file, at)
    if kind != _STRUCT or not count:
        raise ValueError("no row groups")
    return at, count, first


def _struct_end(file: bytes, at: int, depth: int = 0) -> int:
    if depth > _DEEPEST:
        raise ValueError("too deep")
    while True:
        at = _FIELDS.match(file, at).end()  # type: ignore[union-attr]
        head = file[at]
        at += 1
        if not head:
            return at
        if head < 16:  # the number of the field follows
            at = _VARINT.match(file, at).end()  # type: ignore[union-attr]
        at = _value_end(file, at, head & 15, depth)


def _value_end(file: bytes, at: int, kind: int, depth: int) -> int:
    if kind in _INTEGERS:
        return _VARINT.match(file, at).end()  # type: ignore[union-attr]
    if kind == _BINARY:
        length, at = _number(file, at)
        return at + length
    if kind == _STRUCT:
        return _struct_end(file, at, depth + 1)
    if kind in (_LIST, _SET):
        count, kind, at = _list_of(file, at)
        if kind in (_TRUE, _FALSE, _BYTE):
            return at + count
        for _ in range(count):
            at = _value_end(file, at, kind, depth + 1)
        return at
    if kind in (_TRUE, _FALSE):
        return at
    if kind in (_BYTE, _DOUBLE):
        return at + (1 if kind == _BYTE else 8)
    raise ValueError(f"a value of kind {kind}")


def _list_of(file: bytes, at: int) -> tuple[int, int, int]:
    """Return number and kind of the elements of a list, and where the first one is."""
    head = file[at]
    if head >> 4 < 15:
        return head >> 4, head & 15, at + 1
    count, at = _number(file, at + 1)
    return count, head & 15, at


def _list_header(count: int) -> bytes:
    """Return the header of a list of structures."""
    if count < 15:
        return bytes([count << 4 | _STRUCT])
    digits = []
    while count > 127:
        digits.append(count & 127 | 128)
        count >>= 7
    return bytes([15 << 4 | _STRUCT, *digits, count])


def _number(file: bytes, at: int) -> tuple[int, int]:
    """Return an unsigned number, and where it ends."""
    end = _VARINT.match(file, at).end()  # type: ignore[union-attr]
    return sum((byte & 127) << 7 * n for n, byte in enumerate(file[at:end])), end


def _read(stream: BinaryIO, begin: int, end: int) -> bytes:
    stream.seek(begin)
    return stream.read(end - begin)


def _parsed(footer: bytes) -> pq.FileMetaData:
    file = _MAGIC + footer + len(footer).to_bytes(4, "little") + _MAGIC
    return pq.read_metadata(pa.BufferReader(file))
