"""When each recording of a run started."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from frictioncli.reading.discovery import natural_key
from frictioncli.reading.manifest import Entry
from frictioncli.reading.recording import Recorded

_PAUSE = 1.0  # [s]
_TOLERATED_OVERLAP = 1.0  # [s]
_EPOCH_TIME = 1e9
"""A file time beyond this (the year 2001) counts from 1970. [s]"""


@dataclass(frozen=True, slots=True)
class Placed:
    """A recording with its start since the run's first sample [s] and what is known of it."""

    recorded: Recorded
    start: float
    started_at: datetime | None
    entry: Entry | None


@dataclass(frozen=True, slots=True)
class Timeline:
    """The recordings of a run in order; ``known`` is false where starts had to be invented."""

    placed: tuple[Placed, ...]
    known: bool
    warnings: tuple[str, ...]

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints of all recordings."""
        return tuple(sorted({joint for p in self.placed for joint in p.recorded.spools}))


def place(
    run: str,
    recordings: Sequence[Recorded],
    entries: Mapping[str, Entry],
    headers: Mapping[str, datetime],
    has_manifest: bool,
) -> Timeline:
    """Put the recordings of a run in order of time.

    Parameters
    ----------
    run : str
        Its name, for warnings.
    recordings : sequence of Recorded
        Those that were read.
    entries : mapping of str to Entry
        File name -> row of the manifest.
    headers : mapping of str to datetime
        File name -> start by a header of its own; the manifest goes before it.
    has_manifest : bool
        A manifest was found; files it does not list are then worth a warning.
    """
    starts = {id(r): _start(r, entries, headers) for r in recordings}
    dated = sorted(
        (r for r in recordings if starts[id(r)] is not None),
        key=lambda r: (starts[id(r)] or datetime.min, natural_key(r.log.recording)),
    )
    undated = sorted(
        (r for r in recordings if starts[id(r)] is None),
        key=lambda r: natural_key(r.log.recording),
    )
    warnings: list[str] = []
    if undated and (has_manifest or dated):
        names = ", ".join(r.log.file.path.name for r in undated)
        warnings.append(f"run {run}: no start time for {names}: placed after the others")
    elif len(undated) > 1:
        warnings.append(
            f"run {run}: no start times (no manifest.csv): its {len(undated)} recordings follow"
            " each other in name order, 1 s apart; effects of time and of temperature history"
            " cannot be judged"
        )
    placed: list[Placed] = []
    end = -_PAUSE
    origin = starts[id(dated[0])] if dated else None
    for recorded in [*dated, *undated]:
        began = starts[id(recorded)]
        start = end + _PAUSE
        if began is not None and origin is not None:
            told = (began - origin).total_seconds()
            if not placed or told > end:
                start = told
            else:
                start = end + recorded.period
                if end - told > _TOLERATED_OVERLAP:
                    warnings.append(
                        f"run {run}: {recorded.log.file.path.name} starts {end - told:.0f} s before"
                        f" {placed[-1].recorded.log.file.path.name} ends: placed right after it"
                    )
        entry = entries.get(recorded.log.file.path.name)
        placed.append(Placed(recorded, start, began, entry))
        end = start + recorded.duration
    return Timeline(tuple(placed), not undated or len(recordings) == 1, tuple(warnings))


def _start(
    recorded: Recorded, entries: Mapping[str, Entry], headers: Mapping[str, datetime]
) -> datetime | None:
    name = recorded.log.file.path.name
    if name in entries:
        return entries[name].started_at
    if name in headers:
        return headers[name]
    if recorded.begin > _EPOCH_TIME:
        return datetime.fromtimestamp(recorded.begin, UTC)
    return None
