"""Logs of KUKA variables: delimited text whose cells may hold a whole axis structure.

Such a cell reads ``{E6AXIS: A1 45.2, A2 -12.3}`` or ``A1 45.2 A2 -12.3`` and becomes one column
per axis. Delimiters and decimal signs may differ from row to row.
"""

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from frictioncli.logs.formats.dialect import NOT_NUMBERS
from frictioncli.logs.formats.encoding import decode_head, known_encoding
from frictioncli.logs.formats.text_rows import TextRows
from frictioncli.logs.log_source import CsvHints, Refusal

_NUMBER = r"[+-]?\d++(?:[.,]\d++)?(?:[eE][+-]?\d++)?"
_MEMBER = re.compile(rf"\b([A-Z]\d?)\s++({_NUMBER})")
_STRUCT = re.compile(
    rf"(?:\{{\s*+)?(?:(?<!\w)[A-Z]\w*+\s*+:\s*+)?"
    rf"[A-Z]\d?\s++{_NUMBER}(?:(?:\s++,?|,)\s*+[A-Z]\d?\s++{_NUMBER})++(?:\s*+\}})?"
)
_PLACEHOLDER = "\0"
_DELIMITERS = ";\t,"
_INSPECTED_LINES = 20


def read_struct_cells(path: Path, head: bytes, hints: CsvHints) -> "StructCells | Refusal | None":
    """Open a log of KUKA variables; None where no cell holds a structure."""
    encoding = known_encoding(head, hints.encoding)
    if encoding is None:
        return None
    lines = decode_head(head, encoding).splitlines()[:_INSPECTED_LINES]
    header = next((number for number, line in enumerate(lines) if line.strip()), None)
    if header is None or _STRUCT.search(lines[header]):
        return None
    rows = (
        line for line in lines[header + 1 :] if _STRUCT.search(line) and _PLACEHOLDER not in line
    )
    # a single row, the first one too, may be damaged: the commonest form is that of the log
    forms = Counter(_members(_cells(row)) for row in rows)
    if not forms:
        return None
    members = forms.most_common(1)[0][0]
    names = [name.strip().strip('"') for name in _split(lines[header])]
    if len(names) != len(members):
        return Refusal(
            "wrong_field_count",
            f"the header names {len(names)} columns but the rows have {len(members)} fields, each"
            " structure counted as one; expected as many",
        )
    return StructCells(path, encoding, header + 2, tuple(names), members)


@dataclass(frozen=True, slots=True)
class StructCells(TextRows):
    """A log of KUKA variables.

    Attributes
    ----------
    fields : tuple of str
        Names of the fields of a row.
    members : tuple of (tuple of str or None)
        For each field the names of its structure's members; None where it is a plain number.
    """

    fields: tuple[str, ...]
    members: tuple[tuple[str, ...] | None, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the fields; those of a structure are followed by the name of each member."""
        names: list[str] = []
        for field, members in zip(self.fields, self.members, strict=True):
            names += [field] if members is None else [f"{field}_{member}" for member in members]
        return tuple(names)

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"text with structures in cells, {self.encoding.upper()}"

    def row(self, text: str, columns: Sequence[int]) -> list[float] | str:
        """Return the numbers of some columns in a row, or the reason why it is rejected."""
        if _PLACEHOLDER in text:  # damaged: a NUL byte stands in place of other characters
            return "not_a_number"
        cells = _cells(text)
        flat: list[str] = []
        if len(cells) != len(self.members):
            return "wrong_field_count"
        for cell, members in zip(cells, self.members, strict=True):
            if isinstance(cell, str) and members is None:
                flat.append(cell)
            elif isinstance(cell, list) and tuple(name for name, _ in cell) == members:
                flat += [number for _, number in cell]
            else:
                return "wrong_field_count"
        try:
            return [_number(flat[column]) for column in columns]
        except ValueError:
            return "not_a_number"


def _split(text: str) -> list[str]:
    """Return the fields of a line, split at the first delimiter that occurs in it."""
    return text.split(next((sign for sign in _DELIMITERS if sign in text), ";"))


def _cells(text: str) -> list[str | list[tuple[str, str]]]:
    """Return the fields of a row without NUL: texts, or the names and numbers of a structure."""
    structures = [_MEMBER.findall(found) for found in _STRUCT.findall(text)]
    next_structure = iter(structures)
    return [
        next(next_structure) if _PLACEHOLDER in cell else cell.strip().strip('"').strip()
        for cell in _split(_STRUCT.sub(_PLACEHOLDER, text))
    ]


def _members(cells: list[str | list[tuple[str, str]]]) -> tuple[tuple[str, ...] | None, ...]:
    """Return the names of the members of each field's structure; None for a plain number."""
    return tuple(
        tuple(member for member, _ in cell) if isinstance(cell, list) else None for cell in cells
    )


def _number(cell: str) -> float:
    """Return a number, or a date as seconds since 1970; NaN for an empty cell."""
    if not cell or cell in NOT_NUMBERS:
        return math.nan
    number = cell.replace(",", ".")
    try:
        return float(number)
    except ValueError:
        moment = datetime.fromisoformat(number)
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
