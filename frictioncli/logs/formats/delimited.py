"""Delimited text logs: CSV in all its dialects, streamed in blocks of lines."""

import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from frictioncli.arrays import Numbers
from frictioncli.logs.formats.compression import STREAM_ERRORS, is_compressed
from frictioncli.logs.formats.delimited_rows import RowParser, raw_batch
from frictioncli.logs.formats.dialect import Dialect, detect, split
from frictioncli.logs.formats.encoding import (
    ASCII_BASED,
    EAST_ASIAN,
    HEAD_BYTES,
    FileHead,
    LineBlock,
    decode_head,
    known_encoding,
    line_blocks,
    line_blocks_from,
)
from frictioncli.logs.formats.moments import settled_form
from frictioncli.logs.formats.twincat_scope import scope_dialect
from frictioncli.logs.log_source import (
    MAX_ROW_TEXT,
    CsvHints,
    RawBatch,
    ReadTask,
    Refusal,
    UnreadableLog,
)

_SMALL_FILE = 1 << 20
"""Up to this size the lines at the ends of blocks are joined; in larger files that takes longer
than it saves. [byte]"""
_COMPARED_LINES, _LAST_BYTES = 60, 1 << 14
"""Of the end of a file that is looked at. [lines, byte]"""
_LABEL_BYTES = 1 << 22
_NUMBER_BYTES = b"0123456789+-eE\r\n"


def read_delimited(path: Path, head: bytes, hints: CsvHints) -> "DelimitedText | Refusal | None":
    """Open a text log, or say why the text is no table; None when it is not text."""
    encoding = known_encoding(head, hints.encoding)
    if encoding is None:
        return None
    text = decode_head(head, encoding)
    if text.count("\ufffd") > 0.2 * len(text):
        return Refusal(
            "unreadable_encoding",
            f"cannot be read as {encoding}; name the encoding with [csv] encoding in --map",
        )
    # splitlines() would also split at characters that do not end a line in the streamed blocks
    lines = text.replace("\r\n", "\n").split("\n" if "\n" in text else "\r")
    if len(lines) > 2 and len(head) >= HEAD_BYTES:
        lines.pop()  # cut off at the end of the head
    if lines and lines[0].lower().startswith("sep="):
        lines[0] = ""
    dialect = scope_dialect(lines, hints) or detect(lines, hints)
    if isinstance(dialect, Refusal):
        return dialect
    dialect = _with_settled_dates(dialect, path, encoding, lines)
    above = head.split(b"\n", dialect.data_line - 1)[: dialect.data_line - 1]
    return DelimitedText(path, encoding, dialect, b"".join(line + b"\n" for line in above))


def _with_settled_dates(
    dialect: Dialect, path: Path, encoding: str, lines: Sequence[str]
) -> Dialect:
    """Return the dialect with the order of day and month that the end of the file shows."""
    if all(form.is_certain for form in dialect.dates.values()):
        return dialect
    first, last = (
        [row for line in part if len(row := split(line, dialect.delimiter)) == len(dialect.columns)]
        for part in (lines[dialect.data_line - 1 :][:_COMPARED_LINES], _last_lines(path, encoding))
    )
    settled = {
        i: settled_form(form, [row[i] for row in first], [row[i] for row in last])
        for i, form in dialect.dates.items()
    }
    return replace(dialect, dates=settled)


def _last_lines(path: Path, encoding: str) -> list[str]:
    """Return the last whole lines of a file; none where it is compressed."""
    with suppress(*STREAM_ERRORS), path.open("rb") as stream:
        if is_compressed(stream):
            return []
        stream.seek(max(stream.seek(0, os.SEEK_END) - _LAST_BYTES, 0))
        text = decode_head(stream.read(), encoding)
        return text.splitlines()[1:][-_COMPARED_LINES:]
    return []


@dataclass(frozen=True, slots=True)
class DelimitedText:
    """A text log whose form is known.

    Attributes
    ----------
    path : Path
        The file.
    encoding : str
        A Python encoding name.
    dialect : Dialect
        Delimiter, decimal sign and columns.
    preamble : bytes
        The lines above the first row.
    rows_bytes : int or None
        Length of the rows where they can be read without decompression and decoding; None where
        that is unknown. [byte]
    """

    path: Path
    encoding: str
    dialect: Dialect
    preamble: bytes
    rows_bytes: int | None = None

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that its samples come from."""
        return (self.path,)

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names as they stand in the header."""
        return self.dialect.columns

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"{self.dialect.text}, {self.encoding.upper()}"

    @property
    def notes(self) -> tuple[str, ...]:
        """What is assumed of its dates and its characters."""
        notes = [form.note(self.columns[i]) for i, form in self.dialect.dates.items()]
        if self.encoding in EAST_ASIAN:
            notes.append(f"names of columns are read as {self.encoding.upper()}")
        return tuple(note for note in notes if note)

    def fault(self, text: str, columns: Collection[int]) -> str:
        """Return which of the columns is no number in a row, and what was expected; "" if none.

        Parameters
        ----------
        text : str
            The row.
        columns : collection of int
            The columns that are read.
        """
        return RowParser(self.dialect).fault(text, columns)

    def names_in(self, column: int, most: int) -> tuple[str, ...]:
        """Return the different texts in a column in the order of appearance; none if too many.

        Parameters
        ----------
        column : int
            A column of names; empty cells and cells in damaged rows are none.
        most : int
            Greatest number of names.
        """
        found: dict[str, None] = {}
        with suppress(UnreadableLog):  # reported when the whole log is read
            for block in self.row_blocks(_LABEL_BYTES):
                found |= dict.fromkeys(RowParser(self.dialect).texts(block.content, column))
                if len(found) > most:
                    return ()
        return tuple(found)

    def with_names(self, column: int, names: tuple[str, ...]) -> "DelimitedText":
        """Return the log with each name in a column read as its place among the names, from 1."""
        labels = {**self.dialect.labels, column: names}
        return replace(self, dialect=replace(self.dialect, labels=labels))

    def with_same_layout(self, path: Path, head: FileHead) -> "DelimitedText | None":
        """Return a file that begins with the same header and has rows of numbers only.

        Parameters
        ----------
        path : Path
            The other file.
        head : FileHead
            Its beginning.

        Returns
        -------
        DelimitedText or None
            None where the layout differs or has to be detected.
        """
        if self.dialect.texts or not head.content.startswith(self.preamble):
            return None
        rows = head.content[len(self.preamble) :]
        delimiter = self.dialect.delimiter.encode()
        if rows.translate(None, _NUMBER_BYTES + delimiter + self.dialect.decimal.encode()):
            return None
        if rows.split(b"\n", 1)[0].count(delimiter) + 1 != len(self.columns):
            return None
        if head.file_size is None or self.encoding not in ASCII_BASED:
            return replace(self, path=path, rows_bytes=None)
        return replace(self, path=path, rows_bytes=head.file_size - len(self.preamble))

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        for task in self.tasks(columns, size):
            batch = task.read()
            if len(batch.lines) or len(batch.bad_lines):
                yield batch

    def tasks(self, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order the tasks that read the batches, each of at most about ``size`` bytes."""
        wanted = sorted(columns)
        if self.rows_bytes is not None and self.rows_bytes <= size:
            # the task reads the file too: with many small files that is much of the work
            yield ReadTask(partial(self._parse_file, self.rows_bytes, wanted), self.rows_bytes)
            return
        parse = RowParser(self.dialect).parse
        for block in self.row_blocks(size):
            yield ReadTask(partial(parse, block, wanted), len(block.content))

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending."""
        charset = "cp1252" if self.encoding == "cp1252" else "utf-8"
        position = 0
        for block in self.row_blocks(size):
            if position == len(lines):
                return
            content = block.content.removesuffix(b"\n").split(b"\n")
            while position < len(lines):
                offset = int(lines[position]) - block.first_line
                if offset >= len(content):
                    break
                text = content[offset].decode(charset, "replace").rstrip("\r")
                yield int(lines[position]), text[:MAX_ROW_TEXT]
                position += 1

    def row_blocks(self, size: int) -> Iterator[LineBlock]:
        """Yield the lines from the first row on."""
        if self.rows_bytes is not None and self.rows_bytes <= _SMALL_FILE:
            yield from self._plain_blocks(min(size, self.rows_bytes + 1))
            return
        for block in line_blocks(self.path, self.encoding, size):
            skip = self.dialect.data_line - block.first_line
            if skip <= 0:
                yield block
                continue
            parts = block.content.split(b"\n", skip)
            if len(parts) > skip and parts[skip]:
                yield LineBlock(self.dialect.data_line, block.n_lines - skip, parts[skip])

    def _plain_blocks(self, size: int) -> Iterator[LineBlock]:
        """Yield the rows of a file that needs no decompression and no decoding."""
        return line_blocks_from(self.path, len(self.preamble), self.dialect.data_line, size)

    def _parse_file(self, n_bytes: int, wanted: list[int]) -> RawBatch:
        """Parse all rows at once; they come in two blocks where the last line has no line end."""
        blocks = list(self._plain_blocks(n_bytes + 1))
        if not blocks:
            return raw_batch(None, np.empty(0, np.int64), wanted, np.empty(0, np.int64), ())
        one_block = len(blocks) == 1
        content = blocks[0].content if one_block else b"".join(block.content for block in blocks)
        n_lines = sum(block.n_lines for block in blocks)
        rows = LineBlock(blocks[0].first_line, n_lines, content)
        return RowParser(self.dialect).parse(rows, wanted)
