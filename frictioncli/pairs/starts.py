"""Samples around the starts of moves, which show when torque was logged.

Inertial torque follows the acceleration at once, so that a delay or a filter of the logged torque
shows where a move accelerates. Means over angle bins (:mod:`frictioncli.pairs.ramps`) no longer
show it; the samples do. A hundred starts tell as much as a million would: of many, evenly spaced
ones are kept.
"""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.pairs.constant_speed import ConstantSpeedSegments
from frictioncli.pairs.moves import samples_in
from frictioncli.pairs.partitioned_store import Columns
from frictioncli.pairs.ramps import SHARED
from frictioncli.pairs.slices import slice_indices

BEFORE, AFTER = 0.25, 0.6
"""Time that is kept before and after the start of a move, the latter while the move lasts. [s]"""

MOST = 128
"""Starts of a run and joint that are kept, at most."""

_FROM_REST = 0.25
"""A move that begins above this share of its speed does not start there."""

SLOWEST_SAMPLING = 0.03
"""Sampling period above which a start shows nothing of a delay. [s]"""

_CHANNELS = ("time", "position", "torque", "motor_temperature", "housing_temperature")

COLUMNS = ("move", "direction", "speed", "since", *_CHANNELS)
"""Columns of the rows; ``move`` is the number of the segment."""

NUMBER = "number"
"""Number of the start within its run and joint, beside the columns."""

_KINDS = dict.fromkeys((*COLUMNS, NUMBER, SHARED), np.float64) | {
    "move": np.int64,
    "direction": np.int64,
    NUMBER: np.int64,
    SHARED: np.bool_,
}


@dataclass(slots=True)
class StartCounts:
    """Number of starts by run and joint, and which of them are kept.

    Attributes
    ----------
    counts : dict of (str, int) to int
        Starts seen so far.
    """

    counts: dict[tuple[str, int], int] = field(default_factory=dict)

    def stride(self, joint: tuple[str, int]) -> int:
        """Return how many starts there are per start that is kept, a power of two."""
        return int(2 ** max(np.ceil(np.log2(max(self.counts.get(joint, 0), 1) / MOST)), 0))

    def add(
        self,
        joint: tuple[str, int],
        channels: dict[str, Array],
        segments: ConstantSpeedSegments,
        period: float,
    ) -> Columns:
        """Return the samples around starts of moves that may be kept, and count the starts.

        Parameters
        ----------
        joint : (str, int)
            Run and joint.
        channels : dict of str to ndarray, shape (samples,)
            The channels of :data:`COLUMNS` and other_speed. [deg], [N·m], [°C], [deg/s]
        segments : ConstantSpeedSegments
            Constant-speed segments, with the bounds of their moves.
        period : float
            Sampling period. [s]

        Returns
        -------
        dict of str to ndarray, shape (rows,)
            The :data:`COLUMNS`, :data:`NUMBER` and whether another joint moved; ``since`` is the
            time since the start of the move [s]. Those whose number is a multiple of the last
            stride are to be kept.
        """
        if period > SLOWEST_SAMPLING:
            return {name: np.empty(0, kind) for name, kind in _KINDS.items()}
        before = self.counts.get(joint, 0)
        self.counts[joint] = before + len(segments.start)
        number = np.arange(before, self.counts[joint])
        at_rest = np.abs(channels["velocity"][segments.move_start])
        from_rest = at_rest <= _FROM_REST * np.abs(segments.speed)
        chosen = np.flatnonzero((number % self.stride(joint) == 0) & from_rest)
        start, stop = segments.move_start[chosen], segments.move_stop[chosen]
        low = np.maximum(start - samples_in(BEFORE, period), 0)
        high = np.minimum(start + samples_in(AFTER, period), stop)
        index, length = slice_indices(low, high), high - low
        rows = {
            "move": np.repeat(chosen, length),
            "direction": np.repeat(np.sign(segments.speed[chosen]).astype(np.int64), length),
            "speed": np.repeat(np.abs(segments.speed[chosen]), length),
            "since": channels["time"][index] - np.repeat(channels["time"][start], length),
            **{name: channels[name][index] for name in _CHANNELS},
            NUMBER: np.repeat(number[chosen], length),
            SHARED: channels["other_speed"][index] > 0,
        }
        # samples before a gap in the log are not around the start
        near = (rows["since"] >= -BEFORE - period) & (rows["since"] <= AFTER + period)
        return {name: np.asarray(rows[name][near], kind) for name, kind in _KINDS.items()}
