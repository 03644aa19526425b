"""What ``ingest`` has read: the record of all logs, facts for later stages, and a summary."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from frictioncli.errors import LogError
from frictioncli.logs.channels.channel_names import INTEGRATED
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.runs.opening import RefusedLog
from frictioncli.logs.samples.poses import Poses
from frictioncli.logs.samples.quantized_temperature import Knots
from frictioncli.logs.samples.recording import RecordingSummary
from frictioncli.logs.samples.timeline import Timeline
from frictioncli.wording import count_text

_NAMES_SHOWN = 6
_ALIKE = 3
"""Least number of remarks that are told together."""
_FEW = 0.01
"""Share of rows whose times had passed that may be damaged, or out of order."""
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_JOINT = re.compile(r"\bjoint (\d+)\b")


@dataclass(frozen=True, slots=True, kw_only=True)
class RejectedFile:
    """A file that is not used as a whole.

    Attributes
    ----------
    run, file : str
        Names of its run and of the file.
    reason, text : str
        Why it is not used: a word from a fixed list, and a sentence.
    """

    run: str
    file: str
    reason: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IngestSummary:
    """What ``ingest`` has read, kept and rejected; ``str()`` gives the text for the terminal.

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
        Sum over all recordings. [s]
    time_known : bool
        False where start times are not known and were assumed.
    notes, warnings : tuple of str
        Assumptions about the logs, and possible faults in them.
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
            f"{count_text(self.files_read, 'log')} read,"
            f" {count_text(len(self.files_rejected), 'file')} rejected;"
            f" runs: {', '.join(self.runs)}",
            f"rows: {self.rows_read:,} read, {self.rows_kept:,} kept, {rejected:,} rejected"
            + (f" ({reasons})" if reasons else ""),
            "samples: "
            + ", ".join(f"joint {joint}: {count:,}" for joint, count in self.samples.items())
            + f"; {self.duration:,.1f} s recorded",
            f"torque in {self.torque_unit} at the {self.torque_side}",
            *_rejected_lines(self.files_rejected),
            *(f"note: {note}" for note in self.notes),
            *(f"warning: {warning}" for warning in self.warnings),
        ]
        return "\n".join(lines)


@dataclass(slots=True)
class IngestedLogs:
    """Record of all logs that were read; the samples themselves are on disk.

    Attributes
    ----------
    timelines : dict of str to Timeline
        Run -> its recordings.
    knots : dict of (str, int) to tuple of Knots or None
        Run and joint -> knots of the motor temperature for each recording.
    refused : list of RefusedLog
        Files that cannot be used.
    poses : Poses
        Poses of the joints.
    notes, warnings : list of str
        What concerns whole runs.
    """

    timelines: dict[str, Timeline] = field(default_factory=dict)
    knots: dict[tuple[str, int], tuple[Knots | None, ...]] = field(default_factory=dict)
    refused: list[RefusedLog] = field(default_factory=list)
    poses: Poses = field(default_factory=Poses)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def recordings(self) -> list[RecordingSummary]:
        """All recordings, run by run, in the order of time."""
        return [placed.recording for line in self.timelines.values() for placed in line.placed]

    def facts(self) -> dict[str, Any]:
        """Return what later stages must know besides the columns of ``samples``.

        Raises
        ------
        LogError
            If the logs differ in unit or side of the torque, or in whether they have positions.
        """
        recordings = self.recordings
        named = [(f"{one.log.run.name}/{one.log.file.path.name}", one) for one in recordings]
        plans = [(name, plan) for name, one in named for plan in one.planned.plans]
        notes = ((name, text) for name, plan in plans for text in plan.notes)
        warnings = [(name, text) for name, plan in plans for text in plan.warnings]
        warnings += [(name, text) for name, one in named if (text := _set_back(one))]
        return {
            "torque_unit": _common("torque unit", ((n, plan.torque_unit) for n, plan in plans)),
            "torque_side": _common(
                "side of the torque", ((n, plan.torque_side) for n, plan in plans)
            ),
            "position": _common("position", ((n, _position_kind(plan)) for n, plan in plans)),
            **_constants(plan for _, plan in plans),
            "notes": [
                *_grouped_by_remark(notes, len(recordings)),
                *_interpolated(self.knots),
                *self.notes,
            ],
            "warnings": [*_grouped_by_remark(warnings, len(recordings)), *self.warnings],
            "poses": self.poses.facts(),
            "time_known": all(timeline.known for timeline in self.timelines.values()),
        }

    def summary(self, facts: Mapping[str, Any]) -> IngestSummary:
        """Return the summary for the user, given the result of :meth:`facts`."""
        rejected: Counter[str] = Counter()
        samples: Counter[int] = Counter()
        recordings = self.recordings
        for recording in recordings:
            rejected.update(recording.rejected)
            samples.update(dict.fromkeys(recording.joints, recording.rows_kept))
        return IngestSummary(
            runs=tuple(self.timelines),
            files_read=len(recordings),
            files_rejected=tuple(
                RejectedFile(
                    run=log.run.name,
                    file=log.file.path.name,
                    reason=log.refusal.reason,
                    text=log.refusal.text,
                )
                for log in self.refused
            ),
            rows_read=sum(r.rows_read for r in recordings),
            rows_kept=sum(r.rows_kept for r in recordings),
            rows_rejected=dict(rejected),
            samples=dict(sorted(samples.items())),
            torque_unit=facts["torque_unit"],
            torque_side=facts["torque_side"],
            duration=sum(r.duration for r in recordings),
            time_known=facts["time_known"],
            notes=tuple(facts["notes"]),
            warnings=tuple(facts["warnings"]),
        )


def _set_back(recording: RecordingSummary) -> str:
    """Return how to keep the rows that a clock that was set back costs; empty for a few rows."""
    lost = recording.rejected.get("time_not_increasing", 0)
    if lost <= _FEW * recording.rows_read:
        return ""
    return (
        f"{lost:,} rows are left out because their times had passed before, as where the clock is"
        " set back; 'frictioncli inspect' shows the line: divide the file there to keep them"
    )


def _constants(plans: Iterable[JointPlan]) -> dict[str, Any]:
    """Return the torque constant by joint, as a fact; nothing where there is none."""
    found = {str(p.channels.joint): p.constant.fact() for p in plans if p.constant is not None}
    return {"torque_constant": found} if found else {}


def _position_kind(plan: JointPlan) -> str:
    """Return whether a log has its position or it was integrated from velocity."""
    return "integrated" if plan.channels.position.name == INTEGRATED else "measured"


def _common(what: str, values: Iterable[tuple[str, str]]) -> str:
    """Return the value that all logs share, given (log, value)."""
    first: dict[str, str] = {}
    for name, value in values:
        first.setdefault(value, name)
    if len(first) > 1:
        found = "; ".join(f"{value} in {name}" for value, name in first.items())
        raise LogError(
            f"the logs differ in {what}: {found}; expected the same in all: read them in separate"
            " calls, choose joints, or choose the torque column with --map"
        )
    return next(iter(first))


def _grouped_by_remark(remarks: Iterable[tuple[str, str]], total: int) -> tuple[str, ...]:
    """Return each remark once, with the number of files that it holds for.

    Parameters
    ----------
    remarks : iterable of (file, remark)
        Remarks in order.
    total : int
        Number of files; a remark that holds for all of them does not mention files.
    """
    files: dict[str, list[str]] = {}
    for file, remark in remarks:
        files.setdefault(remark, []).append(file)
    return _merged_joints(
        remark
        if len(set(names)) == total
        else f"{names[0]}: {remark}"
        if len(names) == 1
        else f"in {len(names)} files: {remark}"
        for remark, names in files.items()
    )


def _merged_joints(remarks: Iterable[str]) -> tuple[str, ...]:
    """Return remarks, of three or more that differ in their numbers alone the first for all.

    Those on what is left out, or on values of a joint, stay as they are.
    """
    alike: dict[str, list[str]] = {}
    for remark in remarks:
        own = remark.startswith("left out") or "found" in remark or "torque constant" in remark
        alike.setdefault(remark if own else _NUMBER.sub("#", remark), []).append(remark)
    return tuple(
        line
        for group in alike.values()
        for line in (group if len(group) < _ALIKE else [_with_others(group)])
    )


def _with_others(remarks: Sequence[str]) -> str:
    """Return the first of alike remarks, with the joints or the number of the others."""
    joints = [found[1] for one in remarks if (found := _JOINT.search(one))]
    if len(set(joints)) == len(remarks):
        return f"{remarks[0]} (joints {', '.join(joints[1:])} alike)"
    return f"{remarks[0]} (and {len(remarks) - 1} like it)"


def _interpolated(knots: Mapping[tuple[str, int], tuple[Knots | None, ...]]) -> list[str]:
    """Return a note on quantized motor temperatures for each joint and step of its register."""
    found: dict[tuple[int, float], dict[str, int]] = {}
    for (run, joint), of_run in knots.items():
        distinct = {id(one): one for one in of_run if one is not None}.values()
        if distinct:
            steps = found.setdefault((joint, next(iter(distinct)).step), {})
            steps[run] = sum(one.n_changes for one in distinct)
    texts = []
    for (joint, step), counts in found.items():
        low, high = min(counts.values()), max(counts.values())
        between = f"{low}" if low == high else f"{low} to {high}"
        where = f"run {next(iter(counts))}" if len(counts) == 1 else f"each of {len(counts)} runs"
        texts.append(
            f"motor temperature of joint {joint} has steps of {step:g} °C: interpolated between"
            f" {between} of them in {where}"
        )
    return texts


def _rejected_lines(files: Sequence[RejectedFile]) -> list[str]:
    """Return a line per reason and text, with the files that it holds for."""
    groups: dict[tuple[str, str], list[str]] = {}
    for file in files:
        groups.setdefault((file.reason, file.text), []).append(file.file)
    return [
        f"rejected, {reason}: {_first_names(names)}: {text}"
        for (reason, text), names in groups.items()
    ]


def _first_names(names: Sequence[str]) -> str:
    shown = ", ".join(names[:_NAMES_SHOWN])
    return shown + (f" and {len(names) - _NAMES_SHOWN} more" if len(names) > _NAMES_SHOWN else "")
