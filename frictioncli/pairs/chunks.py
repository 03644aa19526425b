"""Samples, batch by batch, cut into stretches in which no move is cut.

Nothing depends on how the batches were cut: the sampling period is that of a recording's first
samples, and every stretch brings the neighbours that its means need.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from frictioncli.arrays import Array, Numbers
from frictioncli.errors import TableError
from frictioncli.pairs.array_runs import keep_freed_memory
from frictioncli.pairs.moves import (
    LONGEST,
    SMOOTHING,
    directions,
    moves,
    running_sum,
    samples_in,
)
from frictioncli.pairs.settings import SteadySettings
from frictioncli.schemas import SAMPLES

Channels = dict[str, Array]

BEHIND = 4096
"""Samples before a stretch that it brings along, to see where the joint came from."""

_BLOCK = 1 << 17
"""Samples that are gathered before they are looked at; fewer at a recording's end."""

_FIRST = 1 << 14
"""Samples from whose times the sampling period is taken."""

_BEYOND = 3
"""Samples by which ramps reach further than the moving mean."""


class SampleSource(NamedTuple):
    """Where samples come from."""

    run: str
    recording: str
    joint: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Chunk:
    """Samples of one recording and joint, with whole moves.

    Attributes
    ----------
    source : SampleSource
        Run, recording and joint.
    channels : dict of str to ndarray, shape (samples,)
        Channels by name, neighbours before and behind included.
    total : ndarray, shape (samples + 1,)
        Running sum of the velocity. [deg/s]
    number : int
        Which sample of the recording the first one is, from 0.
    begin, end : int
        First and past-the-end sample of what the stretch stands for; the rest are neighbours.
    first, last : ndarray of int, shape (moves,)
        First and past-the-end sample of each move.
    period : float
        Time between the samples of the recording. [s]
    """

    source: SampleSource
    channels: Channels
    total: Array
    number: int
    begin: int
    end: int
    first: Numbers
    last: Numbers
    period: float

    @property
    def standing(self) -> int:
        """Samples that belong to no move."""
        return self.end - self.begin - int(np.sum(self.last - self.first))


@dataclass(slots=True)
class _Tail:
    """What of a recording and joint has not been looked at, with neighbours before it."""

    pieces: list[Channels] = field(default_factory=list)
    number: int = 0
    begin: int = 0
    waiting: int = 0
    period: float = 0.0


def chunks(
    batches: Iterable[pa.RecordBatch], names: Sequence[str], settings: SteadySettings
) -> Iterator[Chunk]:
    """Yield the samples in stretches with whole moves, recording by recording.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`; those of one recording stand together, those of
        one of its joints in time order.
    names : sequence of str
        Channels wanted beside time and velocity.
    settings : SteadySettings
        What is standing.
    """
    keep_freed_memory()
    wanted = tuple(dict.fromkeys(("time", "velocity", *names)))
    here: tuple[str, str] | None = None
    tails: dict[SampleSource, _Tail] = {}
    for source, channels in _pieces(batches, wanted):
        if source[:2] != here:
            for done, tail in tails.items():
                yield _cut(done, tail, settings, ended=True)
            here, tails = source[:2], {}
        tail = tails.setdefault(source, _Tail())
        tail.pieces.append(channels)
        tail.waiting += len(channels["time"])
        if tail.waiting >= _BLOCK:
            yield _cut(source, tail, settings, ended=False)
    for source, tail in tails.items():
        yield _cut(source, tail, settings, ended=True)


def _pieces(
    batches: Iterable[pa.RecordBatch], names: Sequence[str]
) -> Iterator[tuple[SampleSource, Channels]]:
    """Yield rows of one recording and joint that stand together in a batch."""
    for batch in batches:
        channels = {name: _values(batch, name) for name in names}
        for name in SAMPLES.required:
            if name in channels and not np.isfinite(channels[name].sum()):
                raise TableError(f"samples: {name} has values that are no numbers, expected none")
        runs, recordings = (_labels(batch.column(name)) for name in ("run", "recording"))
        joints = batch.column("joint").to_numpy(zero_copy_only=False)
        place = runs.indices.to_numpy(), recordings.indices.to_numpy()
        edge = np.ones(batch.num_rows + 1, dtype=bool)
        edge[1:-1] = (place[0][1:] != place[0][:-1]) | (place[1][1:] != place[1][:-1])
        edges = np.flatnonzero(edge)
        for start, stop in pairwise(edges.tolist()):
            label = (
                runs.dictionary[place[0][start]].as_py(),
                recordings.dictionary[place[1][start]].as_py(),
            )
            own = joints[start:stop]
            if (own == own[0]).all():
                part = {name: values[start:stop] for name, values in channels.items()}
                yield SampleSource(*label, int(own[0])), part
                continue
            for joint in np.unique(own):
                rows = start + np.flatnonzero(own == joint)
                part = {name: values[rows] for name, values in channels.items()}
                yield SampleSource(*label, int(joint)), part


def _labels(column: pa.Array) -> pa.DictionaryArray:
    return column if pa.types.is_dictionary(column.type) else column.dictionary_encode()


def _values(batch: pa.RecordBatch, name: str) -> Array:
    """Return a channel; NaN where it has no value, or where the table lacks it."""
    if name not in batch.schema.names:
        return np.full(batch.num_rows, np.nan)
    column = batch.column(name)
    if column.type != pa.float64():
        column = pc.cast(column, pa.float64())
    return column.to_numpy(zero_copy_only=False)


def _cut(source: SampleSource, tail: _Tail, settings: SteadySettings, *, ended: bool) -> Chunk:
    """Return what holds whole moves, and leave the rest in the tail."""
    channels = {
        name: np.concatenate([piece[name] for piece in tail.pieces]) for name in tail.pieces[0]
    }
    time = channels["time"]
    if not tail.number and not tail.begin:
        steps = np.diff(time[:_FIRST])
        tail.period = float(np.median(steps)) if len(steps) else 0.0
    half = samples_in(SMOOTHING, tail.period)
    total = running_sum(channels["velocity"])
    direction = directions(total, half, settings)
    # behind this the neighbours that would change the mean have not come yet
    known = len(time) if ended else max(len(time) - half - _BEYOND, tail.begin)
    window = slice(tail.begin, known)
    first, last = moves(direction[window], time[window], tail.period)
    first, last = first + tail.begin, last + tail.begin
    end = known
    if not ended and len(last) and last[-1] == known and last[-1] - first[-1] < LONGEST:
        end = int(first[-1])
        first, last = first[:-1], last[:-1]
    found = Chunk(
        source=source,
        channels=channels,
        total=total,
        number=tail.number,
        begin=tail.begin,
        end=end,
        first=first,
        last=last,
        period=tail.period,
    )
    behind = max(end - max(BEHIND, 2 * (half + _BEYOND)), 0)
    tail.pieces = [{name: values[behind:] for name, values in channels.items()}]
    tail.number += behind
    tail.begin, tail.waiting = end - behind, 0
    return found
