"""``manifest.csv``: when each recording of a run started, and what is known of it."""

import csv
import difflib
import math
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from frictioncli.errors import MappingError
from frictioncli.logs.runs.trace_names import is_module, trace_of

NAME = "manifest.csv"
PHASES = ("heat-up", "cool-down", "sweep")
_COLUMNS = ("file", "started_at", "phase", "payload", "ambient")


@dataclass(frozen=True, slots=True)
class Entry:
    """One row of a manifest.

    Attributes
    ----------
    file : str
        File name as written.
    started_at : datetime
        Start of the recording; UTC where the manifest names no zone.
    phase : str or None
        One of ``PHASES``.
    payload : float or None
        Mass at the tool. [kg]
    ambient : float or None
        Ambient temperature. [°C]
    row : int
        Line in the manifest, from 1.
    """

    file: str
    started_at: datetime
    phase: str | None
    payload: float | None
    ambient: float | None
    row: int


def read_manifest(path: Path) -> tuple[Entry, ...]:
    """Read a manifest, delimiter ``;`` or ``,``.

    Raises
    ------
    MappingError
        If a column, date, phase or number cannot be understood, or a file is listed twice.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise MappingError(f"{path}: cannot be read ({error.strerror})") from error
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace")
    lines = text.splitlines()
    filled = [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]
    if not filled:
        raise MappingError(f"{path}: empty; expected a header 'file;started_at' and a row per file")
    delimiter = max(";,\t", key=filled[0][1].count)
    header = [
        name.strip().lower() for name in next(csv.reader([filled[0][1]], delimiter=delimiter))
    ]
    _check_header(path, header)
    entries: list[Entry] = []
    known: dict[str, int] = {}
    for row, line in filled[1:]:
        fields = [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
        cells = dict(zip(header, fields, strict=False))
        entry = _entry(path, row, cells)
        if entry.file in known:
            raise MappingError(
                f"{path} row {row}: {entry.file} is listed again (first in row"
                f" {known[entry.file]}); expected each file once"
            )
        known[entry.file] = row
        entries.append(entry)
    return tuple(entries)


def _check_header(path: Path, header: list[str]) -> None:
    for name in ("file", "started_at"):
        if name not in header:
            raise MappingError(
                f"{path} row 1: no column {name}; found {', '.join(header)}; expected"
                " file;started_at and optionally phase, payload (kg), ambient (°C)"
            )
    for name in header:
        if name and name not in _COLUMNS:
            close = difflib.get_close_matches(name, _COLUMNS, n=1)
            hint = f"; did you mean {close[0]}?" if close else ""
            raise MappingError(
                f"{path} row 1: unknown column {name}; expected {', '.join(_COLUMNS)}{hint}"
            )


def _entry(path: Path, row: int, cells: dict[str, str]) -> Entry:
    file, start, phase = cells.get("file", ""), cells.get("started_at", ""), cells.get("phase", "")
    if not file:
        raise MappingError(f"{path} row {row}: no file name; expected one in the column file")
    try:
        started_at = datetime.fromisoformat(start)
    except ValueError as error:
        raise MappingError(
            f"{path} row {row}: started_at is {start!r}; expected ISO 8601 such as"
            " 2024-05-17T09:30:00"
        ) from error
    if started_at.tzinfo is None:
        started_at = started_at.replace(tzinfo=UTC)
    if phase and phase not in PHASES:
        raise MappingError(
            f"{path} row {row}: phase is {phase!r}; expected {', '.join(PHASES)} or nothing"
        )
    return Entry(
        file,
        started_at,
        phase or None,
        _number(path, row, "payload", cells.get("payload", "")),
        _number(path, row, "ambient", cells.get("ambient", "")),
        row,
    )


def _number(path: Path, row: int, name: str, text: str) -> float | None:
    if not text:
        return None
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        unit = "kg" if name == "payload" else "°C"
        raise MappingError(f"{path} row {row}: {name} is {text!r}; expected a number in {unit}")
    return value


def match(entries: tuple[Entry, ...], names: list[str]) -> dict[str, Entry]:
    """Return file name -> entry.

    A manifest may leave the ending of a name out, name another form of the same recording, or a
    trace instead of its files.
    """
    by_name = {entry.file: entry for entry in entries}
    by_stem = {Path(entry.file).stem: entry for entry in entries}
    by_trace = {trace_of(stem): entry for stem, entry in by_stem.items()}
    found: dict[str, Entry] = {}
    for name in names:
        stem = Path(name).stem
        trace = by_trace.get(trace_of(stem)) if is_module(stem) else None
        entry = by_name.get(name) or by_name.get(stem) or by_stem.get(stem) or trace
        if entry is not None:
            found[name] = entry
    return found
