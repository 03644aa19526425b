"""Bytes of a text log: encoding found, then streamed as UTF-8 in pieces of whole lines."""

import codecs
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from frictioncli.arrays import Numbers
from frictioncli.logs.formats.compression import DAMAGED, is_packed, open_bytes
from frictioncli.logs.formats.plain_numbers import line_feeds
from frictioncli.logs.log_source import UnreadableLog

_BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
ASCII_BASED = ("utf-8", "cp1252")
"""Encodings in which line ends and numbers are the same bytes as in ASCII."""
_HEAD_BYTES = 1 << 16
_LONGEST_LINE = 1 << 25
"""Text without line ends must not fill the memory. [byte]"""

_LINE_BYTES = 1 << 16
"""Blocks of a file end with a whole line if no line is longer. [byte]"""

# bytes that no text log holds; tab, line feed, form feed, carriage return and Ctrl-Z are fine
_CONTROL = bytes(set(range(32)) - {9, 10, 12, 13, 26})


@dataclass(frozen=True, slots=True)
class Piece:
    """Whole lines of a log as UTF-8 (or an ASCII-based code page), and where they stand.

    ``first_line`` counts from 1; the end of ``n_lines`` lines may lack its line feed.
    """

    first_line: int
    n_lines: int
    content: bytes

    @property
    def lines(self) -> Numbers:
        """The number of each line, shape (n_lines,)."""
        return np.arange(self.first_line, self.first_line + self.n_lines, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class Head:
    """The first 64 KiB of a file, unpacked, and the file's size; None where it is packed."""

    content: bytes
    plain_bytes: int | None


def head_of(path: Path) -> Head:
    """Return how a file begins.

    Raises
    ------
    UnreadableLog
        If the file cannot be opened or its packed stream is damaged.
    """
    try:
        with open_bytes(path) as stream:
            size = None if is_packed(stream) else os.fstat(stream.fileno()).st_size
            return Head(stream.read(_HEAD_BYTES), size)
    except DAMAGED as error:
        raise UnreadableLog(f"cannot be opened ({error}); expected a readable file") from error


def encoding_of(head: bytes) -> str | None:
    """Return the encoding of a text file's beginning, or None for binary content."""
    for bom, encoding in _BOMS:
        if head.startswith(bom):
            return encoding
    if b"\0" in head:
        # without a byte order mark, mostly-ASCII UTF-16 shows as every second byte zero
        half = max(len(head) // 2, 1)
        even, odd = head[::2].count(0), head[1::2].count(0)
        if odd > 0.6 * half and even < 0.05 * half:
            return "utf-16-le"
        if even > 0.6 * half and odd < 0.05 * half:
            return "utf-16-be"
        # a few stray zero bytes are damage, many are a binary file
        if head.count(0) > 0.01 * len(head):
            return None
    control = len(head) - len(head.translate(None, _CONTROL))
    if control > 0.02 * len(head):
        return None
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def decode_head(head: bytes, encoding: str) -> str:
    """Return the beginning as text; bytes that do not decode become replacement characters."""
    return codecs.getincrementaldecoder(encoding)("replace").decode(head)


def pieces(path: Path, encoding: str, size: int) -> Iterator[Piece]:
    """Yield a file as pieces of whole lines, each at most about ``size`` bytes plus one line.

    ASCII-based encodings pass through as they are, others become UTF-8. Line ends become line
    feeds where a file has lone carriage returns.

    Raises
    ------
    UnreadableLog
        If the file cannot be read to its end.
    """
    return _of_whole_lines(_blocks(path, encoding, size), 1)


def rest_of(path: Path, start: int, line: int, size: int) -> Iterator[Piece]:
    """Yield what stands from a byte on, which begins a line, as :func:`pieces` does.

    Parameters
    ----------
    path : Path
        A file that is not packed, in one of :data:`ASCII_BASED`.
    start, line : int
        Where to begin, and which line begins there.
    size : int
        How much to read at once. [byte]

    Raises
    ------
    UnreadableLog
        If the file cannot be read to its end.
    """
    return _of_whole_lines(_blocks_from(path, start, size), line)


def _of_whole_lines(blocks: Iterable[bytes], line: int) -> Iterator[Piece]:
    """Yield blocks as pieces of whole lines, of which the first is this one."""
    rest = b""
    try:
        for block in blocks:
            if b"\n" not in block and b"\r" in block:
                block = block.replace(b"\r", b"\n")
            cut = block.rfind(b"\n") + 1
            if cut:
                ends_here = not rest and cut == len(block)
                content = block if ends_here else b"".join((rest, memoryview(block)[:cut]))
                n_lines = line_feeds(content)
                yield Piece(line, n_lines, content)
                line += n_lines
                rest = block[cut:]
            else:
                rest += block
            if len(rest) > _LONGEST_LINE:
                raise UnreadableLog(
                    f"line {line} is longer than {_LONGEST_LINE >> 20} MiB; expected rows of"
                    " numbers"
                )
    except DAMAGED as error:
        raise UnreadableLog(
            f"cannot be read beyond line {line} ({error}); expected a whole file: copy it again"
        ) from error
    if rest:
        yield Piece(line, 1, rest)


def _blocks_from(path: Path, start: int, size: int) -> Iterator[bytes]:
    with path.open("rb", buffering=0) as stream:
        stream.seek(start)
        while block := stream.read(size):
            yield block


def _blocks(path: Path, encoding: str, size: int) -> Iterator[bytes]:
    with open_bytes(path) as stream:
        if encoding in ASCII_BASED:
            if not is_packed(stream):
                yield from _whole_lines(stream, size)
                return
            while block := stream.read(size):
                yield block
            return
        decoder = codecs.getincrementaldecoder(encoding)("replace")
        while block := stream.read(size):
            yield decoder.decode(block).encode("utf-8")
        if last := decoder.decode(b"", final=True):
            yield last.encode("utf-8")


def _whole_lines(stream: BinaryIO, size: int) -> Iterator[bytes]:
    """Yield blocks that end where lines do, so that nothing is copied to join lines.

    Lines that are very long are cut.
    """
    block, length, end = b"", 0, os.fstat(stream.fileno()).st_size
    while len(block) == length:
        start, length = stream.tell(), size
        if start + size < end:
            stream.seek(start + size)
            length += len(stream.readline(_LINE_BYTES))
            stream.seek(start)
        block = stream.read(length)
        if block:
            yield block
