"""When each recording of a run started."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime

from frictioncli.logs.runs.discovery import natural_key
from frictioncli.logs.runs.manifest import Entry
from frictioncli.logs.samples.chunks import PlannedLog
from frictioncli.logs.samples.recording import RecordingSummary

_PAUSE = 1.0  # [s]
_TOLERATED_OVERLAP = 1.0  # [s]
_EPOCH_TIME = (1e9, 1e11)
"""A file time in this range (the years 2001 to 5138) counts from 1970. [s]"""


@dataclass(frozen=True, slots=True)
class DatedLog:
    """A log about to be read, when it started, and what the manifest says of it.

    ``payload`` is the manifest's, else what the files beside the log tell. [kg]
    """

    reading: PlannedLog
    started_at: datetime | None
    entry: Entry | None
    payload: float | None


@dataclass(frozen=True, slots=True)
class PlacedRecording:
    """A recording with its start since the run's first sample [s] and what is known of it."""

    recorded: RecordingSummary
    start: float
    started_at: datetime | None
    entry: Entry | None
    payload: float | None


@dataclass(frozen=True, slots=True)
class Timeline:
    """The recordings of a run in order; ``known`` is false where starts had to be invented."""

    placed: tuple[PlacedRecording, ...]
    known: bool
    warnings: tuple[str, ...]

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints of all recordings."""
        return tuple(sorted({joint for p in self.placed for joint in p.recorded.joints}))


def in_time_order(readings: Sequence[PlannedLog], entries: Mapping[str, Entry]) -> list[DatedLog]:
    """Return the logs of a run in the order of their starts; those without one come last, by name.

    Start and payload are the manifest's, else what the files beside a log tell. Of payloads the
    latter are taken only where they leave none unknown: unlike payloads make no pair, and an
    unknown one is unlike all others. Logs of one recording start together.

    Parameters
    ----------
    readings : sequence of PlannedLog
        The logs.
    entries : mapping of str to Entry
        File name -> row of the manifest.
    """
    listed = [entries.get(reading.log.file.path.name) for reading in readings]
    payloads = [one.payload if one is not None else None for one in listed]
    known = [
        reading.log.sidecar.payload if payload is None else payload
        for reading, payload in zip(readings, payloads, strict=True)
    ]
    if None not in known:
        payloads = known
    starts: dict[str, datetime] = {}
    for reading, entry in zip(readings, listed, strict=True):
        start, name = _start(reading, entry), reading.log.recording
        if start is not None:
            starts[name] = min(start, starts.get(name, start))
    dated = [
        DatedLog(reading, starts.get(reading.log.recording), entry, payload)
        for reading, entry, payload in zip(readings, listed, payloads, strict=True)
    ]
    return sorted(
        dated,
        key=lambda one: (
            one.started_at is None,
            one.started_at or datetime.min,
            natural_key(one.reading.log.recording),
            one.reading.begin,
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
        together = self._together(log)
        if together is not None:
            offset = log.reading.begin - together.recorded.reading.begin
            return together.start + (offset if offset > 0 else 0.0)
        told = self._told(log)
        if told is None:
            return self._end + _PAUSE
        if not self.placed or told > self._end:
            return told
        return self._end + log.reading.period

    def place(self, log: DatedLog, recorded: RecordingSummary) -> None:
        """Place the recording that was read from the next log."""
        start, told = self.start_of(log), self._told(log)
        late = told is not None and self._end - told > _TOLERATED_OVERLAP
        if self.placed and told is not None and late and self._together(log) is None:
            self._warnings.append(
                f"run {self.run}: {recorded.log.file.path.name} starts {self._end - told:.0f} s"
                f" before {self.placed[-1].recorded.log.file.path.name} ends: placed right after it"
            )
        if not self.placed:
            self._origin = log.started_at
        self.placed.append(PlacedRecording(recorded, start, log.started_at, log.entry, log.payload))
        self._end = max(self._end, start + recorded.duration)

    def timeline(self, *, has_manifest: bool) -> Timeline:
        """Return all recordings, with warnings of starts that had to be invented.

        Parameters
        ----------
        has_manifest : bool
            A manifest was found; files it does not list are then worth a warning.
        """
        recordings = {p.recorded.log.recording for p in self.placed}
        without = {p.recorded.log.recording: p for p in self.placed if p.started_at is None}
        undated = [placed.recorded.log.file.path.name for placed in without.values()]
        said = self._of_payloads()
        if undated and (has_manifest or len(undated) < len(recordings)):
            said.append(
                f"run {self.run}: no start time for {', '.join(undated)}: placed after the others"
            )
        elif len(undated) > 1:
            said.append(
                f"run {self.run}: no start times (no manifest.csv): its {len(undated)} recordings"
                " follow each other in name order, 1 s apart; effects of time and of temperature"
                " history cannot be judged"
            )
        known = not undated or len(recordings) == 1
        return Timeline(tuple(self.placed), known, (*said, *self._warnings))

    def _together(self, log: DatedLog) -> PlacedRecording | None:
        """Return the log placed last where the next is of the same recording."""
        last = self.placed[-1] if self.placed else None
        same = last is not None and last.recorded.log.recording == log.reading.log.recording
        return last if same else None

    def _of_payloads(self) -> list[str]:
        """Return warnings of payloads that files beside the logs tell and that are not taken."""
        beside = [(p.payload, p.recorded.log.sidecar.payload) for p in self.placed]
        told = [(taken, other) for taken, other in beside if other not in (None, taken)]
        if any(taken is None for taken, _ in told):
            return [
                f"run {self.run}: _PROG.TXT tells the payload of {len(told)} of"
                f" {len(self.placed)} recordings: taken for none"
            ]
        if told:
            return [
                f"run {self.run}: the manifest's payload differs from that of _PROG.TXT in"
                f" {len(told)} recordings: the manifest's is taken"
            ]
        return []

    def _told(self, log: DatedLog) -> float | None:
        """Return the start by manifest or header, since the run's first sample [s]."""
        if log.started_at is None:
            return None
        return (log.started_at - (self._origin or log.started_at)).total_seconds()


def _start(reading: PlannedLog, entry: Entry | None) -> datetime | None:
    if entry is not None:
        return entry.started_at
    if reading.log.sidecar.started_at is not None:
        return reading.log.sidecar.started_at
    if _EPOCH_TIME[0] < reading.begin < _EPOCH_TIME[1]:
        return datetime.fromtimestamp(reading.begin, UTC)
    return None
