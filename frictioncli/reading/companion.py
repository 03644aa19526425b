"""What files beside a log tell of it: when it began, and the payload."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from frictioncli.reading.formats.compression import UnreadableLog
from frictioncli.reading.formats.diadem_header import read_header
from frictioncli.reading.program import read_program
from frictioncli.reading.trace_names import PROGRAM, trace_of

_PROGRAM_ENDINGS = (".TXT", ".txt")


@dataclass(frozen=True, slots=True)
class Beside:
    """What the files beside a log tell.

    Attributes
    ----------
    started_at : datetime or None
        Start of the recording, by the DIAdem header or else the programme's file; UTC.
    payload : float or None
        Mass at the tool, by the programme's file. [kg]
    notes : tuple of str
        What was taken from where.
    """

    started_at: datetime | None = None
    payload: float | None = None
    notes: tuple[str, ...] = ()


def beside(log: Path) -> Beside:
    """Return what the DIAdem header and the programme's file beside a log tell.

    The log may be the header itself. The programme's file is called ``<trace>_PROG.TXT``.
    """
    trace = trace_of(log.stem)
    start = _start_by_header(log.with_suffix(".dat"))
    files = (log.with_name(f"{trace}{PROGRAM}{ending}") for ending in _PROGRAM_ENDINGS)
    file = next((file for file in files if file.is_file()), None)
    if file is None:
        return Beside(start, None, () if start is None else ("started as its .dat header tells",))
    program = read_program(file)
    if program is None:
        said = "started as its .dat header tells", "its _PROG.TXT cannot be understood: not used"
        return Beside(start, None, said[start is None :])
    if start is not None:
        told = "started as its .dat header tells"
    elif program.started_at is not None:
        told = "started as its _PROG.TXT tells"
    else:
        told = "its _PROG.TXT has no valid date"
    return Beside(start or program.started_at, program.payload, (told, f"its _PROG.TXT {program}"))


def _start_by_header(header: Path) -> datetime | None:
    try:
        found = read_header(header) if header.is_file() else None
    except UnreadableLog:
        return None
    return None if found is None else found.started_at
