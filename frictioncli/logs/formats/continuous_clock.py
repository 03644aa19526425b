"""Clocks that begin anew at the end of their range: times of day, and counters of 16 or 32 bits."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.log_source import DerivedSource, RawBatch

_LONGEST_STEP = 0.5
"""A clock that falls by more than this share of its range has begun anew. [-]"""


@dataclass(frozen=True, slots=True)
class ContinuousClock(DerivedSource):
    """A source whose time goes on where its clock begins anew.

    Attributes
    ----------
    source : LogSource
        The log.
    time : int
        Its column of time.
    span : float
        Range of the clock. [unit of the column]
    """

    time: int
    span: float

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        last, turns = np.nan, 0
        for batch in self.source.batches(columns, size):
            if self.time not in batch.values:
                yield batch
                continue
            time, last, turns = continued(batch.values[self.time], self.span, last, turns)
            values = {**batch.values, self.time: time}
            yield RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)


def continued(
    time: Array, span: float, last: float = np.nan, turns: int = 0
) -> tuple[Array, float, int]:
    """Return times that go on where the clock begins anew, and the state for the next ones.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Times by the clock; NaN where there is none. Those beyond its range stay as they are.
    span : float
        Range of the clock.
    last : float
        The time by the clock before the first one, NaN where there is none.
    turns : int
        How often the clock has begun anew before.

    Returns
    -------
    time : ndarray, shape (n,)
        The times with the range added as often as the clock has begun anew.
    last : float
        The last time by the clock.
    turns : int
        How often it has begun anew.

    Examples
    --------
    >>> continued(np.array([86399.0, 0.5, np.nan, 1.5]), 86400.0)
    (array([86399. , 86400.5,     nan, 86401.5]), 1.5, 1)
    """
    known = np.flatnonzero(np.abs(time) <= span)  # the clock shows no others: they are damaged
    if not len(known):
        return time, last, turns
    shown = time[known]
    before = np.append(last if np.isfinite(last) else shown[0], shown[:-1])
    # one damaged time stamp far ahead falls back too, and is undone where the clock seems to leap
    falls = (before - shown) > _LONGEST_STEP * span
    leaps = (shown - before) > _LONGEST_STEP * span
    turned = turns + np.cumsum(falls.astype(np.int64) - leaps.astype(np.int64))
    found = time.copy()
    found[known] += turned * span
    return found, float(shown[-1]), int(turned[-1])
