"""Checks of the rows of one log: which are kept, which are rejected, and why.

The checks are generators over consecutive rows. Their result does not depend on how the log was cut
into chunks: a check that compares neighbours holds rows back until it has seen them.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.channel_names import POSITION, TIME, TORQUE, VELOCITY
from frictioncli.logs.samples.differentiation import local_slope
from frictioncli.logs.samples.log_rows import NO_VALUES, LogRows, RejectedRows, concatenate_rows

LIMITS = {TIME: 1e11, POSITION: 1e6, VELOCITY: 1e6, TORQUE: 1e6}
"""Largest magnitude that a sensor can show; beyond it a cell is damaged. [s, deg, deg/s, N·m or A]
"""

_LOOK_AHEAD = 8
"""Following rows with which a time stamp is compared."""

_START_ROWS = 200
"""First rows of a log in which stale rows are sought."""

_STALE_ROWS = 3
_STALE_FACTOR = 20.0
_STALE_JUMP = 0.2  # [deg]
_STALE_PERIOD = 0.1  # [s]


def drop_missing_values(
    rows: LogRows, required: Iterable[tuple[int, str]], rejected: RejectedRows
) -> LogRows:
    """Return the rows whose time and required columns hold plausible numbers.

    Parameters
    ----------
    rows : LogRows
        Consecutive rows.
    required : iterable of (int, str)
        Joint and name of the columns that must have a value.
    rejected : RejectedRows
        Takes the lines of the other rows.
    """
    names = [TIME, *(name for _, name in required)]
    needed = [rows.time, *(rows.columns[column] for column in required)]
    if all(_all_within(values, LIMITS[name]) for name, values in zip(names, needed, strict=True)):
        return rows
    absent = np.array([np.isnan(values) for values in needed])
    missing = absent.any(axis=0)
    empty = absent[1:].all(axis=0) & ~absent[0]
    infinite = np.any([np.isinf(values) for values in needed], axis=0)
    beyond = np.zeros(len(rows), bool)
    for name, values in zip(names, needed, strict=True):
        beyond |= np.abs(values) > LIMITS[name]
    good = ~missing & ~beyond
    rejected.add(rows.lines[empty], NO_VALUES)
    rejected.add(rows.lines[missing & ~empty], "missing_value")
    rejected.add(rows.lines[~missing & infinite], "not_a_number")
    rejected.add(rows.lines[~missing & ~infinite & ~good], "implausible_value")
    return rows.take(good)


def _all_within(values: Array, limit: float) -> bool:
    """Return whether all values are numbers within ±limit; min and max propagate NaN."""
    return not len(values) or bool(-limit <= values.min() and values.max() <= limit)


def drop_non_increasing_time(
    blocks: Iterable[LogRows], rejected: RejectedRows
) -> Iterator[LogRows]:
    """Yield the rows whose time increases.

    A damaged time stamp far ahead costs its own row only, not the good rows that follow it.

    Parameters
    ----------
    blocks : iterable of LogRows
        Consecutive rows, in blocks of any size.
    rejected : RejectedRows
        Takes the lines of the other rows.
    """
    last = -np.inf
    held: LogRows | None = None
    for block in _at_least_look_ahead(blocks):
        if held is not None:
            kept, last = _increasing(held, block.time[:_LOOK_AHEAD], last, rejected)
            yield kept
        held = block
    if held is not None:
        yield _increasing(held, np.empty(0), last, rejected)[0]


def _at_least_look_ahead(blocks: Iterable[LogRows]) -> Iterator[LogRows]:
    """Yield the rows in blocks long enough to check the last row of the block before."""
    held: LogRows | None = None
    for block in blocks:
        held = block if held is None else concatenate_rows(held, block)
        if len(held) >= _LOOK_AHEAD:
            yield held
            held = None
    if held is not None:
        yield held


def _increasing(
    block: LogRows, following: Array, last: float, rejected: RejectedRows
) -> tuple[LogRows, float]:
    """Return the rows whose time increases from ``last`` on, and the time of the last of them.

    ``following`` holds the times after the block, with which its last rows are compared.
    """
    n = len(block)
    if n and _is_increasing(block.time, last) and _is_increasing(following, block.time[-1]):
        return block, float(block.time[-1])
    time = np.concatenate((block.time, following))
    keep = np.zeros(n, bool)
    equal = np.zeros(n, bool)
    for i in range(n):
        if time[i] <= last:
            equal[i] = time[i] == last
            continue
        after = time[i + 1 : i + 1 + _LOOK_AHEAD]
        # too far ahead: most of the next time stamps are lower, yet later than the last good one
        lower = np.count_nonzero((after < time[i]) & (after > last))
        if lower >= 2 and 2 * lower > len(after):
            continue
        keep[i] = True
        last = float(time[i])
    rejected.add(block.lines[~keep & ~equal], "time_not_increasing")
    rejected.add(block.lines[equal], "duplicate_time")
    return block.take(keep), last


def _is_increasing(time: Array, last: float) -> bool:
    """Return whether times increase strictly, from ``last`` on."""
    return not len(time) or bool(time[0] > last and np.all(time[1:] > time[:-1]))


def drop_stale_first_rows(
    blocks: Iterable[LogRows], positions: Iterable[tuple[int, str]], rejected: RejectedRows
) -> Iterator[LogRows]:
    """Yield the rows without up to three first ones that a recorder kept from before its start.

    Such rows show as a jump of position that the motion after them does not explain.

    Parameters
    ----------
    blocks : iterable of LogRows
        Rows in ascending time.
    positions : iterable of (int, str)
        Columns of position.
    rejected : RejectedRows
        Takes the lines that are dropped.
    """
    names = list(positions)
    start: LogRows | None = None
    checked = False
    for block in blocks:
        if checked:
            yield block
            continue
        start = block if start is None else concatenate_rows(start, block)
        if len(start) >= _START_ROWS:
            yield _checked_start(start, names, rejected)
            checked = True
    if start is not None and not checked:
        yield _checked_start(start, names, rejected)


def _checked_start(
    start: LogRows, positions: list[tuple[int, str]], rejected: RejectedRows
) -> LogRows:
    stale = max((_n_stale(start.time, start.columns[name]) for name in positions), default=0)
    if not stale:
        return start
    rejected.add(start.lines[:stale], "stale_first_rows")
    return start.take(slice(stale, None))


def _n_stale(time: Array, position: Array) -> int:
    """Return how many first rows lie before a jump that the following motion does not explain."""
    first = position[: _STALE_ROWS + 1].tolist()
    if all(abs(after - before) <= _STALE_JUMP for before, after in pairwise(first)):
        return 0
    jumps = np.abs(np.diff(position[:_START_ROWS]))
    if len(jumps) < 2 * _STALE_ROWS:
        return 0
    usual = float(np.max(jumps[_STALE_ROWS:]))
    unusual = np.flatnonzero(jumps[:_STALE_ROWS] > max(_STALE_JUMP, _STALE_FACTOR * usual))
    if not len(unusual) or np.median(np.diff(time[:_START_ROWS])) > _STALE_PERIOD:
        return 0
    return int(unusual[-1]) + 1


def add_velocity(
    blocks: Iterable[LogRows],
    derived: Mapping[tuple[int, str], tuple[int, str]],
    rejected: RejectedRows,
    *,
    half: int,
    gap: float,
) -> Iterator[LogRows]:
    """Yield the rows with velocities differentiated from positions.

    Parameters
    ----------
    blocks : iterable of LogRows
        Rows in ascending time.
    derived : mapping of (int, str) to (int, str)
        Column of velocity to add -> its column of position.
    rejected : RejectedRows
        Takes the lines of rows without a neighbour within the gap.
    half : int
        Samples to each side of the local fit.
    gap : float
        Neighbours further apart than this are not connected. [s]

    See Also
    --------
    frictioncli.logs.samples.differentiation.local_slope : The local fit.
    """
    if not derived:
        yield from blocks
        return
    held: LogRows | None = None
    done = 0  # rows of ``held`` that were yielded already and stay as neighbours of the next ones
    for incoming in blocks:
        block = incoming if held is None else concatenate_rows(held, incoming)
        ready = max(len(block) - half, done)
        yield _differentiated(block, slice(done, ready), derived, rejected, half, gap)
        start = max(ready - half, 0)
        held, done = block.take(slice(start, None)), ready - start
    if held is not None:
        yield _differentiated(held, slice(done, None), derived, rejected, half, gap)


def _differentiated(
    block: LogRows,
    which: slice,
    derived: Mapping[tuple[int, str], tuple[int, str]],
    rejected: RejectedRows,
    half: int,
    gap: float,
) -> LogRows:
    """Return some rows of a block with their velocities; the others are neighbours only."""
    slopes = {
        velocity: local_slope(block.time, block.columns[position], half=half, gap=gap)
        for velocity, position in derived.items()
    }
    rows = LogRows(block.lines, block.time, {**block.columns, **slopes}).take(which)
    isolated = np.zeros(len(rows), bool)
    for velocity in derived:
        isolated |= ~np.isfinite(rows.columns[velocity])
    rejected.add(rows.lines[isolated], "no_neighbours")
    return rows.take(~isolated)
