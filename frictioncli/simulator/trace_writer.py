"""Trace files as of a KUKA controller, one text table per recording, and the manifest."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

from frictioncli.simulator.recording import Recording

ENCODING = "cp1252"
"""Encoding of the traces, in which the degree sign is the byte 0xB0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManifestRow:
    """A row of the manifest: one recording.

    Attributes
    ----------
    file : str
        File name.
    started_at : datetime
        Time of the first sample.
    phase : str
        ``sweep``, ``heat-up`` or ``cool-down``.
    payload : float
        Mass at the flange. [kg]
    ambient : float
        Ambient temperature. [°C]
    """

    file: str
    started_at: datetime
    phase: str
    payload: float
    ambient: float


def trace_text(recording: Recording, *, joint: int, motor_decimals: int = 0) -> str:
    """Return a recording as text of a trace of axis ``joint``, separated by ``;``."""
    header = ";".join(
        (
            "Zeit[sec]",
            f"AxisPos_Act{joint}[°]",
            f"GearTorq_Act{joint}[Nm]",
            f"Motortemperatur{joint}[°C]",
            f"Gehaeusetemperatur{joint}[°C]",
        )
    )
    columns = (
        recording.time.tolist(),
        recording.position.tolist(),
        recording.torque.tolist(),
        recording.motor_temperature.tolist(),
        recording.housing_temperature.tolist(),
    )
    form = f"%.3f;%.3f;%.2f;%.{motor_decimals}f;%.1f"
    rows = map(form.__mod__, zip(*columns, strict=True))
    return "\n".join((header, *rows, ""))


def write_trace(path: Path, recording: Recording, *, joint: int, motor_decimals: int = 0) -> None:
    """Write a recording as a trace file."""
    text = trace_text(recording, joint=joint, motor_decimals=motor_decimals)
    path.write_bytes(text.encode(ENCODING))


def manifest_text(rows: Iterable[ManifestRow]) -> str:
    """Return the text of ``manifest.csv``."""
    lines = ["file;started_at;phase;payload;ambient"]
    lines += [
        f"{row.file};{row.started_at.isoformat(timespec='milliseconds')};{row.phase};"
        f"{row.payload:g};{row.ambient:.1f}"
        for row in rows
    ]
    return "\n".join((*lines, ""))


def moment(day: datetime, seconds: float) -> datetime:
    """Return the time ``seconds`` after the start of a run, to the millisecond."""
    return day + timedelta(milliseconds=round(seconds * 1000.0))
