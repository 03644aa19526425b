"""Rows of one log, checked one after the other: what is kept and what is rejected, and why.

The steps are generators over blocks of rows. None depends on where one block ends and the next
begins: a step that looks at neighbours holds rows back until it has seen them.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.logs.channels.aliases import POSITION, TIME, TORQUE, VELOCITY
from frictioncli.logs.samples.differentiation import local_slope

LOOK_AHEAD = 8
_START_ROWS = 200
_STALE_ROWS = 3
_STALE_FACTOR = 20.0
_STALE_JUMP = 0.2  # [deg]
_STALE_PERIOD = 0.1  # [s]

EMPTY = "no_values"
"""A row of other signals: loggers that join topics by time write one at each of their stamps."""
REASONS = (
    "not_a_number",
    "missing_value",
    "wrong_field_count",
    "time_not_increasing",
    "duplicate_time",
    "implausible_position",
    "stale_first_rows",
    "no_neighbours",
    "outside_other_file",
    "implausible_value",
    EMPTY,
)
LIMITS = {TIME: 1e11, POSITION: 1e6, VELOCITY: 1e6, TORQUE: 1e6}
"""Beyond these no number was measured: a damaged cell. [s], [deg], [deg/s], [N·m or A]"""


@dataclass(frozen=True, slots=True)
class LogRows:
    """Consecutive rows: line numbers, time and named columns, all of shape (n,).

    Names are (joint, canonical name); ``time`` is in s.
    """

    lines: Numbers
    time: Array
    columns: Mapping[tuple[int, str], Array]

    def __len__(self) -> int:
        return len(self.lines)

    def take(self, which: Flags | slice) -> "LogRows":
        """Return some of the rows."""
        columns = {name: values[which] for name, values in self.columns.items()}
        return LogRows(self.lines[which], self.time[which], columns)


@dataclass(slots=True)
class RejectedRows:
    """Lines rejected so far, with the reason's index in ``REASONS``."""

    lines: list[Numbers] = field(default_factory=list)
    codes: list[NDArray[np.int8]] = field(default_factory=list)

    def add(self, lines: Numbers, reason: str) -> None:
        """Note lines rejected for a reason."""
        if len(lines):
            self.lines.append(lines)
            self.codes.append(np.full(len(lines), REASONS.index(reason), np.int8))

    def extend(self, others: "RejectedRows") -> None:
        """Note what was noted elsewhere too."""
        self.lines += others.lines
        self.codes += others.codes

    def counts(self) -> dict[str, int]:
        """Return reason -> lines, for the reasons that occurred."""
        if not self.codes:
            return {}
        numbers = np.zeros(len(REASONS), int)
        for codes in self.codes:
            numbers += np.bincount(codes, minlength=len(REASONS))
        return {reason: int(n) for reason, n in zip(REASONS, numbers, strict=True) if n}

    def first(self, reason: str) -> Numbers:
        """Return the first line rejected for a reason, shape (1,)."""
        code = REASONS.index(reason)
        found = [lines[codes == code] for lines, codes in zip(self.lines, self.codes, strict=True)]
        return np.array([min(int(lines.min()) for lines in found if len(lines))])

    def ascending(self) -> tuple[Numbers, NDArray[np.int8]]:
        """Return all lines in ascending order, and their codes."""
        if not self.lines:
            return np.empty(0, np.int64), np.empty(0, np.int8)
        lines, codes = np.concatenate(self.lines), np.concatenate(self.codes)
        order = np.argsort(lines, kind="stable")
        return lines[order], codes[order]


def joined(first: LogRows, second: LogRows) -> LogRows:
    """Return the rows of two blocks, one after the other."""
    return LogRows(
        np.concatenate((first.lines, second.lines)),
        np.concatenate((first.time, second.time)),
        {
            name: np.concatenate((values, second.columns[name]))
            for name, values in first.columns.items()
        },
    )


def with_values(
    block: LogRows, required: Iterable[tuple[int, str]], faults: RejectedRows
) -> LogRows:
    """Return the rows whose time and required columns are numbers that a joint can have."""
    names = [TIME, *(name for _, name in required)]
    needed = [block.time, *(block.columns[column] for column in required)]
    if all(_all_within(values, LIMITS[name]) for name, values in zip(names, needed, strict=True)):
        return block
    absent = np.array([np.isnan(values) for values in needed])
    missing = absent.any(axis=0)
    empty = absent[1:].all(axis=0) & ~absent[0]
    infinite = np.any([np.isinf(values) for values in needed], axis=0)
    beyond = np.zeros(len(block), bool)
    for name, values in zip(names, needed, strict=True):
        beyond |= np.abs(values) > LIMITS[name]
    good = ~missing & ~beyond
    faults.add(block.lines[empty], EMPTY)
    faults.add(block.lines[missing & ~empty], "missing_value")
    faults.add(block.lines[~missing & infinite], "not_a_number")
    faults.add(block.lines[~missing & ~infinite & ~good], "implausible_value")
    return block.take(good)


def _all_within(values: Array, limit: float) -> bool:
    """Return whether all are numbers within ±limit; the extremes tell it fast, NaN is neither."""
    return not len(values) or bool(-limit <= values.min() and values.max() <= limit)


def ascending(blocks: Iterable[LogRows], faults: RejectedRows) -> Iterator[LogRows]:
    """Yield rows whose time grows; a few wild time stamps cost their own rows only."""
    last = -np.inf
    held: LogRows | None = None
    for block in _of_some_length(blocks):
        if held is not None:
            kept, last = _growing(held, block.time[:LOOK_AHEAD], last, faults)
            yield kept
        held = block
    if held is not None:
        yield _growing(held, np.empty(0), last, faults)[0]


def _of_some_length(blocks: Iterable[LogRows]) -> Iterator[LogRows]:
    """Yield the rows in blocks long enough to judge the one before."""
    held: LogRows | None = None
    for block in blocks:
        held = block if held is None else joined(held, block)
        if len(held) >= LOOK_AHEAD:
            yield held
            held = None
    if held is not None:
        yield held


def _growing(
    block: LogRows, following: Array, last: float, faults: RejectedRows
) -> tuple[LogRows, float]:
    """Judge a block's rows after time ``last``; the times ``following`` it help to judge."""
    n = len(block)
    if n and _grows(block.time, last) and _grows(following, block.time[-1]):
        return block, float(block.time[-1])
    time = np.concatenate((block.time, following))
    keep = np.zeros(n, bool)
    equal = np.zeros(n, bool)
    for i in range(n):
        if time[i] <= last:
            equal[i] = time[i] == last
            continue
        after = time[i + 1 : i + 1 + LOOK_AHEAD]
        # wild: most of the next stamps are lower, and yet later than the last good one
        lower = np.count_nonzero((after < time[i]) & (after > last))
        if lower >= 2 and 2 * lower > len(after):
            continue
        keep[i] = True
        last = float(time[i])
    faults.add(block.lines[~keep & ~equal], "time_not_increasing")
    faults.add(block.lines[equal], "duplicate_time")
    return block.take(keep), last


def _grows(time: Array, last: float) -> bool:
    """Tell whether times grow from ``last`` on."""
    return not len(time) or bool(time[0] > last and np.all(time[1:] > time[:-1]))


def drop_stale_first_rows(
    blocks: Iterable[LogRows], positions: Iterable[tuple[int, str]], faults: RejectedRows
) -> Iterator[LogRows]:
    """Drop up to three first rows left over from before: a jump unlike the motion that follows."""
    names = list(positions)
    start: LogRows | None = None
    judged = False
    for incoming in blocks:
        if judged:
            yield incoming
            continue
        start = incoming if start is None else joined(start, incoming)
        if len(start) >= _START_ROWS:
            yield _judged_start(start, names, faults)
            judged = True
    if start is not None and not judged:
        yield _judged_start(start, names, faults)


def _judged_start(block: LogRows, names: list[tuple[int, str]], faults: RejectedRows) -> LogRows:
    stale = max((_stale_rows(block.time, block.columns[name]) for name in names), default=0)
    if not stale:
        return block
    faults.add(block.lines[:stale], "stale_first_rows")
    return block.take(slice(stale, None))


def _stale_rows(time: Array, position: Array) -> int:
    """Return how many first rows lie before a jump that the following motion does not explain."""
    first = position[: _STALE_ROWS + 1].tolist()
    if all(abs(after - before) <= _STALE_JUMP for before, after in pairwise(first)):
        return 0
    jumps = np.abs(np.diff(position[:_START_ROWS]))
    if len(jumps) < 2 * _STALE_ROWS:
        return 0
    usual = float(np.max(jumps[_STALE_ROWS:]))
    wild = np.flatnonzero(jumps[:_STALE_ROWS] > max(_STALE_JUMP, _STALE_FACTOR * usual))
    if not len(wild) or np.median(np.diff(time[:_START_ROWS])) > _STALE_PERIOD:
        return 0
    return int(wild[-1]) + 1


def with_velocity(
    blocks: Iterable[LogRows],
    derived: Mapping[tuple[int, str], tuple[int, str]],
    faults: RejectedRows,
    *,
    half: int,
    gap: float,
) -> Iterator[LogRows]:
    """Add velocities differentiated from positions.

    Parameters
    ----------
    blocks : iterable of LogRows
        Rows in ascending time.
    derived : mapping
        Name of each velocity to make -> name of its position.
    faults : RejectedRows
        Takes the rows that have no neighbour within the gap.
    half, gap : int, float
        See :func:`derivative.local_slope`.
    """
    if not derived:
        yield from blocks
        return
    held: LogRows | None = None
    done = 0  # rows of ``held`` that went out already and stay as neighbours of what follows
    for incoming in blocks:
        block = incoming if held is None else joined(held, incoming)
        ready = max(len(block) - half, done)
        yield _differentiated(block, slice(done, ready), derived, faults, half, gap)
        start = max(ready - half, 0)
        held, done = block.take(slice(start, None)), ready - start
    if held is not None:
        yield _differentiated(held, slice(done, None), derived, faults, half, gap)


def _differentiated(
    block: LogRows,
    which: slice,
    derived: Mapping[tuple[int, str], tuple[int, str]],
    faults: RejectedRows,
    half: int,
    gap: float,
) -> LogRows:
    slopes = {
        velocity: local_slope(block.time, block.columns[position], half=half, gap=gap)
        for velocity, position in derived.items()
    }
    out = LogRows(block.lines, block.time, {**block.columns, **slopes}).take(which)
    alone = np.zeros(len(out), bool)
    for velocity in derived:
        alone |= np.isnan(out.columns[velocity])
    faults.add(out.lines[alone], "no_neighbours")
    return out.take(~alone)
