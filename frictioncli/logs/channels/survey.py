"""The first rows of logs with one layout, from which their units are inferred."""

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.log_source import LogSource, RawBatch, UnreadableLog

_MAX_FILES = 16
_MAX_ROWS = 20_000
_MIN_ROWS = 2_000
_MAX_VALUES = 4_000_000
_MAX_BAD_ROWS = 100_000
_MAX_BATCHES = 64
_BATCH_BYTES = 1 << 20
LARGEST = 1e100
"""Larger values measure nothing: their sums and squares would be infinite. [raw]"""
_LEAST_MOTION = 0.01
"""Position range above which an axis counts as moving. [raw]"""


@dataclass(frozen=True, slots=True)
class Survey:
    """Raw samples from the beginnings of several logs with one layout.

    Attributes
    ----------
    heads : tuple of dict of int to ndarray, shape (n,)
        Raw values by column, one dict per log; rows without time are left out.
    channels : tuple of LogChannel
        The recognised columns of the layout.
    position_ranges : dict of tuple to (float, float)
        What was found of positions that share a unit, kept for all joints: with many joints it
        would take most of the time of reading.
    """

    heads: tuple[dict[int, Array], ...]
    channels: tuple[LogChannel, ...]
    position_ranges: dict[tuple[int, ...], tuple[float, float]] = field(
        default_factory=dict, repr=False, compare=False
    )

    @property
    def n_rows(self) -> int:
        """Number of rows; 0 where none could be read."""
        return sum(len(next(iter(head.values()))) for head in self.heads)

    def pooled(self, channel: LogChannel) -> Array:
        """Return a channel's raw values of all logs without NaN, shape (n,)."""
        values = np.concatenate([np.empty(0), *(head[channel.column] for head in self.heads)])
        return values[np.isfinite(values)]

    def family(self, channel: LogChannel) -> list[LogChannel]:
        """Return the columns that share a channel's unit: the same name for any joint."""
        return [
            other
            for other in self.channels
            if other.meaning == channel.meaning
            and other.family == channel.family
            and other.unit == channel.unit
        ]

    def tool(self) -> list[LogChannel]:
        """Return the columns of the tool's x, y and z; empty where one is missing."""
        axes = {c.meaning.rank: c for c in self.channels if c.quantity == names.TOOL}
        return [axes[i] for i in range(3)] if len(axes) == 3 else []


def survey(
    sources: Sequence[LogSource],
    channels: Sequence[LogChannel],
    time: int,
    others: Collection[int] = (),
) -> Survey:
    """Read the beginnings of up to 16 logs with one layout, evenly spaced among them.

    Where a log begins at rest, the batches after the first are skipped until an axis moves.

    Parameters
    ----------
    sources : sequence of LogSource
        The logs.
    channels : sequence of LogChannel
        The recognised columns, the same in all logs.
    time : int
        Column of the time.
    others : collection of int, optional
        Further columns.
    """
    spaced = np.unique(np.linspace(0, len(sources) - 1, _MAX_FILES).astype(int))
    wanted = sorted({*others, *(channel.column for channel in channels)})
    positions = [channel.column for channel in channels if channel.quantity == names.POSITION]
    rows = int(np.clip(_MAX_VALUES // (len(spaced) * len(wanted)), _MIN_ROWS, _MAX_ROWS))
    heads = [_head(sources[i], wanted, positions, time, rows) for i in spaced]
    return Survey(tuple(head for head in heads if head), tuple(channels))


def _head(
    source: LogSource, wanted: list[int], positions: list[int], time: int, least_rows: int
) -> dict[int, Array]:
    kept: list[dict[int, Array]] = []
    rows = bad = 0
    has_moved = False
    for number, batch in enumerate(_readable_batches(source, wanted)):
        bad += len(batch.bad_lines)
        if bad > _MAX_BAD_ROWS:
            break
        moves = any(_moves(batch.values[column]) for column in positions)
        if kept and not moves and not has_moved:
            if number >= _MAX_BATCHES:
                break
            continue
        has_moved = has_moved or moves
        good = np.isfinite(_known(batch.values[time]))
        kept.append({column: _known(values[good]) for column, values in batch.values.items()})
        rows += int(good.sum())
        if rows >= least_rows and has_moved:
            break
    if not kept:
        return {}
    return {column: np.concatenate([part[column] for part in kept]) for column in wanted}


def _readable_batches(source: LogSource, wanted: list[int]) -> Iterator[RawBatch]:
    """Yield batches up to the end of the readable part; reading the samples reports the damage."""
    with suppress(UnreadableLog):
        yield from source.batches(wanted, _BATCH_BYTES)


def _known(values: Array) -> Array:
    """Return values, NaN for those that measure nothing."""
    if not len(values) or -LARGEST < values.min() <= values.max() < LARGEST:
        return values
    return np.where(np.abs(values) < LARGEST, values, np.nan)


def _moves(values: Array) -> bool:
    values = _known(values)
    finite = values[np.isfinite(values)]
    return bool(len(finite)) and float(np.ptp(finite)) > _LEAST_MOTION
