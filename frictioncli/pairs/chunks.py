"""Samples, read batch by batch, in chunks in which no move is cut.

Nothing depends on the size of the batches: the sampling period is that of a recording's first
samples, and every chunk has the neighbouring samples that its moving means need.
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
from frictioncli.pairs.moves import (
    LONGEST_MOVE,
    SMOOTHING,
    directions,
    moves,
    running_sum,
    samples_in,
)
from frictioncli.pairs.settings import SteadySettings
from frictioncli.pairs.slices import keep_freed_memory
from frictioncli.schemas import SAMPLES

Channels = dict[str, Array]

NEIGHBOURS_BEFORE = 4096
"""Samples before a chunk that it contains, to see from where the joint came."""

_CHUNK_SAMPLES = 1 << 17
"""Samples that are gathered for a chunk; fewer at the end of a recording."""

_PERIOD_SAMPLES = 1 << 14
"""Samples from whose times the sampling period is taken."""

_RAMP_MARGIN = 3
"""Samples by which ramps reach further than the moving mean."""


class SampleSource(NamedTuple):
    """Run, recording and joint that samples belong to."""

    run: str
    recording: str
    joint: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleChunk:
    """Samples of one recording and joint, with whole moves.

    Attributes
    ----------
    source : SampleSource
        Run, recording and joint.
    channels : dict of str to ndarray, shape (samples,)
        Channels by name, neighbouring samples before and behind included.
    total : ndarray, shape (samples + 1,)
        Running sum of the velocity. [deg/s]
    offset : int
        Number of the first sample in the recording, from 0.
    begin, end : int
        First and past-the-end sample of the chunk proper; the others are neighbours.
    move_start, move_stop : ndarray of int, shape (moves,)
        First and past-the-end sample of each move.
    period : float
        Sampling period of the recording. [s]
    """

    source: SampleSource
    channels: Channels
    total: Array
    offset: int
    begin: int
    end: int
    move_start: Numbers
    move_stop: Numbers
    period: float

    @property
    def standing(self) -> int:
        """Number of samples that belong to no move."""
        return self.end - self.begin - int(np.sum(self.move_stop - self.move_start))


@dataclass(slots=True)
class _Buffer:
    """Samples of a recording and joint that wait for the next chunk, with neighbours before."""

    batches: list[Channels] = field(default_factory=list)
    offset: int = 0
    begin: int = 0
    waiting: int = 0
    period: float = 0.0


def chunks(
    batches: Iterable[pa.RecordBatch], names: Sequence[str], settings: SteadySettings
) -> Iterator[SampleChunk]:
    """Yield samples in chunks with whole moves, recording by recording.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`; those of one recording stand together, those of
        one of its joints in time order.
    names : sequence of str
        Channels to read beside time and velocity.
    settings : SteadySettings
        ``min_speed`` decides what is standing.

    Yields
    ------
    SampleChunk
        Samples of one recording and joint.

    Raises
    ------
    TableError
        If a required channel has values that are no numbers.
    """
    keep_freed_memory()
    wanted = tuple(dict.fromkeys(("time", "velocity", *names)))
    recording: tuple[str, str] | None = None
    buffers: dict[SampleSource, _Buffer] = {}
    for source, channels in _by_source(batches, wanted):
        if source[:2] != recording:
            for ended, buffer in buffers.items():
                yield _next_chunk(ended, buffer, settings, ended=True)
            recording, buffers = source[:2], {}
        buffer = buffers.setdefault(source, _Buffer())
        buffer.batches.append(channels)
        buffer.waiting += len(channels["time"])
        if buffer.waiting >= _CHUNK_SAMPLES:
            yield _next_chunk(source, buffer, settings, ended=False)
    for source, buffer in buffers.items():
        yield _next_chunk(source, buffer, settings, ended=True)


def _by_source(
    batches: Iterable[pa.RecordBatch], names: Sequence[str]
) -> Iterator[tuple[SampleSource, Channels]]:
    """Yield the rows of each batch by recording and joint."""
    for batch in batches:
        channels = {name: _values(batch, name) for name in names}
        for name in SAMPLES.required:
            if name in channels and not np.isfinite(channels[name].sum()):
                raise TableError(f"samples: {name} has values that are not numbers, expected none")
        runs, recordings = (_labels(batch.column(name)) for name in ("run", "recording"))
        joints = batch.column("joint").to_numpy(zero_copy_only=False)
        codes = runs.indices.to_numpy(), recordings.indices.to_numpy()
        edge = np.ones(batch.num_rows + 1, dtype=bool)
        edge[1:-1] = (codes[0][1:] != codes[0][:-1]) | (codes[1][1:] != codes[1][:-1])
        edges = np.flatnonzero(edge)
        for start, stop in pairwise(edges.tolist()):
            labels = (
                runs.dictionary[codes[0][start]].as_py(),
                recordings.dictionary[codes[1][start]].as_py(),
            )
            joint_of_row = joints[start:stop]
            if (joint_of_row == joint_of_row[0]).all():
                rows = {name: values[start:stop] for name, values in channels.items()}
                yield SampleSource(*labels, int(joint_of_row[0])), rows
                continue
            for joint in np.unique(joint_of_row):
                index = start + np.flatnonzero(joint_of_row == joint)
                rows = {name: values[index] for name, values in channels.items()}
                yield SampleSource(*labels, int(joint)), rows


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


def _next_chunk(
    source: SampleSource, buffer: _Buffer, settings: SteadySettings, *, ended: bool
) -> SampleChunk:
    """Return the samples that hold whole moves, and leave the others in the buffer."""
    channels = {
        name: np.concatenate([batch[name] for batch in buffer.batches])
        for name in buffer.batches[0]
    }
    time = channels["time"]
    if not buffer.offset and not buffer.begin:
        steps = np.diff(time[:_PERIOD_SAMPLES])
        buffer.period = float(np.median(steps)) if len(steps) else 0.0
    half = samples_in(SMOOTHING, buffer.period)
    total = running_sum(channels["velocity"])
    direction = directions(total, half, settings)
    # behind this the moving mean may still change with samples that have not been read
    known = len(time) if ended else max(len(time) - half - _RAMP_MARGIN, buffer.begin)
    window = slice(buffer.begin, known)
    start, stop = moves(direction[window], time[window], buffer.period)
    start, stop = start + buffer.begin, stop + buffer.begin
    end = known
    if not ended and len(stop) and stop[-1] == known and stop[-1] - start[-1] < LONGEST_MOVE:
        end = int(start[-1])
        start, stop = start[:-1], stop[:-1]
    chunk = SampleChunk(
        source=source,
        channels=channels,
        total=total,
        offset=buffer.offset,
        begin=buffer.begin,
        end=end,
        move_start=start,
        move_stop=stop,
        period=buffer.period,
    )
    behind = max(end - max(NEIGHBOURS_BEFORE, 2 * (half + _RAMP_MARGIN)), 0)
    buffer.batches = [{name: values[behind:] for name, values in channels.items()}]
    buffer.offset += behind
    buffer.begin, buffer.waiting = end - behind, 0
    return chunk
