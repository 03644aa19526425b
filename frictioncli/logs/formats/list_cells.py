"""Text logs whose cells hold lists, as scripts write the messages of ROS.

A cell such as ``[0.1, 0.2]``, ``(0.1, 0.2)``, ``[ 0.1  0.2]`` as NumPy writes it, or ``array('d',
[0.1, 0.2])`` becomes one column for each of its members. Rows with another number of members are
damaged.
"""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from frictioncli.arrays import Numbers
from frictioncli.logs.formats.delimited import DelimitedText
from frictioncli.logs.formats.delimited_rows import RowParser
from frictioncli.logs.formats.dialect import detect, split
from frictioncli.logs.formats.encoding import LineBlock, decode_head, known_encoding
from frictioncli.logs.log_source import CsvHints, RawBatch, Refusal, SequentialSource

_LIST = re.compile(r"\s*+(?:array\('\w',\s*+)?[\[(]([^\[\]()]*+)[\])]\)?\s*+")
_TYPE = re.compile(rb"array\('\w', ?")
_WITHIN = re.compile(rb"\[[^\[\]\n]*+\]")
_BLANKS = re.compile(rb"(?<=[\d.]) ++(?=[-+.\d])")
"""Blanks between numbers, which separate the members of a list without commas."""
_MARKS = b"[]()\"'"
_DELIMITERS = (";", "\t", ",")
_INSPECTED_LINES, _SHOWN = 20, 40


def read_list_cells(path: Path, head: bytes, hints: CsvHints) -> "ListCells | Refusal | None":
    """Open a text log with lists in cells; None where no cell holds one."""
    rows_of_head = head.partition(b"\n")[2]
    if b"[" not in rows_of_head and b"(" not in rows_of_head:
        return None
    encoding = known_encoding(head, hints.encoding)
    if encoding is None:
        return None
    lines = decode_head(head, encoding).splitlines()[:_INSPECTED_LINES]
    above = next((number for number, line in enumerate(lines) if line.strip()), None)
    if above is None:
        return None
    delimiters = _DELIMITERS if hints.delimiter is None else (hints.delimiter,)
    delimiter = max(delimiters, key=lambda sign: len(split(lines[above], sign)))
    names = [name.strip() for name in split(lines[above], delimiter)]
    rows = [split(line, delimiter) for line in lines[above + 1 : -1]]
    # a single row, the first one too, may be damaged: the commonest form is that of the log
    forms = Counter(_form(row) for row in rows if len(row) == len(names))
    if len(names) < 2 or not forms:
        return None
    form, count = forms.most_common(1)[0]
    if all(members is None for members in form):
        return None
    if 2 * count <= len(rows):
        # a list among columns of numbers may be of anything
        return _refuse_unequal(names, forms) if isinstance(detect(lines, hints), Refusal) else None
    flat = [delimiter.join(_flat_names(names, form))]
    flat += [_flat(line.encode(), delimiter.encode()).decode() for line in lines[above + 1 :]]
    dialect = detect([""] * above + flat, replace(hints, delimiter=delimiter))
    if isinstance(dialect, Refusal):
        return None if hints.delimiter is None else dialect
    example = next(row for row in rows if len(row) == len(names) and _form(row) == form)
    return ListCells(DelimitedText(path, encoding, dialect, b""), _texts_in(example))


@dataclass(frozen=True, slots=True)
class ListCells(SequentialSource):
    """A log with lists in cells.

    Attributes
    ----------
    text : DelimitedText
        The log, with a column for each member of a list.
    labels : tuple of str
        Members of the first list of texts, as the names of joints.
    """

    text: DelimitedText
    labels: tuple[str, ...] = ()

    @property
    def path(self) -> Path:
        """The file."""
        return self.text.path

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the fields; those of a list are followed by the number of the member, from 0."""
        return self.text.columns

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"{self.text.form}, lists in cells"

    @property
    def notes(self) -> tuple[str, ...]:
        """Which names the log gives the members of its lists."""
        named = [f"{number} is {label}" for number, label in enumerate(self.labels, 1)]
        return (f"of the lists in cells, number {', '.join(named)}",) if named else ()

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        wanted, parser = sorted(columns), RowParser(self.text.dialect)
        for block in self.text.row_blocks(size):
            content = _flat(block.content, self.text.dialect.delimiter.encode())
            batch = parser.parse(LineBlock(block.first_line, block.n_lines, content), wanted)
            if len(batch.lines) or len(batch.bad_lines):
                yield batch

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending."""
        return self.text.texts(lines, size)


def _form(row: Sequence[str]) -> tuple[int | None, ...]:
    """Return for each cell of a row the number of members of its list; None where it is none."""
    lists = (_LIST.fullmatch(cell) for cell in row)
    return tuple(None if found is None else _members(found[0]) for found in lists)


def _members(cell: str) -> int:
    """Return how many members a list in a cell has."""
    found = _LIST.fullmatch(_with_commas(cell.encode()).decode())
    return 0 if found is None else found[1].count(",") + 1


def _with_commas(content: bytes) -> bytes:
    """Return rows whose lists have commas between the numbers."""
    return _WITHIN.sub(lambda found: _BLANKS.sub(b",", found[0]), content)


def _refuse_unequal(names: Sequence[str], forms: Counter[tuple[int | None, ...]]) -> Refusal | None:
    """Return the refusal of lists without a usual length; None where no column has lists only."""
    for name, lengths in zip(names, zip(*forms.elements(), strict=True), strict=True):
        different = sorted({members for members in lengths if members is not None})
        if len(different) > 1 and None not in lengths:
            return Refusal(
                "wrong_field_count",
                f"the lists in {name[:_SHOWN]} have {different[0]} to {different[-1]} members;"
                " expected as many in every row, one for each joint",
            )
    return None


def _flat_names(names: Sequence[str], form: Sequence[int | None]) -> Iterator[str]:
    for name, members in zip(names, form, strict=True):
        at = next((i for i, sign in enumerate(name) if sign in " [("), len(name))
        numbered = (f"{name[:at]}_{i}{name[at:]}" for i in range(members or 0))
        yield from [name] if members is None else numbered


def _flat(content: bytes, delimiter: bytes) -> bytes:
    """Return rows with the members of lists as fields of their own."""
    plain = _with_commas(_TYPE.sub(b"", content)).translate(None, _MARKS).replace(b", ", b",")
    return plain if delimiter == b"," else plain.replace(b",", delimiter)


def _texts_in(row: Sequence[str]) -> tuple[str, ...]:
    """Return the members of the first list of quoted texts in a row."""
    for cell in row:
        found = _LIST.fullmatch(cell)
        if found is not None and "'" in found[1]:
            return tuple(member.strip().strip("'") for member in found[1].split(","))
    return ()
