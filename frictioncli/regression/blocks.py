"""Blocks of time for the jackknife: long enough to be independent, many enough to be counted."""

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.regression.motion_rows import MotionRows

_COUNTS = (48, 32, 24, 16, 12)
"""Numbers of blocks that are tried."""

_CORRELATED = 0.25
"""Correlation of the sums of neighbouring blocks above which blocks are made longer."""


def block_numbers(rows: MotionRows, score: Array) -> Numbers:
    """Return the block of each row.

    Blocks hold equal numbers of rows, except that no move is cut where there are enough moves. They
    are made longer until the sums over neighbouring blocks are hardly correlated.

    Parameters
    ----------
    rows : MotionRows
        The rows, in order of time.
    score : ndarray, shape (rows,)
        What the sums are of: residuals, with the sign of the motion.

    Returns
    -------
    ndarray of int, shape (rows,)
        Number of the block, from 0, growing.
    """
    count = len(rows)
    for number in _COUNTS:
        block = _blocks(rows.move, min(number, max(count // 4, 2)))
        sums = np.bincount(block, score)
        if len(sums) < 4 or number == _COUNTS[-1]:
            break
        deviation = sums - sums.mean()
        square = float(deviation @ deviation)
        if square <= 0 or deviation[1:] @ deviation[:-1] / square <= _CORRELATED:
            break
    return block


def _blocks(move: Numbers, number: int) -> Numbers:
    """Return blocks of equal numbers of rows; of whole moves where those are short."""
    count = len(move)
    block = np.arange(count) * number // max(count, 1)
    starts = np.flatnonzero(np.diff(move, prepend=move[0] - 1))
    longest = int(np.diff(np.append(starts, count)).max())
    if longest <= count // number:
        # the block in which a move begins
        block = np.repeat(block[starts], np.diff(np.append(starts, count)))
    return np.asarray(np.unique(block, return_inverse=True)[1], dtype=np.int64)
