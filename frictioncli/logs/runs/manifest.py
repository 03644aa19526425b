"""``manifest.csv``: start, phase, payload and ambient temperature of each recording of a run."""

import csv
import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from frictioncli.errors import MappingError
from frictioncli.logs.runs.trace_names import is_module, trace_of
from frictioncli.plain_text import printable

NAME = "manifest.csv"
PHASES = ("heat-up", "cool-down", "sweep")
_COLUMNS = ("file", "started_at", "phase", "payload", "ambient")


@dataclass(frozen=True, slots=True)
class ManifestEntry:
    """One row of a manifest.

    Attributes
    ----------
    file : str
        File name as written.
    started_at : datetime
        Start of the recording; UTC where the manifest names no zone.
    phase : str or None
        Phase of the measurement, one of ``PHASES``.
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


@dataclass(frozen=True, slots=True)
class RunManifest:
    """Manifest of a run, matched to the files of the run.

    Attributes
    ----------
    entries : mapping of str to ManifestEntry
        File name -> its row.
    found : bool
        Whether there is a manifest.
    warnings : tuple of str
        Rows whose file is not in the folder.
    """

    entries: Mapping[str, ManifestEntry]
    found: bool
    warnings: tuple[str, ...] = ()


def read_run_manifest(folder: Path, names: Sequence[str]) -> RunManifest:
    """Read the manifest of a run, if there is one.

    Parameters
    ----------
    folder : Path
        Folder of the manifest.
    names : sequence of str
        Names of the run's files.

    Raises
    ------
    MappingError
        If the manifest cannot be followed.
    """
    path = folder / NAME
    if not path.is_file():
        return RunManifest({}, found=False)
    rows = read_manifest(path)
    entries = match_files(rows, names)
    present = {entry.file for entry in entries.values()}
    present |= {path.name for path in folder.iterdir() if path.is_file()}
    warnings = tuple(
        f"{path} row {row.row}: {row.file} is not a file in the folder"
        for row in rows
        if row.file not in present
    )
    return RunManifest(entries, found=True, warnings=warnings)


def read_manifest(path: Path) -> tuple[ManifestEntry, ...]:
    """Read a manifest: text with the delimiter ``;``, ``,`` or tab, and a row per file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    MappingError
        If the file, a column, date, phase or number cannot be read, or a file is listed twice.
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
    header = [name.lower() for name in _cells(path, *filled[0], delimiter)]
    _check_header(path, header)
    entries: list[ManifestEntry] = []
    known: dict[str, int] = {}
    for row, line in filled[1:]:
        cells = dict(zip(header, _cells(path, row, line, delimiter), strict=False))
        entry = _entry(path, row, cells)
        if entry.file in known:
            raise MappingError(
                f"{path} row {row}: {entry.file} is listed again (first in row"
                f" {known[entry.file]}); expected each file once"
            )
        known[entry.file] = row
        entries.append(entry)
    return tuple(entries)


def _cells(path: Path, row: int, line: str, delimiter: str) -> list[str]:
    """Return the cells of a line without blanks around them."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]
    except csv.Error as error:
        raise MappingError(
            f"{path} row {row}: {error}; expected cells of at most {csv.field_size_limit()}"
            " characters"
        ) from error


def _check_header(path: Path, header: list[str]) -> None:
    for name in ("file", "started_at"):
        if name not in header:
            raise MappingError(
                f"{path} row 1: no column {name}; found {printable(', '.join(header))}; expected"
                " file;started_at and optionally phase, payload (kg), ambient (°C)"
            )
    for name in header:
        if name and name not in _COLUMNS:
            close = difflib.get_close_matches(name[:100], _COLUMNS, n=1)
            hint = f"; did you mean {close[0]}?" if close else ""
            raise MappingError(
                f"{path} row 1: unknown column {printable(name)}; expected"
                f" {', '.join(_COLUMNS)}{hint}"
            )


def _entry(path: Path, row: int, cells: dict[str, str]) -> ManifestEntry:
    file, start, phase = cells.get("file", ""), cells.get("started_at", ""), cells.get("phase", "")
    if not file:
        raise MappingError(f"{path} row {row}: no file name; expected one in the column file")
    try:
        started_at = datetime.fromisoformat(start)
    except ValueError as error:
        raise MappingError(
            f"{path} row {row}: started_at is {printable(start)!r}; expected ISO 8601 such as"
            " 2024-05-17T09:30:00"
        ) from error
    if started_at.tzinfo is None:
        started_at = started_at.replace(tzinfo=UTC)
    if phase and phase not in PHASES:
        raise MappingError(
            f"{path} row {row}: phase is {printable(phase)!r}; expected"
            f" {', '.join(PHASES)} or nothing"
        )
    return ManifestEntry(
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
        raise MappingError(
            f"{path} row {row}: {name} is {printable(text)!r}; expected a number in {unit}"
        )
    return value


def match_files(entries: Sequence[ManifestEntry], names: Sequence[str]) -> dict[str, ManifestEntry]:
    """Return file name -> row of the manifest, for the files that the manifest lists.

    The manifest may omit the ending of a name, name another format of the same recording, or name a
    trace instead of its files.

    Parameters
    ----------
    entries : sequence of ManifestEntry
        Rows of the manifest.
    names : sequence of str
        File names.
    """
    by_name = {entry.file: entry for entry in entries}
    by_stem = {Path(entry.file).stem: entry for entry in entries}
    by_trace = {trace_of(stem): entry for stem, entry in by_stem.items()}
    found: dict[str, ManifestEntry] = {}
    for name in names:
        stem = Path(name).stem
        trace = by_trace.get(trace_of(stem)) if is_module(stem) else None
        entry = by_name.get(name) or by_name.get(stem) or by_stem.get(stem) or trace
        if entry is not None:
            found[name] = entry
    return found
