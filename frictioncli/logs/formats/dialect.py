"""Dialect of a delimited text: delimiter, decimal sign and header, from its first lines."""

import csv
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from frictioncli.logs.formats.moments import CLOCK, MomentForm, is_moment, moment_form
from frictioncli.logs.formats.no_table import refuse_no_table, refuse_too_short, refuse_unequal
from frictioncli.logs.log_source import CsvHints, Refusal

_DELIMITERS = (";", "\t", ",", " ")
_NAMES = {";": "';'", "\t": "tab", ",": "','", " ": "blanks"}
_POINT = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\s*")
_COMMA = re.compile(r"\s*[+-]?(\d+(,\d*)?|,\d+)([eE][+-]?\d+)?\s*")
_UNIT_CELL = re.compile(r"\s*+[\[(]?[^\s\d\[\]()]{0,6}(/s\^?[2²]?)?[\])]?\s*")
_COMMENTS = ("%", "#")
_COMMENT_MARK = re.compile(r"^\s*+[%#]++\s")
_BLANKS_BEFORE_UNIT = re.compile(r"(?<!\s)\s++(?=[\[(])")
_SAMPLE_LINES = 60
_LEAST_NUMBERS = 0.3
"""Least share of cells that are numbers in the lines of a table."""
NOT_NUMBERS = ("nan", "NaN", "NAN", "-nan", "NA", "N/A", "n/a", "null", "NULL", "None", "none", "-")


@dataclass(frozen=True, slots=True)
class Dialect:
    """Form of a text log.

    Attributes
    ----------
    delimiter : str
        One character; a blank stands for any run of blanks and tabs.
    decimal : str
        ``.`` or ``,``.
    columns : tuple of str
        Column names, one per field of a row; "" where the header has none.
    data_line : int
        Line number of the first row, from 1.
    dates : mapping of int to MomentForm
        Columns of dates or times of day.
    labels : mapping of int to tuple of str
        Columns of names, of which each stands for its place in the tuple, from 1.
    """

    delimiter: str
    decimal: str
    columns: tuple[str, ...]
    data_line: int
    dates: Mapping[int, MomentForm]
    labels: Mapping[int, tuple[str, ...]] = field(default_factory=dict)

    @property
    def texts(self) -> frozenset[int]:
        """Columns whose cells are no numbers but stand for some."""
        return frozenset((*self.dates, *self.labels))

    @property
    def text(self) -> str:
        """The form in words."""
        decimal = "comma" if self.decimal == "," else "point"
        # a date tells more than the time of day beside it
        forms = sorted(self.dates.values(), key=lambda form: form.order == CLOCK)
        texts = [form.text for form in forms if form.text][:1]
        return ", ".join((f"text, {_NAMES[self.delimiter]}, decimal {decimal}", *texts))


@dataclass(frozen=True, slots=True)
class _Candidate:
    """Delimiter and decimal sign, the number of fields, and the share of cells that are numbers.

    ``moments`` is the number of fields where date and time of day are one.
    """

    delimiter: str
    decimal: str
    width: int
    share: float
    moments: int


def split(line: str, delimiter: str) -> list[str]:
    """Return the fields of a line; none where its quotes are not balanced.

    Parameters
    ----------
    line : str
        The line without its line end.
    delimiter : str
        One character; a blank stands for any run of blanks.

    Examples
    --------
    >>> split('1,5;"a;b"', ";")
    ['1,5', 'a;b']
    """
    if delimiter == " ":
        return line.replace('"', "").split()
    try:
        return next(csv.reader([line], delimiter=delimiter), [])
    except csv.Error:
        return []


def detect(lines: Sequence[str], hints: CsvHints) -> Dialect | Refusal:
    """Detect the dialect of a text from its first lines.

    Parameters
    ----------
    lines : sequence of str
        The first lines without line ends, including blank ones.
    hints : CsvHints
        Form given by the user.

    Returns
    -------
    Dialect or Refusal
        Refused as ``too_few_rows``, ``one_column``, ``wrong_delimiter``, ``wrong_field_count`` or
        ``not_a_log``.

    Examples
    --------
    >>> dialect = detect(["Zeit;Moment", "[s];[Nm]", "0,0;1,5", "0,1;2,5"], CsvHints())
    >>> dialect.columns, dialect.decimal, dialect.data_line
    (('Zeit [s]', 'Moment [Nm]'), ',', 3)
    """
    filled = [line for line in lines if line.strip()]
    if len(filled) < 2:
        widest = max((len(split(line, d)) for line in filled for d in _DELIMITERS), default=0)
        return refuse_too_short(has_header=widest >= 2)
    best = _best_candidate(filled[1:][-_SAMPLE_LINES:], hints)
    if best.share < _LEAST_NUMBERS:
        # the last lines may be text behind good rows: look at all lines, part by part
        parts = range(1, len(filled), _SAMPLE_LINES)
        found = [_best_candidate(filled[part : part + _SAMPLE_LINES], hints) for part in parts]
        best = max(found, key=lambda candidate: candidate.share)
    if best.share < _LEAST_NUMBERS:
        return refuse_no_table(filled, None if hints.delimiter is None else _NAMES[hints.delimiter])
    start, first = _first_row(lines, best)
    header = _header(lines[:start], best)
    if isinstance(header, Refusal):
        return header
    names, data_line = header
    dates = _dates([split(line, best.delimiter) for line in lines[start : start + _SAMPLE_LINES]])
    surplus = [cell for cell in first[len(names) :] if cell.strip()]
    if names and surplus and len(names) != best.moments:
        return refuse_unequal(len(names), best.width, best.delimiter)
    for _, clock in _split_moments(dates) if surplus else ():
        names.insert(clock, "")
    columns = tuple((names + [""] * best.width)[: best.width])
    if not names:
        columns = tuple(f"column {i + 1}" for i in range(best.width))
    return Dialect(best.delimiter, best.decimal, columns, data_line, dates)


def _best_candidate(sample: Sequence[str], hints: CsvHints) -> _Candidate:
    allowed = _DELIMITERS if hints.delimiter is None else (hints.delimiter,)
    candidates = [_candidate(sample, delimiter, hints.decimal) for delimiter in allowed]
    return max(candidates, key=lambda candidate: (round(candidate.share, 2), candidate.moments))


def _candidate(sample: Sequence[str], delimiter: str, decimal: str | None) -> _Candidate:
    rows = [split(line, delimiter) for line in sample]
    width = Counter(len(row) for row in rows).most_common(1)[0][0]
    same = [row for row in rows if len(row) == width]
    cells = [cell for row in same for cell in row if cell.strip() and cell not in NOT_NUMBERS]
    share: dict[str, float] = {}
    for sign, pattern in ((".", _POINT), (",", _COMMA)):
        hits = sum(bool(pattern.fullmatch(cell) or is_moment(cell)) for cell in cells)
        share[sign] = hits / len(cells) if cells else 0.0
    if decimal is None:
        decimal = "," if share[","] > share["."] else "."
    usable = width >= 2
    usual = share[decimal] * len(same) / len(rows) if usable else 0.0
    return _Candidate(delimiter, decimal, width, usual, width - len(_split_moments(_dates(same))))


def _first_row(lines: Sequence[str], form: _Candidate) -> tuple[int, list[str]]:
    """Return the index of the first line that is mostly numbers, and its fields."""
    pattern = _COMMA if form.decimal == "," else _POINT
    for index, line in enumerate(lines):
        fields = split(line, form.delimiter) if line.strip() else []
        filled = [cell for cell in fields if cell.strip()]
        hits = sum(bool(pattern.fullmatch(cell) or is_moment(cell)) for cell in filled)
        if len(fields) == form.width and hits and hits >= _LEAST_NUMBERS * len(filled):
            return index, fields
    return len(lines), []


def _dates(rows: Sequence[Sequence[str]]) -> dict[int, MomentForm]:
    """Return the columns of dates and times of day with their forms."""
    width = len(rows[0]) if rows else 0
    same = [row for row in rows if len(row) == width]
    forms = {i: moment_form([row[i] for row in same]) for i in range(width)}
    return {i: form for i, form in forms.items() if form is not None}


def _split_moments(dates: Mapping[int, MomentForm]) -> list[tuple[int, int]]:
    """Return the neighbouring columns of a date and of its time of day."""
    return [
        (first, second)
        for (first, date), (second, clock) in pairwise(dates.items())
        if not date.has_clock and clock.order == CLOCK and second == first + 1
    ]


def _header(above: Sequence[str], form: _Candidate) -> tuple[list[str], int] | Refusal:
    """Return the column names and the line number of the first row.

    The header is the line with the most names above the first row of numbers, of equal ones the
    first, or the last where all are comments; lines between the two are damaged rows. A line of
    units may follow the header.
    """
    pattern = _COMMA if form.decimal == "," else _POINT
    lines = {
        index: _header_fields(line, form.delimiter)
        for index, line in enumerate(above)
        if line.strip()
    }
    named = {
        index: fields
        for index, fields in lines.items()
        if len(fields) >= 2 and 2 * sum(bool(pattern.fullmatch(f)) for f in fields) < len(fields)
    }
    if not named:
        return [], 1 + next((i for i, line in enumerate(above) if line.strip()), len(above))
    fitting = {index: fields for index, fields in named.items() if len(fields) <= form.width}
    if not fitting:
        closest = min(map(len, named.values()), key=lambda names: names - form.width)
        return refuse_unequal(closest, form.width, form.delimiter)
    comments = {i for i in fitting if above[i].lstrip().startswith(_COMMENTS)}
    header = max(
        fitting,
        key=lambda i: (
            len(fitting[i]),
            not _are_units(fitting[i]),
            i not in comments,
            i if i in comments else -i,
        ),
    )
    names = _of_pairs(fitting[header], lines, header)
    below = next((index for index in lines if index > header), None)
    units = lines[below] if below is not None else []
    if below is None or len(units) > len(names) or not _are_units(units):
        return names, header + 2
    padded = units + [""] * (len(names) - len(units))
    # the first column of a recorder may have a unit and no name
    if not names[0] and padded[0].strip("[]()").lower() in ("s", "ms", "us"):
        names = ["time", *names[1:]]
    paired = zip(names, padded, strict=True)
    return [f"{name} [{unit.strip('[]()')}]" if unit else name for name, unit in paired], below + 2


def _of_pairs(names: list[str], lines: Mapping[int, list[str]], header: int) -> list[str]:
    """Return the names; where they are X and Y in turns, Y has the name of the pair, above."""
    above = lines.get(max((index for index in lines if index < header), default=-1), [])
    is_pairs = len(names) > 2 and names == ["X", "Y"] * (len(names) // 2)
    if not is_pairs or len(above) > len(names) or any(above[1::2]):
        return names
    paired = [name for name in above[::2] if name] or [""]
    if len(paired) != len(names) // 2:
        return names
    return [part for i, name in enumerate(paired) for part in ("" if i else "X", name)]


def _header_fields(line: str, delimiter: str) -> list[str]:
    """Return the fields of a line without trailing empty ones."""
    if delimiter == " ":
        line = _COMMENT_MARK.sub("", line).strip()
        # "Zeit [s]" is one field, "[s] [deg]" are two
        line = line if line.startswith(("[", "(")) else _BLANKS_BEFORE_UNIT.sub("", line)
    fields = [field.strip().strip('"').strip() for field in split(line, delimiter)]
    while fields and not fields[-1]:
        fields.pop()
    return fields


def _are_units(names: Sequence[str]) -> bool:
    marks = (
        "s",
        "ms",
        "deg",
        "rad",
        "nm",
        "n·m",
        "a",
        "°c",
        "k",
        "°",
        "deg/s",
        "rad/s",
        "°/s",
        "rpm",
        "1/min",
        "u/min",
        "%",
        "ma",
        "mnm",
        "v",
        "inc",
        "us",
    )
    known = sum(name.strip("[]()").lower() in marks for name in names)
    return known >= 2 and all(_UNIT_CELL.fullmatch(name) for name in names)
