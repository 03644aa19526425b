"""Program file ``_PROG.TXT`` of a KUKA controller: the motions that ran during a trace."""

import math
import re
from bisect import bisect_right
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

_LONGEST = 1 << 24  # [byte]
_LINE = re.compile(r"^\s*([A-Z][A-Z0-9 /]*):(.*)$")
_DATE = re.compile(r"^(\d\d)-(\d\d)-(\d{4})$")
_CLOCK = re.compile(r"^(\d\d):(\d\d):(\d\d)$")
_MASS = re.compile(r"\{\s*m\s+([^\s,}]+)")
_SPEED = re.compile(r"\b[ae]\d\s+([^\s,}]+)")
_SAME_MASS = 1e-6  # [kg]


@dataclass(frozen=True, slots=True)
class ProgramMotion:
    """One motion of a program.

    Attributes
    ----------
    kind : str
        Kind of motion: ``PTP``, ``LIN``, ...
    start, end : float
        Times in the trace; NaN where the file does not give them. [s]
    speeds : tuple of float
        Speed of each axis as a share of its maximum. [%]
    payload : float or None
        Mass at the tool; None where not set. [kg]
    """

    kind: str
    start: float
    end: float
    speeds: tuple[float, ...]
    payload: float | None


@dataclass(frozen=True, slots=True)
class ProgramFile:
    """Contents of a program file.

    Attributes
    ----------
    path : Path
        The file.
    started_at : datetime or None
        Start of the trace; UTC.
    motions : tuple of ProgramMotion
        Motions in the order of time.
    """

    path: Path
    started_at: datetime | None
    motions: tuple[ProgramMotion, ...]

    @property
    def payload(self) -> float | None:
        """The payload of all motions; None where it is missing or differs between motions [kg]."""
        masses = [motion.payload for motion in self.motions]
        known = [mass for mass in masses if mass is not None]
        same = len(known) == len(masses) and known and max(known) - min(known) < _SAME_MASS
        return known[0] if same else None

    @property
    def payloads(self) -> tuple[tuple[float, float], ...]:
        """Start [s] and payload [kg] of each motion, where every payload is known and some differ.

        A payload holds until the next motion starts.
        """
        found = [(motion.start, motion.payload) for motion in self.motions]
        known = tuple((start, mass) for start, mass in found if mass is not None)
        return known if len(known) == len(found) and self.payload is None else ()

    def __str__(self) -> str:
        if not self.motions:
            return "names no motion"
        kinds = " and ".join(sorted({motion.kind for motion in self.motions}))
        speeds = [speed for motion in self.motions for speed in motion.speeds]
        text = f"lists {kinds} motions"
        if speeds:
            low, high = min(speeds), max(speeds)
            text += f" at {low:g}" + (f" to {high:g}" if high > low else "") + " % of axis speed"
        masses = sorted({m.payload for m in self.motions if m.payload is not None})
        if self.payload is None and masses:
            taken = "by motion" if self.payloads else "none taken"
            return f"{text}, payloads {', '.join(f'{mass:g}' for mass in masses)} kg: {taken}"
        return text + (f", payload {self.payload:g} kg" if self.payload is not None else "")


def read_program(path: Path) -> ProgramFile | None:
    """Read a program file, leaving out damaged entries.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    ProgramFile or None
        None where it is no program file.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(_LONGEST)
    except OSError:
        return None
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace")
    header: dict[str, str] = {}
    blocks: list[dict[str, str]] = []
    block: dict[str, str] | None = None
    for line in text.splitlines():
        mark = line.strip().upper()
        if mark == "#BEGINHEADER":
            block = header
        elif mark == "#BEGINMOTIONINFO":
            blocks.append({})
            block = blocks[-1]
        elif mark.startswith("#END"):
            block = None
        elif block is not None and (entry := _LINE.match(line)):
            block.setdefault(entry[1], entry[2].strip())
    if not header and not blocks:
        return None
    return ProgramFile(path, _start(header), tuple(_motions(blocks)))


def _motions(blocks: list[dict[str, str]]) -> list[ProgramMotion]:
    """Return the motions; a block with SIGNAL: END holds the end of a motion of its line."""
    motions: list[ProgramMotion] = []
    ends: dict[str, list[float]] = {}
    for block in blocks:
        if _is_end(block):
            ends.setdefault(block.get("LINE", ""), []).append(_number(block.get("TIME", "")))
    for block in blocks:
        start = _number(block.get("TIME", ""))
        if _is_end(block) or math.isnan(start):
            continue
        line_ends = ends.get(block.get("LINE", ""), [])
        after = bisect_right(line_ends, start)
        motions.append(
            ProgramMotion(
                block.get("TYPE", "unknown"),
                start,
                line_ends[after] if after < len(line_ends) else _number(block.get("ENDTIME", "")),
                _numbers(_SPEED, block.get("VELOCITIES", "")),
                next((m for m in _numbers(_MASS, block.get("LOAD", "")) if m >= 0), None),
            )
        )
    return sorted(motions, key=lambda motion: motion.start)


def _is_end(block: dict[str, str]) -> bool:
    return block.get("SIGNAL", "").upper() == "END"


def _numbers(pattern: re.Pattern[str], text: str) -> tuple[float, ...]:
    values = (_number(found) for found in pattern.findall(text))
    return tuple(value for value in values if math.isfinite(value))


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def _start(header: dict[str, str]) -> datetime | None:
    day, clock = _DATE.match(header.get("DATE", "")), _CLOCK.match(header.get("TIME", ""))
    if day is None or clock is None:
        return None
    hour, minute, second = map(int, clock.groups())
    try:
        return datetime(int(day[3]), int(day[2]), int(day[1]), hour, minute, second, tzinfo=UTC)
    except ValueError:
        return None
