"""Time axis of a run: when each of its recordings started."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime

from frictioncli.logs.runs.discovery import natural_key
from frictioncli.logs.runs.manifest import ManifestEntry
from frictioncli.logs.samples.chunks import PlannedLog
from frictioncli.logs.samples.recording import RecordingSummary
from frictioncli.logs.samples.temperature_register import TemperatureRegister

_PAUSE = 1.0  # [s]
_TOLERATED_OVERLAP = 1.0  # [s]
_EPOCH_TIME = (1e9, 1e11)
"""A clock in this range (the years 2001 to 5138) counts from 1970. [s]"""


@dataclass(frozen=True, slots=True)
class DatedLog:
    """A log with its start.

    Attributes
    ----------
    planned : PlannedLog
        The log.
    started_at : datetime or None
        Start of the recording; None where it is not known.
    entry : ManifestEntry or None
        Its row of the manifest.
    payload : float or None
        Mass at the tool by the manifest, else by the sidecar files. [kg]
    payloads : tuple of (float, float)
        Start [s] of each motion and mass [kg] from then on, where they differ.
    """

    planned: PlannedLog
    started_at: datetime | None
    entry: ManifestEntry | None
    payload: float | None
    payloads: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class PlacedRecording:
    """A recording on the time axis of its run.

    Attributes
    ----------
    recording : RecordingSummary
        The recording.
    start : float
        Time of its first sample since the run's first sample. [s]
    started_at, entry, payload
        As of :class:`DatedLog`.
    """

    recording: RecordingSummary
    start: float
    started_at: datetime | None
    entry: ManifestEntry | None
    payload: float | None


@dataclass(frozen=True, slots=True)
class Timeline:
    """All recordings of a run on its time axis.

    Attributes
    ----------
    placed : tuple of PlacedRecording
        The recordings in order.
    known : bool
        False where start times are not known and were assumed.
    warnings : tuple of str
        Assumptions and contradictions.
    """

    placed: tuple[PlacedRecording, ...]
    known: bool
    warnings: tuple[str, ...]

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints of all recordings."""
        return tuple(sorted({joint for p in self.placed for joint in p.recording.joints}))

    def registers(self, joint: int) -> list[tuple[float, TemperatureRegister]]:
        """Return start [s] and motor temperature register of each recording of a joint."""
        without = TemperatureRegister()
        return [
            (placed.start, placed.recording.registers.get(joint, without))
            for placed in self.placed
            if joint in placed.recording.joints
        ]


def in_time_order(
    logs: Sequence[PlannedLog], entries: Mapping[str, ManifestEntry]
) -> list[DatedLog]:
    """Return the logs of a run in the order of their starts; those without one last, by name.

    Start and payload are the manifest's, else those of the sidecar files. Payloads of sidecar files
    are used only if all payloads are then known: recordings of different payload make no pair, and
    an unknown payload differs from every other. Logs of one recording start together.

    Parameters
    ----------
    logs : sequence of PlannedLog
        The logs.
    entries : mapping of str to ManifestEntry
        File name -> row of the manifest.
    """
    listed = [entries.get(planned.log.file.path.name) for planned in logs]
    payloads = [entry.payload if entry is not None else None for entry in listed]
    completed = [
        planned.log.sidecar.payload if payload is None else payload
        for planned, payload in zip(logs, payloads, strict=True)
    ]
    by_motion: list[tuple[tuple[float, float], ...]] = [
        planned.log.sidecar.payloads if payload is None else ()
        for planned, payload in zip(logs, completed, strict=True)
    ]
    all_known = all(
        payload is not None or motions
        for payload, motions in zip(completed, by_motion, strict=True)
    )
    if all_known:
        payloads = completed
    starts: dict[str, datetime] = {}
    for planned, entry in zip(logs, listed, strict=True):
        start, name = _start(planned, entry), planned.log.recording
        if start is not None:
            starts[name] = min(start, starts.get(name, start))
    dated = [
        DatedLog(
            planned,
            starts.get(planned.log.recording),
            entry,
            payload,
            motions if all_known else (),
        )
        for planned, entry, payload, motions in zip(logs, listed, payloads, by_motion, strict=True)
    ]
    return sorted(
        dated,
        key=lambda log: (
            log.started_at is None,
            log.started_at or datetime.min,
            natural_key(log.planned.log.recording),
            log.planned.first_time,
        ),
    )


@dataclass(slots=True)
class RunClock:
    """Places the recordings of a run on its time axis, one after the other.

    Attributes
    ----------
    run : str
        The run's name, for warnings.
    placed : list of PlacedRecording
        The recordings so far.
    """

    run: str
    placed: list[PlacedRecording] = field(default_factory=list)
    _origin: datetime | None = None
    _end: float = -_PAUSE
    _warnings: list[str] = field(default_factory=list)

    def start_of(self, log: DatedLog) -> float:
        """Return when the next recording starts, since the run's first sample [s]."""
        simultaneous = self._simultaneous(log)
        if simultaneous is not None:
            offset = log.planned.first_time - simultaneous.recording.planned.first_time
            return simultaneous.start + (offset if offset > 0 else 0.0)
        start = self._known_start(log)
        if start is None:
            return self._end + _PAUSE
        if not self.placed or start > self._end:
            return start
        return self._end + log.planned.period

    def place(self, log: DatedLog, recording: RecordingSummary) -> None:
        """Place the recording that was read from the next log."""
        start, known = self.start_of(log), self._known_start(log)
        overlaps = known is not None and self._end - known > _TOLERATED_OVERLAP
        if self.placed and known is not None and overlaps and self._simultaneous(log) is None:
            self._warnings.append(
                f"run {self.run}: {recording.log.file.path.name} starts {self._end - known:.0f} s"
                f" before {self.placed[-1].recording.log.file.path.name} ends: placed right after"
                " it"
            )
        if not self.placed:
            self._origin = log.started_at
        self.placed.append(
            PlacedRecording(recording, start, log.started_at, log.entry, log.payload)
        )
        self._end = max(self._end, start + recording.duration)

    def timeline(self, *, has_manifest: bool) -> Timeline:
        """Return all recordings, with warnings of starts that were assumed.

        Parameters
        ----------
        has_manifest : bool
            The run has a manifest; files that it does not list are then worth a warning.
        """
        recordings = {p.recording.log.recording for p in self.placed}
        without = {p.recording.log.recording: p for p in self.placed if p.started_at is None}
        undated = [placed.recording.log.file.path.name for placed in without.values()]
        warnings = self._payload_warnings()
        if undated and (has_manifest or len(undated) < len(recordings)):
            warnings.append(
                f"run {self.run}: no start time for {', '.join(undated)}: placed after the others"
            )
        elif len(undated) > 1:
            warnings.append(
                f"run {self.run}: no start times (no manifest.csv): its {len(undated)} recordings"
                " follow each other in name order, 1 s apart; effects of time and of temperature"
                " history cannot be judged"
            )
        known = not undated or len(recordings) == 1
        return Timeline(tuple(self.placed), known, (*warnings, *self._warnings))

    def _simultaneous(self, log: DatedLog) -> PlacedRecording | None:
        """Return the log placed last if the next one is of the same recording."""
        last = self.placed[-1] if self.placed else None
        same = last is not None and last.recording.log.recording == log.planned.log.recording
        return last if same else None

    def _payload_warnings(self) -> list[str]:
        """Return warnings of payloads in sidecar files that are not used."""
        payloads = [(p.payload, p.recording.log.sidecar.payload) for p in self.placed]
        unused = [(used, other) for used, other in payloads if other not in (None, used)]
        if any(used is None for used, _ in unused):
            return [
                f"run {self.run}: _PROG.TXT gives the payload of {len(unused)} of"
                f" {len(self.placed)} recordings: not used"
            ]
        if unused:
            return [
                f"run {self.run}: the manifest's payload differs from that of _PROG.TXT in"
                f" {len(unused)} recordings: the manifest's is taken"
            ]
        return []

    def _known_start(self, log: DatedLog) -> float | None:
        """Return the start by manifest or file, since the run's first sample [s]."""
        if log.started_at is None:
            return None
        return (log.started_at - (self._origin or log.started_at)).total_seconds()


def _start(planned: PlannedLog, entry: ManifestEntry | None) -> datetime | None:
    if entry is not None:
        return entry.started_at
    if planned.log.sidecar.started_at is not None:
        return planned.log.sidecar.started_at
    if _EPOCH_TIME[0] < planned.first_time < _EPOCH_TIME[1]:
        return datetime.fromtimestamp(planned.first_time, UTC)
    return None
