"""Logs with a JSON object in each line.

Members of objects and lists become columns: ``{"t": 0.1, "state": {"q": [1, 2]}}`` has the columns
``t``, ``state.q_0`` and ``state.q_1``, ``{"joints": [{"q": 1}]}`` has ``joint_0.q``.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from frictioncli.logs.formats.encoding import decode_head, known_encoding
from frictioncli.logs.formats.text_rows import TextRows
from frictioncli.logs.log_source import CsvHints, Refusal

_INSPECTED_LINES = 20
_MOST_COLUMNS, _DEEPEST = 10_000, 8

Place = tuple[str | int, ...]
"""Keys and numbers of members that lead to a value."""


def read_json_lines(path: Path, head: bytes, hints: CsvHints) -> "JsonLines | Refusal | None":
    """Open a log of JSON objects, one per line; None where it is of another form."""
    if not head.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{"):
        return None
    encoding = known_encoding(head, hints.encoding)
    if encoding is None:
        return None
    lines = decode_head(head, encoding).splitlines()[:_INSPECTED_LINES]
    rows = [row for line in lines if (row := _parsed(line)) is not None]
    if len(rows) < 2:
        return None
    places: dict[Place, None] = {}
    for row in rows:  # objects of several kinds may alternate
        places |= dict.fromkeys(islice(_places(row), _MOST_COLUMNS + 1))
    if len(places) > _MOST_COLUMNS:
        return Refusal(
            "format_not_read",
            f"JSON objects of more than {_MOST_COLUMNS} numbers; expected those of one sample",
        )
    return JsonLines(path, encoding, 1, tuple(places))


@dataclass(frozen=True, slots=True)
class JsonLines(TextRows):
    """A log of JSON objects.

    Attributes
    ----------
    places : tuple of tuple
        Where each column stands in an object.
    """

    places: tuple[Place, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the members, those of lists with their number from 0."""
        return tuple(map(_name, self.places))

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"JSON objects in lines, {self.encoding.upper()}"

    def row(self, text: str, columns: Sequence[int]) -> list[float] | str:
        """Return the numbers of some columns in a row, or the reason why it is rejected."""
        values = _values(text, [self.places[column] for column in columns])
        return "not_a_number" if values is None else values


def _parsed(line: str) -> dict[str, Any] | None:
    """Return the object of a line, None where it holds none."""
    try:
        row = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return row if isinstance(row, dict) else None


def _places(value: object, place: Place = ()) -> Iterator[Place]:
    """Yield where numbers and dates stand in an object."""
    members: Iterable[tuple[str | int, object]] = ()
    if len(place) < _DEEPEST and isinstance(value, dict):
        members = value.items()
    elif len(place) < _DEEPEST and isinstance(value, list):
        members = enumerate(value)
    elif place and _number(value) is not None:
        yield place
    for key, member in members:
        yield from _places(member, (*place, key))


def _name(place: Place) -> str:
    """Return the name of a column; of objects in a list as of joints, ``joint_0.q``."""
    parts: list[str] = []
    for depth, key in enumerate(place, 1):
        if isinstance(key, str):
            parts.append(key)
        else:
            list_name = parts[-1] if depth == len(place) else parts[-1].removesuffix("s")
            parts[-1] = f"{list_name}_{key}"
    return ".".join(parts)


def _values(line: str, places: list[Place]) -> list[float] | None:
    """Return the numbers of a row, NaN for those that it lacks; None where it is damaged."""
    row = _parsed(line)
    if row is None:
        return None
    found = []
    for place in places:
        value: Any = row
        try:
            for key in place:
                value = value[key]
        except (KeyError, IndexError, TypeError):
            value = None
        number = np.nan if value is None else _number(value)
        if number is None:
            return None
        found.append(number)
    return found


def _number(value: object) -> float | None:
    """Return a number, or a date as seconds since 1970; None for anything else."""
    try:
        if isinstance(value, int | float):
            return float(value)
        if not isinstance(value, str):
            return None
        moment = datetime.fromisoformat(value)
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        return None
