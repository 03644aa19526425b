"""The beginnings of logs of one layout, looked at before reading: they tell the units."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.log_source import RawBatch, UnreadableLog
from frictioncli.logs.runs.opening import OpenedLog

_MAX_FILES = 16
_MAX_ROWS = 20_000
_MIN_ROWS = 2_000
_MAX_VALUES = 4_000_000
_MAX_BATCHES = 64
_BATCH_BYTES = 1 << 20
_MOVED = 0.01


@dataclass(frozen=True, slots=True)
class Survey:
    """Raw samples from the beginnings of some logs of one layout.

    Attributes
    ----------
    heads : tuple of dict of int to ndarray
        Per log: column to raw values, rows without time left out.
    channels : tuple of LogChannel
        The recognised columns of the layout.
    """

    heads: tuple[dict[int, Array], ...]
    channels: tuple[LogChannel, ...]

    def pooled(self, channel: LogChannel) -> Array:
        """Return a channel's raw values of all surveyed logs, without NaN."""
        values = np.concatenate([np.empty(0), *(head[channel.column] for head in self.heads)])
        return values[np.isfinite(values)]

    @property
    def n_rows(self) -> int:
        """Rows surveyed; 0 where none could be read."""
        return sum(len(next(iter(head.values()))) for head in self.heads)

    def family(self, channel: LogChannel) -> list[LogChannel]:
        """Return the columns that share a channel's unit: same name but for the joint number."""
        return [
            other
            for other in self.channels
            if other.meaning == channel.meaning
            and other.family == channel.family
            and other.unit == channel.unit
        ]

    def tool(self) -> list[LogChannel]:
        """Return the columns x, y, z of the tool, empty when not all three are there."""
        axes = {c.meaning.rank: c for c in self.channels if c.quantity == names.TOOL}
        return [axes[i] for i in range(3)] if len(axes) == 3 else []


def survey(logs: Sequence[OpenedLog]) -> Survey:
    """Read the beginnings of up to 16 logs of one layout, evenly picked.

    Of a log that begins at rest, the rest is passed over until something moves.
    """
    picked = [logs[i] for i in np.unique(np.linspace(0, len(logs) - 1, _MAX_FILES).astype(int))]
    wanted = sorted({c.column for c in logs[0].channels})
    positions = [c.column for c in logs[0].channels if c.quantity == names.POSITION]
    time = logs[0].joints[0].time.column
    rows = int(np.clip(_MAX_VALUES // (len(picked) * len(wanted)), _MIN_ROWS, _MAX_ROWS))
    heads = [_head(log, wanted, positions, time, rows) for log in picked]
    return Survey(tuple(head for head in heads if head), logs[0].channels)


def _head(
    log: OpenedLog, wanted: list[int], positions: list[int], time: int, enough: int
) -> dict[int, Array]:
    kept: list[dict[int, Array]] = []
    rows = 0
    moved = False
    for number, batch in enumerate(_readable(log, wanted)):
        moves = any(_spans(batch.values[column]) for column in positions)
        if kept and not moves and not moved:
            if number >= _MAX_BATCHES:
                break
            continue
        moved = moved or moves
        good = np.isfinite(batch.values[time])
        kept.append({column: values[good] for column, values in batch.values.items()})
        rows += int(good.sum())
        if rows >= enough and moved:
            break
    if not kept:
        return {}
    return {column: np.concatenate([part[column] for part in kept]) for column in wanted}


def _readable(log: OpenedLog, wanted: list[int]) -> Iterator[RawBatch]:
    """Yield batches up to where the file ends or cannot be read; reading it tells of that."""
    with suppress(UnreadableLog):
        yield from log.source.batches(wanted, _BATCH_BYTES)


def _spans(values: Array) -> bool:
    finite = values[np.isfinite(values)]
    return bool(len(finite)) and float(np.ptp(finite)) > _MOVED
