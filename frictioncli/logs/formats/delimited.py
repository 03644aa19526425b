"""Delimited text logs: CSV in all its dialects, streamed with pyarrow."""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pcsv

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.logs.formats.dates import seconds_since_1970
from frictioncli.logs.formats.dialect import NOT_NUMBERS, Dialect, detect, split
from frictioncli.logs.formats.encoding import (
    ASCII_BASED,
    Head,
    Piece,
    decode_head,
    encoding_of,
    pieces,
    rest_of,
)
from frictioncli.logs.formats.plain_numbers import plain_columns
from frictioncli.logs.log_source import CsvHints, RawBatch, ReadTask, Refusal

_TEXT_LIMIT = 200
_SMALL = 1 << 20
"""Rows that are joined where pieces end: of larger files that would cost more than it saves."""
_NULLS = ["", *NOT_NUMBERS]
_NUMBER = b"0123456789+-eE\r\n"
_NO_VALUE = 9e34
"""DIAdem writes 9.9e34 where it has no value. [any unit]"""


def read_delimited(path: Path, head: bytes, hints: CsvHints) -> "DelimitedText | Refusal | None":
    """Open a text log, or say why its text is no table; None when it is not text."""
    encoding = hints.encoding or encoding_of(head)
    if encoding is None:
        return None
    text = decode_head(head, encoding)
    if text.count("\ufffd") > 0.2 * len(text):
        return Refusal(
            "unreadable_encoding",
            f"cannot be read as {encoding}; name the encoding with [csv] encoding in --map",
        )
    # not splitlines(), which also splits where the streamed pieces do not
    lines = text.replace("\r\n", "\n").split("\n" if "\n" in text else "\r")
    if len(lines) > 2 and len(head) >= 1 << 16:
        lines.pop()  # cut off by the size of the head
    if lines and lines[0].lower().startswith("sep="):
        lines[0] = ""
    dialect = detect(lines, hints)
    if isinstance(dialect, Refusal):
        return dialect
    above = head.split(b"\n", dialect.data_line - 1)[: dialect.data_line - 1]
    return DelimitedText(path, encoding, dialect, b"".join(line + b"\n" for line in above))


@dataclass(frozen=True, slots=True)
class DelimitedText:
    """A text log whose form is known.

    ``above`` are the bytes before its first row. ``rows_bytes`` tells how many follow where they
    can be read as they stand; where that is not known the file is read piece by piece.
    """

    path: Path
    encoding: str
    dialect: Dialect
    above: bytes
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

    def like(self, path: Path, head: Head) -> "DelimitedText | None":
        """Return a file with the same header over nothing but numbers; None where it is another."""
        if self.dialect.dates or not head.content.startswith(self.above):
            return None
        rows = head.content[len(self.above) :]
        delimiter = self.dialect.delimiter.encode()
        if rows.translate(None, _NUMBER + delimiter + self.dialect.decimal.encode()):
            return None
        if rows.split(b"\n", 1)[0].count(delimiter) + 1 != len(self.columns):
            return None
        if head.plain_bytes is None or self.encoding not in ASCII_BASED:
            return replace(self, path=path, rows_bytes=None)
        return replace(self, path=path, rows_bytes=head.plain_bytes - len(self.above))

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, about ``size`` bytes of the file at a time."""
        for task in self.tasks(columns, size):
            batch = task.read()
            if len(batch.lines) or len(batch.bad_lines):
                yield batch

    def tasks(self, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order what makes the batches, each of at most about ``size`` bytes."""
        wanted = sorted(columns)
        if self.rows_bytes is not None and self.rows_bytes <= size:
            # read in the thread, too: with many small files that is much of the work
            yield ReadTask(partial(self._parse_whole, self.rows_bytes, wanted), self.rows_bytes)
            return
        for piece in self._rows(size):
            yield ReadTask(partial(self._parse, piece, wanted), len(piece.content))

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the asked lines, which must be ascending."""
        charset = "cp1252" if self.encoding == "cp1252" else "utf-8"
        position = 0
        for piece in self._rows(size):
            if position == len(lines):
                return
            content = piece.content.removesuffix(b"\n").split(b"\n")
            while position < len(lines):
                offset = int(lines[position]) - piece.first_line
                if offset >= len(content):
                    break
                text = content[offset].decode(charset, "replace").rstrip("\r")
                yield int(lines[position]), text[:_TEXT_LIMIT]
                position += 1

    def _rows(self, size: int) -> Iterator[Piece]:
        """Yield the pieces from the first row on."""
        if self.rows_bytes is not None and self.rows_bytes <= _SMALL:
            yield from self._rest(min(size, self.rows_bytes + 1))
            return
        for piece in pieces(self.path, self.encoding, size):
            skip = self.dialect.data_line - piece.first_line
            if skip <= 0:
                yield piece
                continue
            parts = piece.content.split(b"\n", skip)
            if len(parts) > skip and parts[skip]:
                yield Piece(self.dialect.data_line, piece.n_lines - skip, parts[skip])

    def _rest(self, size: int) -> Iterator[Piece]:
        """Yield the pieces of a file that can be read as it stands."""
        return rest_of(self.path, len(self.above), self.dialect.data_line, size)

    def _parse_whole(self, n_bytes: int, wanted: list[int]) -> RawBatch:
        """Parse rows of about so many bytes: one piece, or two where the last line has no end."""
        found = list(self._rest(n_bytes + 1))
        if not found:
            return _batch(None, np.empty(0, np.int64), wanted, np.empty(0, np.int64), ())
        content = found[0].content if len(found) == 1 else b"".join(one.content for one in found)
        n_lines = sum(piece.n_lines for piece in found)
        return self._parse(Piece(found[0].first_line, n_lines, content), wanted)

    def _parse(self, piece: Piece, wanted: list[int]) -> RawBatch:
        content = self._blanks_joined(piece.content)
        numbers = self._plain(content, piece.n_lines, wanted)
        if numbers is not None:
            values = dict(zip(wanted, numbers, strict=True))
            return RawBatch(piece.lines, values, np.empty(0, np.int64), ())
        table = self._table(content, self._types(wanted))
        if table is not None and table.num_rows == piece.n_lines:
            return _batch(table, piece.lines, wanted, np.empty(0, np.int64), ())
        return self._parse_carefully(content, piece.first_line, wanted)

    def _plain(self, content: bytes, n_lines: int, wanted: list[int]) -> Array | None:
        """Return the wanted columns of text that holds nothing but numbers, else None."""
        if not self.dialect.dates.isdisjoint(wanted):
            return None
        form = (self.dialect.delimiter, self.dialect.decimal, len(self.columns))
        return plain_columns(content, *form, wanted, n_lines)

    def _parse_carefully(self, content: bytes, first_line: int, wanted: list[int]) -> RawBatch:
        """Parse rows of which some are blank or damaged, and say which lines are damaged."""
        texts = content.split(b"\n")
        lines = np.array(
            [first_line + i for i, text in enumerate(texts) if text.strip(b" \r")], np.int64
        )
        texts = [text for text in texts if text.strip(b" \r")]
        right = np.array([self._has_width(text) for text in texts], bool)
        whole = [text for text, ok in zip(texts, right, strict=True) if ok]
        readable = right.copy()
        readable[right] = self._look_like_numbers(whole, wanted)
        rows = [text for text, ok in zip(texts, readable, strict=True) if ok]
        tables, parsed = self._halved(rows, self._types(wanted))
        readable[readable] = parsed
        table = pa.concat_tables(tables) if tables else None
        reasons = tuple("not_a_number" if ok else "wrong_field_count" for ok in right[~readable])
        return _batch(table, lines[readable], wanted, lines[~readable], reasons)

    def _halved(
        self, rows: list[bytes], types: dict[str, pa.DataType]
    ) -> tuple[list[pa.Table], Flags]:
        """Parse rows, halving them where some cannot be; return tables, and which rows they hold.

        An open quote joins lines, or a cell only looks like a number.
        """
        if not rows:
            return [], np.zeros(0, bool)
        # a byte order mark at the very beginning would be passed over
        table = self._table(b"\n" + b"\n".join(rows), types)
        if table is not None and table.num_rows == len(rows):
            return [table], np.ones(len(rows), bool)
        if len(rows) == 1:
            return [], np.zeros(1, bool)
        middle = len(rows) // 2
        first, good = self._halved(rows[:middle], types)
        second, also = self._halved(rows[middle:], types)
        return first + second, np.concatenate((good, also))

    def _has_width(self, text: bytes) -> bool:
        if b'"' not in text:
            count = text.count(self.dialect.delimiter.encode())
            return count + 1 == len(self.columns)
        if text.count(b'"') % 2:
            return False
        fields = split(text.decode("utf-8", "replace").strip("\r"), self.dialect.delimiter)
        return len(fields) == len(self.columns)

    def _look_like_numbers(self, rows: list[bytes], wanted: list[int]) -> Flags:
        """Tell for each row whether all wanted cells look like numbers or dates or are empty."""
        good = np.ones(len(rows), bool)
        texts = self._table(b"\n".join(rows), {str(i): pa.string() for i in wanted})
        if texts is not None and texts.num_rows == len(rows):
            for column in set(wanted) - self.dialect.dates:
                good &= self._number_cells(texts.column(str(column)))
        return good

    def _number_cells(self, cells: pa.ChunkedArray) -> Flags:
        decimal = re.escape(self.dialect.decimal)
        number = rf"^\s*([+-]?inf|[+-]?(\d+({decimal}\d*)?|{decimal}\d+)([eE][+-]?\d+)?)\s*$"
        is_null = pc.is_in(cells, value_set=pa.array(_NULLS))
        is_number = pc.match_substring_regex(cells, number)
        return np.asarray(pc.or_(is_null, is_number).to_numpy(), bool)

    def _types(self, wanted: list[int]) -> dict[str, pa.DataType]:
        dates = self.dialect.dates
        return {str(i): pa.string() if i in dates else pa.float64() for i in wanted}

    def _table(self, content: bytes, types: dict[str, pa.DataType]) -> pa.Table | None:
        """Return the columns of the given types, or None where pyarrow refuses a row."""
        if not content:
            return None
        try:
            return pcsv.read_csv(
                pa.BufferReader(content),
                read_options=pcsv.ReadOptions(
                    column_names=[str(i) for i in range(len(self.columns))],
                    # one block, so that columns are in one part; tasks run in threads already
                    block_size=len(content) + 1,
                    use_threads=False,
                ),
                parse_options=pcsv.ParseOptions(
                    delimiter=self.dialect.delimiter,
                    # looking for quotes takes a tenth of the time
                    quote_char='"' if b'"' in content else False,
                ),
                convert_options=pcsv.ConvertOptions(
                    column_types=types,
                    include_columns=list(types),
                    decimal_point=self.dialect.decimal,
                    null_values=_NULLS,
                    check_utf8=False,
                ),
            )
        except pa.ArrowInvalid:
            return None

    def _blanks_joined(self, content: bytes) -> bytes:
        if self.dialect.delimiter != " ":
            return content
        return re.sub(rb"(?m)^ | (?=\r?$)", b"", re.sub(rb"[ \t]+", b" ", content))


def _batch(
    table: pa.Table | None,
    lines: Numbers,
    wanted: list[int],
    bad_lines: Numbers,
    reasons: tuple[str, ...],
) -> RawBatch:
    values: dict[int, Array] = {}
    for column in wanted:
        if table is None:
            values[column] = np.empty(0)
            continue
        cells = table.column(str(column))
        if pa.types.is_string(cells.type):
            values[column] = seconds_since_1970(cells.to_pylist())
            continue
        values[column] = _with_value(cells.to_numpy())
    return RawBatch(lines, values, bad_lines, reasons)


def _with_value(numbers: Array) -> Array:
    """Return numbers with NaN where one says that there is none."""
    # where one is NaN the extremes are too, and tell nothing
    if not len(numbers) or -_NO_VALUE <= numbers.min() <= numbers.max() <= _NO_VALUE:
        return numbers
    beyond = np.isfinite(numbers) & (np.abs(numbers) > _NO_VALUE)
    return np.where(beyond, np.nan, numbers)
