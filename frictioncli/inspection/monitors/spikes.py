"""Spikes: single samples that differ from their neighbours on both sides."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.monitors.joint_rows import JointRows

_FAR = 7.0
"""Least deviation of a spike, as a multiple of the 95 % quantile of all deviations. [-]"""

_FARTHER = 4.0
"""Least deviation of a spike, as a multiple of that of its neighbours. [-]"""

_USUAL = 0.95
_FEWEST = 20
_COARSE = 5.0
"""Least deviation of a spike, in steps of the channel's resolution. [-]"""


@dataclass(slots=True)
class SpikeMonitor:
    """Counts the spikes of one channel, with first line and largest deviation."""

    count: int = 0
    line: int | None = None
    farthest: float = 0.0
    _scale: float = 0.0

    def update(self, rows: JointRows, values: Array, step: float) -> None:
        """Add the next rows.

        Parameters
        ----------
        rows : JointRows
            The joint's rows.
        values : ndarray, shape (n,)
            The channel, context included.
        step : float
            Its step as far as known, 0 where it has none.
        """
        if len(values) < _FEWEST:
            return
        deviation, neighbour_deviation = _deviations(values)
        after = rows.contiguous
        contiguous = after[1:-3] & after[2:-2] & after[3:-1] & after[4:]
        inside = np.zeros(len(values), bool)
        inside[rows.new] = True
        candidates = contiguous & inside[2:-2]
        moving = rows.moving[2:-2]
        groups = [deviation[candidates & moving], deviation[candidates & ~moving]]
        usual = [float(np.quantile(group, _USUAL)) for group in groups if len(group) >= _FEWEST]
        self._scale = max(usual, default=self._scale)
        least = _FAR * self._scale + _COARSE * step
        rounding = 1e-9 * float(np.max(np.abs(values)))
        spikes = candidates & (deviation > max(least, rounding))
        spikes &= deviation > _FARTHER * neighbour_deviation
        where = np.flatnonzero(spikes)
        if len(where):
            self.count += len(where)
            self.line = self.line or int(rows.window.rows.lines[where[0] + 2])
            self.farthest = max(self.farthest, float(deviation[where].max()))


def _deviations(values: Array) -> tuple[Array, Array]:
    """Return how far each inner sample lies off a line fitted to the two samples on either side.

    Returns
    -------
    deviation, neighbour_deviation : ndarray, shape (n - 4,)
        Deviation of the sample, and of the farthest of the four neighbours, from the line.
    """
    around = np.stack([values[:-4], values[1:-3], values[3:-1], values[4:]])
    places = np.array([-2.0, -1.0, 1.0, 2.0])
    middle = around.mean(axis=0)
    slope = places @ around / (places @ places)
    neighbour_deviation = np.abs(around - middle - places[:, None] * slope).max(axis=0)
    return np.abs(values[2:-2] - middle), neighbour_deviation
