"""Rows of a delimited text parsed into numbers: damaged rows are found and named."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pcsv

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.logs.formats.dialect import NOT_NUMBERS, Dialect, split
from frictioncli.logs.formats.encoding import LineBlock
from frictioncli.logs.formats.moments import seconds
from frictioncli.logs.formats.plain_numbers import plain_columns
from frictioncli.logs.log_source import RawBatch

_BLANKS = re.compile(rb"[ \t]+")
_OUTER_BLANK = re.compile(rb"(?m)^ | (?=\r?$)")
_NULLS = ["", *NOT_NUMBERS]
_BLANK_LINES = b" \r\n"
_PIECE = 1 << 18
_SHOWN = 40
_NO_VALUE = 9e34
"""DIAdem writes 9.9e34 where a value is missing. [any unit]"""


@dataclass(frozen=True, slots=True)
class RowParser:
    """Parser of the rows of a text with a known dialect.

    Three parsers are tried, the fastest first: one for text of nothing but numbers, pyarrow for
    all rows at once, and pyarrow for those rows that are left after damaged ones are removed.
    """

    dialect: Dialect

    def parse(self, block: LineBlock, wanted: list[int]) -> RawBatch:
        """Return the numbers in a block of lines, and which lines are damaged.

        Parameters
        ----------
        block : LineBlock
            Rows of the text.
        wanted : list of int
            Columns to read, ascending.
        """
        content = self._with_single_blanks(block.content)
        if content[:1] in _BLANK_LINES and not content.strip(_BLANK_LINES):
            return raw_batch(None, np.empty(0, np.int64), wanted, np.empty(0, np.int64), ())
        numbers = self._plain_numbers(content, block.n_lines, wanted)
        if numbers is not None:
            values = dict(zip(wanted, numbers, strict=True))
            return RawBatch(block.lines, values, np.empty(0, np.int64), ())
        table = self._table(content, self._types(wanted))
        if table is not None and table.num_rows == block.n_lines:
            nothing = np.empty(0, np.int64)
            return raw_batch(table, block.lines, wanted, nothing, (), self.dialect)
        line, parts = block.first_line, []
        for piece in _pieces(content):
            parts.append(self._parse_damaged(piece, line, wanted))
            line += piece.count(b"\n")
        return _joined(parts, wanted)

    def fault(self, text: str, wanted: Iterable[int]) -> str:
        """Return which wanted cell of a row is no number, and what was expected; "" if none is."""
        cells = split(text, self.dialect.delimiter)
        if len(cells) != len(self.dialect.columns):
            return ""
        # other sources add columns, which stand in no cell
        known = set(range(len(cells))).difference(self.dialect.texts)
        for column in sorted(known.intersection(wanted)):
            if not self._are_numbers(pa.chunked_array([[cells[column]]], pa.string())).all():
                sign = {".": "point", ",": "comma"}[self.dialect.decimal]
                example = f"-1234{self.dialect.decimal}5"
                return (
                    f"{self.dialect.columns[column] or f'column {column + 1}'} is"
                    f" {cells[column][:_SHOWN]!r}; expected a number with decimal {sign}, such as"
                    f" {example}, or an empty cell"
                )
        return ""

    def texts(self, content: bytes, column: int) -> list[str]:
        """Return the different texts in a column of some rows, in the order of appearance."""
        content = self._with_single_blanks(content)
        table = self._table(content, {str(column): pa.binary()})
        if table is None:
            rows = (
                split(text.decode("utf-8", "replace"), self.dialect.delimiter)
                for text in content.split(b"\n")
            )
            width = len(self.dialect.columns)
            return list(
                dict.fromkeys(row[column] for row in rows if len(row) == width and row[column])
            )
        cells = pc.unique(table.column(str(column))).to_pylist()
        return [cell.decode("utf-8", "replace") for cell in cells if cell]

    def _plain_numbers(self, content: bytes, n_lines: int, wanted: list[int]) -> Array | None:
        """Return the wanted columns of text that holds nothing but numbers, else None."""
        if not self.dialect.texts.isdisjoint(wanted):
            return None
        form = (self.dialect.delimiter, self.dialect.decimal, len(self.dialect.columns))
        return plain_columns(content, *form, wanted, n_lines)

    def _parse_damaged(self, content: bytes, first_line: int, wanted: list[int]) -> RawBatch:
        """Parse rows of which some are blank or damaged, and give a reason for each damaged one."""
        texts = content.split(b"\n")
        lines = np.array(
            [first_line + i for i, text in enumerate(texts) if text.strip(b" \r")], np.int64
        )
        texts = [text for text in texts if text.strip(b" \r")]
        delimiter, delimiters = self.dialect.delimiter.encode(), len(self.dialect.columns) - 1
        has_width = np.array(
            [
                self._has_width(text) if b'"' in text else text.count(delimiter) == delimiters
                for text in texts
            ],
            bool,
        )
        right_width = [text for text, ok in zip(texts, has_width, strict=True) if ok]
        readable = has_width.copy()
        readable[has_width] = self._look_like_numbers(right_width, wanted)
        rows = [text for text, ok in zip(texts, readable, strict=True) if ok]
        tables, parsed = self._bisected(rows, self._types(wanted))
        readable[readable] = parsed
        table = pa.concat_tables(tables) if tables else None
        reasons = tuple(
            "not_a_number" if ok else "wrong_field_count" for ok in has_width[~readable]
        )
        bad = lines[~readable]
        return raw_batch(table, lines[readable], wanted, bad, reasons, self.dialect)

    def _bisected(
        self, rows: list[bytes], types: dict[str, pa.DataType]
    ) -> tuple[list[pa.Table], Flags]:
        """Parse rows, bisecting them where some fail; return tables and which rows they hold.

        Rows still fail where an open quote joins lines, or a cell only looks like a number.
        """
        if not rows:
            return [], np.zeros(0, bool)
        # without the line feed, pyarrow would skip a byte order mark at the beginning
        table = self._table(b"\n" + b"\n".join(rows), types)
        if table is not None and table.num_rows == len(rows):
            return [table], np.ones(len(rows), bool)
        if len(rows) == 1:
            return [], np.zeros(1, bool)
        middle = len(rows) // 2
        first, first_parsed = self._bisected(rows[:middle], types)
        second, second_parsed = self._bisected(rows[middle:], types)
        return first + second, np.concatenate((first_parsed, second_parsed))

    def _has_width(self, text: bytes) -> bool:
        """Return whether a row with quotes has as many fields as the header."""
        if text.count(b'"') % 2:
            return False
        fields = split(text.decode("utf-8", "replace").strip("\r"), self.dialect.delimiter)
        return len(fields) == len(self.dialect.columns)

    def _look_like_numbers(self, rows: list[bytes], wanted: list[int]) -> Flags:
        """Return for each row whether its wanted cells look like numbers or are empty or texts."""
        good = np.ones(len(rows), bool)
        texts = self._table(b"\n".join(rows), {str(i): pa.string() for i in wanted})
        if texts is not None and texts.num_rows == len(rows):
            for column in set(wanted).difference(self.dialect.texts):
                good &= self._are_numbers(texts.column(str(column)))
        return good

    def _are_numbers(self, cells: pa.ChunkedArray) -> Flags:
        decimal = re.escape(self.dialect.decimal)
        number = rf"^\s*([+-]?inf|[+-]?(\d+({decimal}\d*)?|{decimal}\d+)([eE][+-]?\d+)?)\s*$"
        is_null = pc.is_in(cells, value_set=pa.array(_NULLS))
        is_number = pc.match_substring_regex(cells, number)
        return np.asarray(pc.or_(is_null, is_number).to_numpy(), bool)

    def _types(self, wanted: list[int]) -> dict[str, pa.DataType]:
        texts = self.dialect.texts
        return {str(i): pa.binary() if i in texts else pa.float64() for i in wanted}

    def _table(self, content: bytes, types: dict[str, pa.DataType]) -> pa.Table | None:
        """Return the columns of the given types, or None where pyarrow rejects a row."""
        if not content:
            return None
        try:
            return pcsv.read_csv(
                pa.BufferReader(content),
                read_options=pcsv.ReadOptions(
                    column_names=[str(i) for i in range(len(self.dialect.columns))],
                    # one block, so that columns are contiguous; blocks are parsed in threads anyway
                    block_size=len(content) + 1,
                    use_threads=False,
                ),
                parse_options=pcsv.ParseOptions(
                    delimiter=self.dialect.delimiter,
                    # parsing quotes takes a tenth of the time
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

    def _with_single_blanks(self, content: bytes) -> bytes:
        """Return text delimited by blanks with each run of blanks and tabs as one blank."""
        if self.dialect.delimiter != " ":
            return content
        return _OUTER_BLANK.sub(b"", _BLANKS.sub(b" ", content))


def _pieces(content: bytes) -> Iterator[bytes]:
    """Yield text in pieces of whole lines: an object per line takes 20 times its memory."""
    start = 0
    while start < len(content):
        end = content.find(b"\n", start + _PIECE) + 1 or len(content)
        yield content[start:end]
        start = end


def _joined(parts: list[RawBatch], wanted: list[int]) -> RawBatch:
    """Return consecutive batches as one."""
    if len(parts) == 1:
        return parts[0]
    return RawBatch(
        np.concatenate([part.lines for part in parts]),
        {column: np.concatenate([part.values[column] for part in parts]) for column in wanted},
        np.concatenate([part.bad_lines for part in parts]),
        tuple(chain.from_iterable(part.bad_reasons for part in parts)),
    )


def raw_batch(
    table: pa.Table | None,
    lines: Numbers,
    wanted: list[int],
    bad_lines: Numbers,
    reasons: tuple[str, ...],
    dialect: Dialect | None = None,
) -> RawBatch:
    """Return a batch of parsed rows; without rows where the table is None."""
    values: dict[int, Array] = {}
    for column in wanted:
        if table is None:
            values[column] = np.empty(0)
            continue
        cells = table.column(str(column))
        if dialect is not None and pa.types.is_binary(cells.type):  # whose bytes need not be text
            values[column] = _text_values(cells, column, dialect)
            continue
        values[column] = _without_placeholders(cells.to_numpy())
    return RawBatch(lines, values, bad_lines, reasons)


def _text_values(cells: pa.ChunkedArray, column: int, dialect: Dialect) -> Array:
    """Return the numbers that the texts of a column stand for."""
    if column in dialect.dates:
        return seconds(cells, dialect.dates[column])
    names = pa.array([name.encode() for name in dialect.labels[column]], pa.binary())
    places = pc.index_in(cells, value_set=names)
    return np.asarray(pc.add(places.cast(pa.float64()), 1.0).fill_null(np.nan).to_numpy())


def _without_placeholders(numbers: Array) -> Array:
    """Return numbers with NaN in place of those that stand for a missing value."""
    # with a NaN the extremes are NaN too, and the comparison is False
    if not len(numbers) or -_NO_VALUE <= numbers.min() <= numbers.max() <= _NO_VALUE:
        return numbers
    beyond = np.isfinite(numbers) & (np.abs(numbers) > _NO_VALUE)
    return np.where(beyond, np.nan, numbers)
