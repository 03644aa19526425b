"""Other time columns of a log, compared with the one that is used."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels
from frictioncli.logs.log_source import LogSource


@dataclass(frozen=True, slots=True)
class OtherClock:
    """A time column that is not used, compared with the clock that is used.

    Attributes
    ----------
    column : str
        Its name.
    rate : float
        Its seconds per second of the clock used. [-]
    departs_s : float
        Largest difference of the times since the first row. [s]
    """

    column: str
    rate: float
    departs_s: float


def other_clocks(source: LogSource, plan: JointPlan, batch_bytes: int) -> tuple[OtherClock, ...]:
    """Compare the other time columns, in another pass over the time columns alone.

    Parameters
    ----------
    source : LogSource
        The log.
    plan : JointPlan
        Columns and units of a joint.
    batch_bytes : int
        Size of a batch in the file. [byte]
    """
    used = plan.channels.time.column
    others = [
        channel
        for channel in recognise_channels(source.columns)
        if channel.quantity == names.TIME and channel.column != used
    ]
    if not others:
        return ()
    comparisons = [_Comparison(channel, plan.conversions[names.TIME].factor) for channel in others]
    for batch in source.batches([used, *(channel.column for channel in others)], batch_bytes):
        for comparison in comparisons:
            comparison.update(batch.values[used], batch.values[comparison.channel.column])
    return tuple(found for comparison in comparisons if (found := comparison.result()))


@dataclass(slots=True)
class _Comparison:
    """Running comparison of one clock; ``factor`` converts the clock used to seconds."""

    channel: LogChannel
    factor: float
    _other_factor: float = np.nan
    _start: float = np.nan
    _apart: float = np.nan
    _squares: float = 0.0
    _sloped: float = 0.0
    _farthest: float = 0.0

    def update(self, used: Array, other: Array) -> None:
        good = np.isfinite(used) & np.isfinite(other)
        used, other = used[good] * self.factor, other[good]
        if not len(used):
            return
        if np.isnan(self._start):
            written = units.canonical(self.channel.unit or self.channel.meaning.unit, names.TIME)
            self._other_factor = units.FACTORS[names.TIME][units.infer_time_unit([other], written)]
            self._start = float(used[0])
            self._apart = float(other[0] * self._other_factor - used[0])
        since = used - self._start
        departs = other * self._other_factor - used - self._apart
        self._squares += float(since @ since)
        self._sloped += float(since @ departs)
        self._farthest = max(self._farthest, float(np.abs(departs).max()))

    def result(self) -> OtherClock | None:
        if self._squares == 0:
            return None
        return OtherClock(self.channel.name, 1 + self._sloped / self._squares, self._farthest)
