"""Start and payload of a recording, from the files next to its log."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from frictioncli.logs.formats.diadem_header import read_header
from frictioncli.logs.formats.twincat_scope import scope_start
from frictioncli.logs.log_source import LogSource, UnreadableLog
from frictioncli.logs.runs.program_file import read_program
from frictioncli.logs.runs.trace_names import PROGRAM, trace_of

_EPOS_DATE = b"Date:;"
_PROGRAM_ENDINGS = (".TXT", ".txt")


@dataclass(frozen=True, slots=True)
class Sidecar:
    """Start and payload of a recording, from the files next to its log.

    Attributes
    ----------
    started_at : datetime or None
        Start of the recording by the DIAdem header, else by the program file; UTC.
    payload : float or None
        Mass at the tool by the program file. [kg]
    notes : tuple of str
        The file that each value comes from.
    payloads : tuple of (float, float)
        Start [s] of each motion and mass [kg] from then on, where the program file tells several.
    """

    started_at: datetime | None = None
    payload: float | None = None
    notes: tuple[str, ...] = ()
    payloads: tuple[tuple[float, float], ...] = ()


_NO_SIDECAR = Sidecar()


def read_sidecar(log: Path, names: Collection[str]) -> Sidecar:
    """Read the DIAdem header and the program file next to a log.

    The log may be the header itself. The program file is called ``<trace>_PROG.TXT``.

    Parameters
    ----------
    log : Path
        The log.
    names : collection of str
        Names of all files in its folder.
    """
    trace, header = trace_of(log.stem), f"{log.stem}.dat"
    start = _start_by_header(log.with_name(header)) if header in names else None
    files = (f"{trace}{PROGRAM}{ending}" for ending in _PROGRAM_ENDINGS)
    file = next((log.with_name(name) for name in files if name in names), None)
    if file is None or not file.is_file():
        if start is None:
            return _NO_SIDECAR
        return Sidecar(start, None, ("start time from its .dat header",))
    program = read_program(file)
    if program is None:
        notes = "start time from its .dat header", "its _PROG.TXT cannot be understood: not used"
        return Sidecar(start, None, notes[start is None :])
    if start is not None:
        note = "start time from its .dat header"
    elif program.started_at is not None:
        note = "start time from its _PROG.TXT"
    else:
        note = "its _PROG.TXT has no valid date"
    notes = note, f"its _PROG.TXT {program}"
    return Sidecar(start or program.started_at, program.payload, notes, program.payloads)


def _start_by_header(header: Path) -> datetime | None:
    try:
        found = read_header(header) if header.is_file() else None
    except UnreadableLog:
        return None
    return None if found is None else found.started_at


def recorder_start(head: bytes) -> datetime | None:
    r"""Return the start in the head of a recording by EPOS Studio, taken as UTC; None without one.

    Parameters
    ----------
    head : bytes
        The lines above the header.

    Examples
    --------
    >>> recorder_start(b"Date:;2020-07-08 21:24:28\r\nFirmware Version:;0x0120").isoformat()
    '2020-07-08T21:24:28+00:00'
    """
    if not head.startswith(_EPOS_DATE):
        return None
    text = head[len(_EPOS_DATE) :].split(b"\n", 1)[0].decode("ascii", "replace").strip()
    try:
        return datetime.fromisoformat(text).replace(tzinfo=UTC)
    except ValueError:
        return None


def with_own_text(sidecar: Sidecar, source: LogSource) -> Sidecar:
    """Return a sidecar with the log's own notes, and its start where no other is known.

    Parameters
    ----------
    sidecar : Sidecar
        What the files next to the log say.
    source : LogSource
        The log.
    """
    parts = list(parts_of(source))
    own = [note for part in parts for note in getattr(part, "notes", ())]
    sidecar = replace(sidecar, notes=(*sidecar.notes, *own)) if own else sidecar
    head = next((part.preamble for part in parts if hasattr(part, "preamble")), b"")
    start = recorder_start(head) or scope_start(head)
    if start is None or sidecar.started_at is not None:
        return sidecar
    return replace(sidecar, started_at=start, notes=(*sidecar.notes, "start time from its header"))


def parts_of(source: LogSource) -> Iterator[Any]:
    """Yield a source, and the sources to which it adds, down to the one that was read.

    Parameters
    ----------
    source : LogSource
        A log.
    """
    part: Any = source
    while part is not None:
        yield part
        part = getattr(part, "source", None)
