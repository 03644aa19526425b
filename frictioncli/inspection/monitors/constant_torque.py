"""Constant torque: at a limit while the joint moves, or frozen at standstill."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.inspection.monitors.joint_rows import JointRows
from frictioncli.logs.channels import channel_names as names
from frictioncli.pairs.slices import true_runs

_LEAST_CHANGING = 0.8
"""Share of samples in motion whose torque must change for constant torque to be conspicuous. [-]"""

_LEAST_BETWEEN = 0.1
"""Least share of the samples in motion that must lie between the limits. [-]"""

_LEAST_AT_LIMIT = 5
_LEAST_FROZEN = 10
_LEAST_SECONDS = 1.0
_ONE_SLICE = np.zeros(1, np.int64)


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit at which the torque stays while the joint moves.

    Attributes
    ----------
    torque : float
        The limit, in the unit of the torque.
    samples, longest : int
        Samples in motion at the limit, and the most in a row.
    share : float
        Samples at the limit as a share of all samples in motion. [-]
    """

    torque: float
    samples: int
    longest: int
    share: float


@dataclass(slots=True)
class _Maximum:
    """The highest torque so far, and the samples in motion at it."""

    value: float = -np.inf
    samples: int = 0
    longest: int = 0
    running: int = 0

    def update(self, torque: Array, moving: Flags) -> None:
        if not len(torque):
            return
        highest = float(torque.max())
        if highest > self.value:
            self.value, self.samples, self.longest, self.running = highest, 0, 0, 0
        at = (torque == self.value) & moving
        self.samples += int(at.sum())
        lengths, begins = _runs(at)
        if not len(lengths):
            self.running = 0
            return
        lengths[0] += self.running if begins[0] == 0 else 0
        self.longest = max(self.longest, int(lengths.max()))
        self.running = int(lengths[-1]) if at[-1] else 0


@dataclass(slots=True)
class _Standstill:
    """Intervals at standstill in which every row repeats the torque of the row before."""

    seconds: float = 0.0
    spans: int = 0
    _open_rows: int = 0
    _open_since: float = np.nan
    _last: float = np.nan

    def update(self, time: Array, still: Flags) -> None:
        rows, begins = _runs(still)
        before = np.concatenate(([self._last], time))
        since, until = before[begins], time[begins + rows - 1]
        if self._open_rows and len(still) and still[0]:
            rows[0] += self._open_rows
            since[0] = self._open_since
        else:
            self.end()
        self._open_rows = 0
        if len(still) and still[-1]:
            self._open_rows, self._open_since = int(rows[-1]), float(since[-1])
            rows, since, until = rows[:-1], since[:-1], until[:-1]
        self._count(rows, until - since)
        self._last = float(time[-1])

    def end(self) -> None:
        """Count the interval that is still open."""
        self._count(np.array([self._open_rows]), np.array([self._last - self._open_since]))
        self._open_rows = 0

    def _count(self, rows: Indices, seconds: Array) -> None:
        long = (rows >= _LEAST_FROZEN) & (seconds >= _LEAST_SECONDS)
        self.spans += int(long.sum())
        self.seconds += float(seconds[long].sum())


@dataclass(slots=True)
class ConstantTorqueMonitor:
    """Finds where the torque of a joint is exactly constant.

    Where torque repeats anyway, as it does if rounded coarsely, nothing is concluded.
    """

    _high: _Maximum = field(default_factory=_Maximum)
    _low: _Maximum = field(default_factory=_Maximum)
    _standstill: _Standstill = field(default_factory=_Standstill)
    _moving: int = 0
    _changing: int = 0

    def update(self, rows: JointRows) -> None:
        """Add the next rows."""
        torque, new = rows.required(names.TORQUE), rows.new
        moving = rows.moving[new]
        self._high.update(torque[new], moving)
        self._low.update(-torque[new], moving)
        same = rows.contiguous & (np.diff(torque, prepend=np.nan) == 0)
        self._moving += int(moving.sum())
        self._changing += int((moving & ~same[new]).sum())
        self._standstill.update(rows.window.rows.time[new], (same & ~rows.moving)[new])

    @property
    def _changes(self) -> bool:
        """Whether torque changes from sample to sample between its limits."""
        between = self._moving - self._high.samples - self._low.samples
        return (
            between > _LEAST_BETWEEN * self._moving and self._changing >= _LEAST_CHANGING * between
        )

    def limits(self) -> tuple[Limit, ...]:
        """Return the limits at which the torque stays while the joint moves."""
        if not self._changes:
            return ()
        return tuple(
            Limit(
                sign * extreme.value,
                extreme.samples,
                extreme.longest,
                extreme.samples / self._moving,
            )
            for extreme, sign in ((self._high, 1.0), (self._low, -1.0))
            if extreme.longest >= _LEAST_AT_LIMIT
        )

    def frozen(self) -> tuple[int, float]:
        """Return the number of intervals of constant torque at standstill, and their sum [s].

        Either the brake is closed and the torque an old value, or the controller is off.
        """
        self._standstill.end()
        return (self._standstill.spans, self._standstill.seconds) if self._changes else (0, 0.0)


def _runs(flags: Flags) -> tuple[Indices, Indices]:
    """Return lengths and beginnings of the runs of set flags."""
    start, stop, _ = true_runs(flags, _ONE_SLICE)
    return stop - start, start
