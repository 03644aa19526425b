"""Logs of one axis without position: the position is made by integrating the velocity.

A drive or a motor on a bench is often logged with velocity and torque only. Its angle is then
unknown but for a constant, so that nothing that depends on the angle can be told.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import INTEGRATED, JOINT_SIDE, Meaning
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.unit_evidence import isolated
from frictioncli.logs.log_source import DerivedSource, RawBatch

_DAMAGED = 1000
"""A velocity or a step of time so many times larger than others is damaged. [-]"""


def integrable(channels: Sequence[LogChannel]) -> tuple[LogChannel, LogChannel] | None:
    """Return time and velocity of a log of one axis without position; else None.

    The velocity of several joints makes no positions: an arm carries a load that depends on the
    angles.

    Parameters
    ----------
    channels : sequence of LogChannel
        The recognised columns.
    """
    times = [c for c in channels if c.quantity == names.TIME]
    velocities = [c for c in channels if c.quantity == names.VELOCITY]
    one_axis = len({c.joint for c in velocities}) == 1
    if not times or not one_axis or any(c.quantity == names.POSITION for c in channels):
        return None
    return min(times, key=lambda c: c.meaning.rank), velocities[0]


def with_position(
    channels: Sequence[LogChannel], velocity: LogChannel, column: int
) -> tuple[LogChannel, ...]:
    """Return channels with the position that is made, on the side of the gear of the velocity.

    Parameters
    ----------
    channels : sequence of LogChannel
        The recognised columns.
    velocity : LogChannel
        The velocity.
    column : int
        Index of the new column.
    """
    position = LogChannel(
        column, INTEGRATED, Meaning(names.POSITION, JOINT_SIDE), velocity.joint, "deg", INTEGRATED
    )
    at_joint = replace(velocity, meaning=replace(velocity.meaning, side=JOINT_SIDE))
    return (*(at_joint if c is velocity else c for c in channels), position)


@dataclass(frozen=True, slots=True)
class IntegratedPosition(DerivedSource):
    """A source with a further column: the integral of its velocity from 0, by trapezoids [deg].

    Attributes
    ----------
    source : LogSource
        The log.
    time, velocity : int
        Its columns.
    scale : float
        Factor from velocity times time to deg.
    """

    time: int
    velocity: int
    scale: float

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names, the position last."""
        return (*self.source.columns, INTEGRATED)

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"{self.source.form}, position integrated from {self.source.columns[self.velocity]}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        made = len(self.source.columns)
        wanted = {column for column in columns if column != made}
        if made not in columns:
            yield from self.source.batches(wanted, size)
            return
        angle, last = 0.0, (np.nan, np.nan)
        for batch in self.source.batches(wanted | {self.time, self.velocity}, size):
            time, rate = batch.values[self.time], batch.values[self.velocity]
            position = angle + self.scale * _integral(time, rate, last)
            if len(position):
                finite = np.flatnonzero(np.isfinite(time) & np.isfinite(rate))
                if len(finite):
                    angle = float(position[finite[-1]])
                    last = float(time[finite[-1]]), float(rate[finite[-1]])
            values = batch.values | {made: position}
            yield RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)


def _integral(time: Array, rate: Array, last: tuple[float, float]) -> Array:
    """Return the integral since the row before the first, NaN where a value is missing."""
    good = np.isfinite(time) & np.isfinite(rate)
    integral = np.full(len(time), np.nan)
    if not good.any():
        return integral
    before = last if np.isfinite(last[0]) else (float(time[good][0]), float(rate[good][0]))
    t, v = np.append(before[0], time[good]), np.append(before[1], rate[good])
    # a damaged velocity, or a clock that leaps or is set back, would move all later positions
    v[isolated(v, _DAMAGED)] = 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(t)
        ahead = steps > 0
        longest = _DAMAGED * float(np.median(steps[ahead])) if ahead.any() else 0.0
        steps = np.where(ahead & (steps <= longest), steps, 0.0)
        travel = steps * (v[1:] + v[:-1]) / 2
    integral[good] = np.cumsum(np.where(np.isfinite(travel), travel, 0.0))
    return integral


def scale_to_degrees(time: LogChannel, velocity: LogChannel, forced: dict[str, str]) -> float:
    """Return the factor from velocity times time to deg, by the units forced or in the header."""
    seconds = forced.get(names.TIME) or units.canonical(time.unit or time.meaning.unit, names.TIME)
    written = units.canonical(velocity.unit or velocity.meaning.unit, names.VELOCITY)
    rate = forced.get(names.VELOCITY) or written
    return (
        units.FACTORS[names.TIME][seconds or "s"] * units.FACTORS[names.VELOCITY][rate or "deg/s"]
    )
