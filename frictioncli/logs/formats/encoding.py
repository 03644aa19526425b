"""Text logs as bytes: detect the encoding and stream the content as blocks of whole lines."""

import codecs
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np

from frictioncli.arrays import Numbers
from frictioncli.logs.channels.translated_names import known_words
from frictioncli.logs.formats.compression import STREAM_ERRORS, is_compressed, open_bytes
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
_NEED_MARK = ("utf-16", "utf-32")
EAST_ASIAN = ("gb18030", "cp932", "big5")
"""Code pages of Chinese and Japanese loggers."""
_LEAST_WORDS = 2
HEAD_BYTES = 1 << 16
"""Length of the beginning from which the format is detected. [byte]"""
_HEAD_LINES, _LONGEST_HEAD = 20, 1 << 22
"""Of a text with longer lines, so many lines are the beginning, up to this length. [-, byte]"""
_MAX_LINE = 1 << 25
"""Longest line; text without line ends must not fill the memory. [byte]"""
_MAX_BLANKS = 1 << 25
_MAX_BLANK_SHARE = 0.99
"""A longer compressed text with more blanks is refused: a few kB can be GB of them. [byte, -]"""
_BLANKS = b" \r\n"
_EXPECTED_LINE = 1 << 16
"""Up to this line length, blocks of a file end with a whole line. [byte]"""
# bytes that occur in no text log; tab, line feed, form feed, carriage return and Ctrl-Z may occur
_CONTROL = bytes(set(range(32)) - {9, 10, 12, 13, 26})


@dataclass(frozen=True, slots=True)
class LineBlock:
    """Consecutive whole lines of a log.

    Attributes
    ----------
    first_line : int
        Number of the first line, from 1.
    n_lines : int
        Number of lines; the last one may lack its line feed.
    content : bytes
        The lines in UTF-8 or an ASCII-based code page.
    """

    first_line: int
    n_lines: int
    content: bytes

    @property
    def lines(self) -> Numbers:
        """The number of each line, shape (n_lines,)."""
        return np.arange(self.first_line, self.first_line + self.n_lines, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class FileHead:
    """The beginning of a file.

    Attributes
    ----------
    content : bytes
        The first 64 KiB, decompressed; more where thousands of columns make long lines.
    file_size : int or None
        Size of the file; None where it is compressed. [byte]
    """

    content: bytes
    file_size: int | None


def read_head(path: Path) -> FileHead:
    """Read the beginning of a file.

    Raises
    ------
    UnreadableLog
        If the file cannot be opened, or its compressed stream is damaged.
    """
    try:
        with open_bytes(path) as stream:
            size = None if is_compressed(stream) else os.fstat(stream.fileno()).st_size
            content = stream.read(HEAD_BYTES)
            while (
                HEAD_BYTES <= len(content) < _LONGEST_HEAD
                and content.count(b"\n") < _HEAD_LINES
                and content.count(b"\r") < _HEAD_LINES
                and detect_encoding(content[:HEAD_BYTES]) is not None
                and (more := stream.read(len(content)))
            ):
                content += more
            return FileHead(content, size)
    except STREAM_ERRORS as error:
        why = getattr(error, "strerror", None) or error
        raise UnreadableLog(f"cannot be opened ({why}); expected a readable file") from error


def detect_encoding(head: bytes) -> str | None:
    """Return the encoding of the beginning of a text file, or None for binary content.

    Examples
    --------
    >>> detect_encoding("Drehmoment; Gehäuse".encode("cp1252"))
    'cp1252'
    >>> detect_encoding("时间;位置;力矩".encode("gbk"))
    'gb18030'
    """
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
        # a few zero bytes are damage, many mean a binary file
        if head.count(0) > 0.01 * len(head):
            return None
    control = len(head) - len(head.translate(None, _CONTROL))
    if control > 0.02 * len(head):
        return None
    if _decodes(head, "utf-8"):
        return "utf-8"
    return next((one for one in EAST_ASIAN if _names_columns(head, one)), "cp1252")


def _decodes(head: bytes, encoding: str) -> bool:
    try:
        codecs.getincrementaldecoder(encoding)().decode(head)
    except UnicodeDecodeError:
        return False
    return True


def _names_columns(head: bytes, encoding: str) -> bool:
    """Return whether a text has two known words of column names in an encoding.

    Umlauts of Western code pages decode as characters, too, but not as these words.
    """
    if not _decodes(head, encoding):
        return False
    return len(known_words(decode_head(head, encoding))) >= _LEAST_WORDS


def known_encoding(head: bytes, given: str | None) -> str | None:
    """Return the encoding of a text file that the user may have given; None for binary content.

    UTF-16 and UTF-32 need a byte order: without a byte order mark it is found, else little-endian.

    Examples
    --------
    >>> known_encoding("Zeit".encode("utf-16-be"), "utf-16")
    'utf-16-be'
    """
    if given not in _NEED_MARK or any(head.startswith(bom) for bom, _ in _BOMS[1:]):
        return given or detect_encoding(head)
    width = int(given[-2:]) // 8
    zeros = [head[place::width].count(0) for place in range(width)]
    return f"{given}-be" if zeros[0] > zeros[-1] else f"{given}-le"


def decode_head(head: bytes, encoding: str) -> str:
    """Return the beginning as text; undecodable bytes become replacement characters."""
    return codecs.getincrementaldecoder(encoding)("replace").decode(head)


def line_blocks(path: Path, encoding: str, size: int) -> Iterator[LineBlock]:
    """Yield a file in blocks of whole lines.

    The content of ASCII-based encodings is unchanged; other encodings are converted to UTF-8.
    Carriage returns become line feeds where there are no line feeds.

    Parameters
    ----------
    path : Path
        A text file, compressed or not.
    encoding : str
        Its encoding.
    size : int
        Approximate size of a block, to which part of a line may be added. [byte]

    Raises
    ------
    UnreadableLog
        If the file cannot be read to its end.
    """
    return _split_at_lines(_blocks(path, encoding, size), 1)


def line_blocks_from(path: Path, start: int, line: int, size: int) -> Iterator[LineBlock]:
    """Yield the rest of a file in blocks of whole lines, from a byte that begins a line.

    Parameters
    ----------
    path : Path
        A file that is not compressed, in one of :data:`ASCII_BASED`.
    start : int
        Offset of the first byte. [byte]
    line : int
        Number of the line that begins there.
    size : int
        Approximate size of a block. [byte]

    Raises
    ------
    UnreadableLog
        If the file cannot be read to its end.
    """
    return _split_at_lines(_blocks_from(path, start, size), line)


def _split_at_lines(blocks: Iterable[bytes], line: int) -> Iterator[LineBlock]:
    """Yield blocks of bytes as blocks of whole lines; ``line`` is the number of the first."""
    rest = b""
    try:
        for block in blocks:
            if b"\n" not in block and b"\r" in block:
                block = block.replace(b"\r", b"\n")
            cut = block.rfind(b"\n") + 1
            if cut:
                is_whole = not rest and cut == len(block)
                content = block if is_whole else b"".join((rest, memoryview(block)[:cut]))
                n_lines = line_feeds(content)
                yield LineBlock(line, n_lines, content)
                line += n_lines
                rest = block[cut:]
            else:
                rest += block
            if len(rest) > _MAX_LINE:
                raise UnreadableLog(
                    f"line {line} is longer than {_MAX_LINE >> 20} MiB; expected rows of numbers"
                )
    except STREAM_ERRORS as error:
        raise UnreadableLog(
            f"cannot be read beyond line {line} ({error}); expected a whole file: copy it again"
        ) from error
    if rest:
        yield LineBlock(line, 1, rest)


def _blocks_from(path: Path, start: int, size: int) -> Iterator[bytes]:
    with path.open("rb", buffering=0) as stream:
        stream.seek(start)
        while block := stream.read(size):
            yield block


def _blocks(path: Path, encoding: str, size: int) -> Iterator[bytes]:
    with open_bytes(path) as stream:
        if encoding in ASCII_BASED:
            if not is_compressed(stream):
                yield from _blocks_of_lines(stream, size)
                return
            yield from _bounded_blanks(iter(partial(stream.read, size), b""))
            return
        decoder = codecs.getincrementaldecoder(encoding)("replace")
        decoded = (
            decoder.decode(block).encode("utf-8") for block in iter(partial(stream.read, size), b"")
        )
        yield from _bounded_blanks(decoded) if is_compressed(stream) else decoded
        if last := decoder.decode(b"", final=True):
            yield last.encode("utf-8")


def _bounded_blanks(blocks: Iterable[bytes]) -> Iterator[bytes]:
    """Yield blocks until nearly all of a long text is blank."""
    length = filled = 0
    for block in blocks:
        length += len(block)
        filled += len(block.translate(None, _BLANKS))
        if length > _MAX_BLANKS and filled < (1 - _MAX_BLANK_SHARE) * length:
            raise UnreadableLog(
                f"only {filled} of its first {length} characters are not blank; expected rows of"
                " numbers"
            )
        yield block


def _blocks_of_lines(stream: BinaryIO, size: int) -> Iterator[bytes]:
    """Yield blocks that end with a line, so that no bytes are copied to join lines.

    Very long lines are split.
    """
    block, length, end = b"", 0, os.fstat(stream.fileno()).st_size
    while len(block) == length:
        start, length = stream.tell(), size
        if start + size < end:
            stream.seek(start + size)
            length += len(stream.readline(_EXPECTED_LINE))
            stream.seek(start)
        block = stream.read(length)
        if block:
            yield block
