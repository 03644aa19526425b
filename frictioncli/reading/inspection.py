"""What logs hold, without writing anything: form, channels, units, rate, gaps, faults."""

import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa

from frictioncli.reading import aliases as names
from frictioncli.reading.beliefs import JointPlan
from frictioncli.reading.channels import Channel
from frictioncli.reading.derivative import max_gap
from frictioncli.reading.discovery import discover
from frictioncli.reading.formats.base import Refusal
from frictioncli.reading.mapping import ChannelMap, read_map
from frictioncli.reading.opening import OpenedLog, open_run
from frictioncli.reading.planning import planned
from frictioncli.reading.recording import Recorded, read_recording
from frictioncli.reading.rows import REASONS
from frictioncli.reading.settings import IngestSettings


@dataclass(frozen=True, slots=True)
class ChannelReport:
    """A column that is read: what it is, the unit its header says and the unit believed."""

    joint: int
    quantity: str
    column: str
    unit_found: str
    unit_believed: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FileReport:
    """What a file holds; ``str()`` is the text for the terminal.

    Attributes
    ----------
    path : Path
        The file.
    form : str
        Its format; "" where it is none that is read.
    refusal : str
        Why it cannot be used; "" where it can.
    channels : tuple of ChannelReport
        The columns that are read.
    rows : int
        Rows in the file.
    faults : mapping of str to int
        Reason -> rows that cannot be used.
    period, duration : float
        Median time between samples, and time from first to last. [s]
    gaps, longest_gap : int, float
        Pauses of more than five periods, and the longest step in time. [s]
    notes : tuple of str
        What was believed against or beyond the header.
    """

    path: Path
    form: str = ""
    refusal: str = ""
    channels: tuple[ChannelReport, ...] = ()
    rows: int = 0
    faults: Mapping[str, int]
    period: float = 0.0
    duration: float = 0.0
    gaps: int = 0
    longest_gap: float = 0.0
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        if self.refusal:
            form = f"{self.form}; " if self.form else ""
            return f"{self.path}: {form}not usable: {self.refusal}"
        faults = ", ".join(f"{reason} {count}" for reason, count in sorted(self.faults.items()))
        gaps = f"{self.gaps} gaps, longest {self.longest_gap:.3g} s" if self.gaps else "no gaps"
        lines = [
            f"{self.path}: {self.form}",
            f"  {self.rows} rows in {self.duration:.3f} s, {1 / self.period:.4g} Hz, {gaps},"
            f" faults: {faults or 'none'}",
            *(
                f"  joint {c.joint} {c.quantity}: {c.column}, header says"
                f" {c.unit_found or 'nothing'}, read as {c.unit_believed}"
                for c in self.channels
            ),
            *(f"  note: {note}" for note in self.notes),
        ]
        return "\n".join(lines)


def inspect(logs: Sequence[Path], settings: IngestSettings | None = None) -> tuple[FileReport, ...]:
    """Look at logs as ``ingest`` would read them, and write nothing.

    Parameters
    ----------
    logs : sequence of Path
        Log files, or folders of them.
    settings : IngestSettings, optional
        What the user knows beyond the logs.

    Returns
    -------
    tuple of FileReport
        One per file, in the order of runs and names.

    Raises
    ------
    LogError, MappingError
        If a path does not exist, or the mapping file cannot be followed.
    """
    settings = settings or IngestSettings()
    chart = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    reports: list[FileReport] = []
    with tempfile.TemporaryDirectory(prefix="frictioncli-") as folder:
        for run in discover(logs):
            opened, refused = open_run(run, settings, chart)
            found = {
                log.file.path: FileReport(path=log.file.path, refusal=log.refusal.text, faults={})
                for log in refused
            }
            for log, plans in planned(opened, settings, chart):
                found[log.file.path] = _report(log, plans, Path(folder), settings.batch_bytes)
            reports += [found[file.path] for file in run.files]
    return tuple(reports)


def _report(
    log: OpenedLog, plans: list[JointPlan] | Refusal, folder: Path, batch_bytes: int
) -> FileReport:
    if not isinstance(plans, Refusal):
        result = read_recording(log, plans, folder / "log", batch_bytes)
        if isinstance(result, Recorded):
            return _usable(result)
        plans = result
    return FileReport(path=log.file.path, form=log.source.form, refusal=plans.text, faults={})


def _usable(recorded: Recorded) -> FileReport:
    steps = _steps(next(iter(recorded.spools.values())))
    for spool in recorded.spools.values():
        spool.unlink()
    codes = recorded.rejected[1]
    notes = [text for plan in recorded.plans for text in (*plan.notes, *plan.warnings)]
    return FileReport(
        path=recorded.log.file.path,
        form=recorded.log.source.form,
        channels=tuple(
            ChannelReport(plan.channels.joint, name, channel.name, channel.unit, belief.unit)
            for plan in recorded.plans
            for name, belief in plan.beliefs.items()
            if isinstance(channel := getattr(plan.channels, name), Channel)
        ),
        rows=recorded.rows_read,
        faults=dict(Counter(REASONS[code] for code in codes)),
        period=recorded.period,
        duration=recorded.duration,
        gaps=int(np.count_nonzero(steps > max_gap(recorded.period))),
        longest_gap=float(np.max(steps, initial=0.0)),
        notes=tuple(dict.fromkeys(notes)),
    )


def _steps(spool: Path) -> np.ndarray:
    with pa.OSFile(str(spool), "rb") as stream, pa.ipc.open_stream(stream) as batches:
        return np.diff(np.concatenate([b.column(names.TIME).to_numpy() for b in batches]))
