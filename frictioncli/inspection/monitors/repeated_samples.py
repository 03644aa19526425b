"""Repeated samples: all channels repeat the sample before while the joint moves."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.inspection.monitors.joint_rows import JointRows
from frictioncli.inspection.monitors.log_histogram import LogHistogram
from frictioncli.inspection.monitors.windows import Window
from frictioncli.logs.channels import channel_names as names

_CHANNELS = (names.POSITION, names.VELOCITY, names.TORQUE, names.LOAD)
_ALIKE = 2.5
"""Mean rates of position before and across a repetition differ by less than this factor. [-]"""

_ABOVE_STEP = 2.5
"""A jump of fewer steps of the position's resolution is slow motion, not a repetition."""

_LINES_KEPT = 1000


def changes(window: Window) -> Flags:
    """Return for each row of a window whether any channel differs from the row before."""
    changed = np.zeros(len(window.rows), bool)
    changed[:1] = True
    for (_, name), values in window.rows.columns.items():
        if name in _CHANNELS:
            changed[1:] |= np.diff(values) != 0
    return changed


@dataclass(slots=True)
class RepeatedSamplesMonitor:
    """Counts repeated samples.

    At standstill all channels may repeat, as they may in slow motion between two steps of a coarse
    position. A sample counts as held if position then catches up: it continues at the mean rate
    from before the repetition, in a jump of more than two of its steps.
    """

    _jumps: LogHistogram = field(default_factory=LogHistogram)
    _first: list[tuple[float, int]] = field(default_factory=list)
    _position: Array = field(default_factory=lambda: np.empty(0))
    _row: Numbers = field(default_factory=lambda: np.empty(0, np.int64))
    _line: Numbers = field(default_factory=lambda: np.empty(0, np.int64))
    _rows: int = 0

    def update(self, rows: JointRows, changed: Flags) -> None:
        """Add the next rows.

        Parameters
        ----------
        rows : JointRows
            The joint's rows.
        changed : ndarray of bool, shape (n,)
            Result of :func:`changes`.
        """
        new = rows.new
        # at standstill nothing is held: every row counts as a change
        at = np.flatnonzero(changed[new] | ~rows.moving[new])
        position = rows.required(names.POSITION)[new][at]
        self._position = np.concatenate((self._position, position))
        self._row = np.concatenate((self._row, at + self._rows))
        self._line = np.concatenate((self._line, rows.window.rows.lines[new][at]))
        self._rows += new.stop - new.start
        self._find_held()
        # the last two may be the beginning of a repetition
        self._position = self._position[-2:]
        self._row, self._line = self._row[-2:], self._line[-2:]

    def _find_held(self) -> None:
        if len(self._row) < 3:
            return
        lengths, jumps = np.diff(self._row), np.diff(self._position)
        before, over = jumps[:-1] / lengths[:-1], jumps[1:] / lengths[1:]
        repeated = lengths[1:] > 1
        alike = (np.sign(over) * np.sign(before) > 0) & (np.abs(over) < _ALIKE * np.abs(before))
        alike &= np.abs(before) < _ALIKE * np.abs(over)
        held = np.flatnonzero(repeated & alike)
        sizes = np.abs(jumps[1:][held])
        self._jumps.add(sizes, (lengths[1:][held] - 1).astype(float))
        room = max(_LINES_KEPT - len(self._first), 0)
        lines = self._line[1:-1][held] + 1
        self._first += list(zip(sizes[:room].tolist(), lines[:room].tolist(), strict=True))

    def result(self, step: float) -> tuple[int, int | None]:
        """Return the number of held samples, and the first line of them.

        Parameters
        ----------
        step : float
            Step of the position, 0 where it has none. [deg]
        """
        least = _ABOVE_STEP * step
        lines = [line for size, line in self._first if size > least]
        return self._jumps.above(least), min(lines, default=None)
