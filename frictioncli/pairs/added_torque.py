r"""What the motion of another joint adds to a joint's torque.

A bin during which another joint moved is compared with the same bin, speed and direction before
and after, when none moved: the torque between these two at its time, by linear interpolation, is
what the joint would have needed alone. Bins during which none moved, compared in the same way, tell
how much of the difference is noise,

.. math:: s^2 = \overline{d^2}_{shared} - \overline{d^2}_{alone},

with an error from the scatter between moves, as the bins of one share their noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Flags, Indices, Numbers

LEAST_MOVES = 4
"""Moves in which another one moves from which on the size has an interval."""

_USUAL = 0.95
"""Quantile of the times between the neighbours of a bin up to which they are compared."""

_Z95 = 1.96


@dataclass(frozen=True, slots=True)
class AddedSize:
    """Size of the torque that other joints add while they move.

    Attributes
    ----------
    value, low, high : float
        RMS over the bins during which they move, with its 95 % interval. [torque unit]
    p_value : float
        Probability that noise alone gives as much. [1]
    moves : int
        Moves in which it was measured.
    """

    value: float
    low: float
    high: float
    p_value: float
    moves: int


@dataclass(slots=True)
class AddedByOthers:
    """Squared differences of torque, as sums of moves, by whether another joint moved.

    Attributes
    ----------
    shared, alone : list of tuple of (float, int)
        For each move, the sum over the bins that were compared and their number.
        [torque unit squared]
    """

    shared: list[tuple[float, int]] = field(default_factory=list)
    alone: list[tuple[float, int]] = field(default_factory=list)

    def add(
        self,
        key: tuple[Numbers | Array, ...],
        time: Array,
        torque: Array,
        segment: Numbers,
        shared: Flags,
    ) -> None:
        """Add bins, those of a move all at once.

        Parameters
        ----------
        key : tuple of ndarray, shape (bins,)
            What bins that are compared have in common: direction, speed, angle, payload.
        time : ndarray, shape (bins,)
            When the bin was passed. [s]
        torque : ndarray, shape (bins,)
            Mean torque. [torque unit]
        segment : ndarray of int, shape (bins,)
            Number of the move.
        shared : ndarray of bool, shape (bins,)
            Whether another joint moved meanwhile.
        """
        _, code = np.unique(
            np.stack([np.asarray(one, float) for one in key]), axis=1, return_inverse=True
        )
        order = np.lexsort((time, code.reshape(-1)))
        code, time, torque = code.reshape(-1)[order], time[order], torque[order]
        segment, shared = segment[order], shared[order]
        before, after = _neighbours(code, shared)
        known = np.flatnonzero((before >= 0) & (after >= 0))
        before, after = before[known], after[known]
        span = time[after] - time[before]
        share = (time[known] - time[before]) / np.where(span > 0, span, 1.0)
        between = (1 - share) * torque[before] + share * torque[after]
        squared = np.square(torque[known] - between)
        moved = shared[known]
        if moved.all():
            return
        # over a longer time than is usual friction need not change evenly
        near = span <= np.quantile(span[~moved], _USUAL)
        for found, chosen in ((self.shared, moved & near), (self.alone, ~moved & near)):
            _, move = np.unique(segment[known][chosen], return_inverse=True)
            sums, count = np.bincount(move, squared[chosen]), np.bincount(move)
            found += zip(sums.tolist(), count.tolist(), strict=True)

    def size(self) -> AddedSize | None:
        """Return the size of what was added; None where too few moves can be compared."""
        if min(len(self.shared), len(self.alone)) < LEAST_MOVES:
            return None
        # reading logs needs no scipy
        from scipy import stats

        (shared, of_shared), (alone, of_alone) = map(_mean, (self.shared, self.alone))
        squared, error = shared - alone, float(np.hypot(of_shared, of_alone))
        moves = [[total / count for total, count in one] for one in (self.shared, self.alone)]
        p_value = float(stats.mannwhitneyu(*moves, alternative="greater").pvalue)
        value, low, high = np.sqrt(
            np.maximum([squared, squared - _Z95 * error, max(squared, 0.0) + _Z95 * error], 0.0)
        ).tolist()
        return AddedSize(value, low, high, p_value, len(self.shared))


def _mean(moves: Sequence[tuple[float, int]]) -> tuple[float, float]:
    """Return the mean over the bins of moves, and its standard error by the moves."""
    total, count = np.array(moves).T
    mean = float(total.sum() / count.sum())
    scatter = float(np.sum(np.square(total - mean * count)))
    return mean, float(np.sqrt(scatter * len(moves) / (len(moves) - 1)) / count.sum())


def _neighbours(code: Indices, shared: Flags) -> tuple[Indices, Indices]:
    """Return the nearest row of the same code before and after each, without other motion.

    Rows are in the order of code and time; -1 where there is none.
    """
    rows = np.arange(len(code))
    alone = np.where(shared, -1, rows)
    last = np.maximum.accumulate(np.concatenate([[-1], alone]))[:-1]
    coming = np.where(shared, len(code), rows)
    following = np.minimum.accumulate(np.concatenate([coming, [len(code)]])[::-1])[::-1][1:]
    before = np.where((last >= 0) & (code[last] == code), last, -1)
    behind = np.minimum(following, len(code) - 1)
    after = np.where((following < len(code)) & (code[behind] == code), following, -1)
    return before, after
