"""Single samples unlike their neighbours on both sides."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.monitors.joint_rows import JointRows

_FAR = 7.0
"""Times what 95 % of the samples depart from their neighbours."""

_FARTHER = 4.0
"""Times what the neighbours depart from each other."""

_USUAL = 0.95
_FEWEST = 20
_COARSE = 5.0
"""Steps of the channel's own grid that a spike must exceed at least."""


@dataclass(slots=True)
class SpikeMonitor:
    """Counts spikes of one channel: how many, the first line, and the farthest departure."""

    count: int = 0
    line: int | None = None
    farthest: float = 0.0
    _scale: float = 0.0

    def update(self, rows: JointRows, values: Array, step: float) -> None:
        """Take in the next rows.

        Parameters
        ----------
        rows : JointRows
            The joint's rows.
        values : ndarray, shape (n,)
            The channel, context included.
        step : float
            Its grid as far as known, 0 where it has none.
        """
        if len(values) < _FEWEST:
            return
        off, unlike = _departures(values)
        together = rows.joined[1:-3] & rows.joined[2:-2] & rows.joined[3:-1] & rows.joined[4:]
        inside = np.zeros(len(values), bool)
        inside[rows.new] = True
        judged = together & inside[2:-2]
        moving = rows.moving[2:-2]
        parts = [off[judged & moving], off[judged & ~moving]]
        usual = [float(np.quantile(part, _USUAL)) for part in parts if len(part) >= _FEWEST]
        self._scale = max(usual, default=self._scale)
        least = _FAR * self._scale + _COARSE * step
        rounding = 1e-9 * float(np.max(np.abs(values)))
        spikes = judged & (off > max(least, rounding)) & (off > _FARTHER * unlike)
        where = np.flatnonzero(spikes)
        if len(where):
            self.count += len(where)
            self.line = self.line or int(rows.window.rows.lines[where[0] + 2])
            self.farthest = max(self.farthest, float(off[where].max()))


def _departures(values: Array) -> tuple[Array, Array]:
    """Return how far each inner sample lies off the line through the two on either side of it.

    Returns
    -------
    off, unlike : ndarray, shape (n - 4,)
        Distance of the sample, and of the farthest of the four, from that line.
    """
    around = np.stack([values[:-4], values[1:-3], values[3:-1], values[4:]])
    places = np.array([-2.0, -1.0, 1.0, 2.0])
    middle = around.mean(axis=0)
    slope = places @ around / (places @ places)
    unlike = np.abs(around - middle - places[:, None] * slope).max(axis=0)
    return np.abs(values[2:-2] - middle), unlike
