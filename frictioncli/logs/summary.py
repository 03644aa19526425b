"""What ``ingest`` did, in a few lines."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

_NAMES_SHOWN = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class RejectedFile:
    """A file that was not used as a whole."""

    run: str
    file: str
    reason: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IngestSummary:
    """What ``ingest`` read, kept and rejected; ``str()`` is the text for the terminal.

    Attributes
    ----------
    runs : tuple of str
        Runs with at least one recording.
    files_read : int
        Logs used.
    files_rejected : tuple of RejectedFile
        Files not used, with the reason.
    rows_read, rows_kept : int
        Rows of the logs used.
    rows_rejected : mapping of str to int
        Reason -> rows.
    samples : mapping of int to int
        Joint -> samples written.
    torque_unit, torque_side : str
        ``N·m`` or ``A``; ``joint`` or ``motor``.
    duration : float
        Sum over the recordings. [s]
    time_known : bool
        False where start times were invented.
    notes, warnings : tuple of str
        What was believed, and what should worry.
    """

    runs: tuple[str, ...]
    files_read: int
    files_rejected: tuple[RejectedFile, ...]
    rows_read: int
    rows_kept: int
    rows_rejected: Mapping[str, int]
    samples: Mapping[int, int]
    torque_unit: str
    torque_side: str
    duration: float
    time_known: bool
    notes: tuple[str, ...]
    warnings: tuple[str, ...]

    def __str__(self) -> str:
        rejected = sum(self.rows_rejected.values())
        reasons = ", ".join(
            f"{reason} {count:,}" for reason, count in sorted(self.rows_rejected.items())
        )
        lines = [
            f"{self.files_read} logs read, {len(self.files_rejected)} files rejected;"
            f" runs: {', '.join(self.runs)}",
            f"rows: {self.rows_read:,} read, {self.rows_kept:,} kept, {rejected:,} rejected"
            + (f" ({reasons})" if reasons else ""),
            "samples: "
            + ", ".join(f"joint {joint}: {count:,}" for joint, count in self.samples.items())
            + f"; {self.duration:,.1f} s of motion logs",
            f"torque in {self.torque_unit} at the {self.torque_side}",
            *_rejected_lines(self.files_rejected),
            *(f"note: {note}" for note in self.notes),
            *(f"warning: {warning}" for warning in self.warnings),
        ]
        return "\n".join(lines)


def _rejected_lines(files: Sequence[RejectedFile]) -> list[str]:
    return [
        f"rejected, {reason}: {names}: {text}"
        for (reason, text), names in _by_text(((f.reason, f.text), f.file) for f in files).items()
    ]


def _by_text(pairs: Iterable[tuple[tuple[str, str], str]]) -> dict[tuple[str, str], str]:
    groups: dict[tuple[str, str], list[str]] = {}
    for key, name in pairs:
        groups.setdefault(key, []).append(name)
    return {key: _shortened(names) for key, names in groups.items()}


def _shortened(names: Sequence[str]) -> str:
    shown = ", ".join(names[:_NAMES_SHOWN])
    return shown + (f" and {len(names) - _NAMES_SHOWN} more" if len(names) > _NAMES_SHOWN else "")


def grouped(remarks: Iterable[tuple[str, str]], total: int) -> tuple[str, ...]:
    """Return each remark once, saying in how many of the files it holds.

    Parameters
    ----------
    remarks : iterable of (file, remark)
        In order.
    total : int
        Number of files; a remark that holds in all of them needs no mention of files.
    """
    files: dict[str, list[str]] = {}
    for file, remark in remarks:
        files.setdefault(remark, []).append(file)
    return tuple(
        remark
        if len(set(names)) == total
        else f"{names[0]}: {remark}"
        if len(names) == 1
        else f"in {len(names)} files: {remark}"
        for remark, names in files.items()
    )
