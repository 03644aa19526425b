"""The ramps of moves: what lies before and behind the constant-velocity part, as a small table.

Accelerating after a reversal and braking before the next one are of no use for separating friction
from load, but they show what the constant-velocity part hides: inertia, and friction that is not
yet built up. A ramp takes a few tenths of a second, so it is reduced by the angle from the turning
point in geometric steps, and follows the first stretch at constant velocity too.
"""

from typing import NamedTuple

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.array_runs import members, reduced
from frictioncli.pairs.chunks import BEHIND
from frictioncli.pairs.constant_speed import ConstantSpeedParts
from frictioncli.pairs.moves import samples_in

EDGES = np.geomspace(0.1, 30.0, 13)
"""Edges of the bins of distance from the turning point. [deg]"""

PARTS = ("accelerating", "braking")
"""The two halves of a move: distance counts from its beginning, or to its end."""

LAGS = {
    "acceleration": 0,
    "acceleration_before": -1,
    "acceleration_after": 1,
    "acceleration_2_before": -2,
    "acceleration_2_after": 2,
}
"""By how many samples acceleration is taken later than torque: what lags may be told from."""

MEANS = (
    "time",
    "motor_temperature",
    "housing_temperature",
    "position",
    "velocity",
    "torque",
    "load",
)
_MOTION = (*LAGS, "distance", "spread", "elapsed")

COLUMNS = ("move", "part", "direction", "reversal", "speed", "bin", *MEANS, *_MOTION, "samples")
"""Columns of the rows; ``move`` counts from 0 in the parts given, ``part`` in :data:`PARTS`."""

_KINDS = dict.fromkeys(COLUMNS, np.float64) | {
    "move": np.int64,
    "part": np.int64,
    "direction": np.int64,
    "reversal": np.bool_,
    "bin": np.int64,
    "samples": np.int64,
}

_HALF_SPAN = 0.015
"""Half of the time over which velocity is differentiated. [s]"""

_MOST_NEIGHBOURS = 500
"""A clock that is read in a wrong unit must not make windows of a million samples."""

_ROLLING = 0.25
"""A move that begins or ends above this share of its speed is cut off there, not turned round."""

_AWAY = 1.0
"""A joint that rings about its turning point stays nearer to it. [deg]"""


class ComingFrom(NamedTuple):
    """The last move before some samples: its direction, 0 where not known, and where it ended.

    ``since`` counts in those samples, and is below 0 where the move ended before them.
    """

    way: int = 0
    since: int = 0


def ramp_rows(
    channels: dict[str, Array], parts: ConstantSpeedParts, period: float, came_from: ComingFrom
) -> dict[str, Array]:
    """Return the ramps of moves as means per bin of distance from the turning point.

    Parameters
    ----------
    channels : dict of str to ndarray, shape (samples,)
        time, position, velocity, torque, load, motor_temperature, housing_temperature of one
        recording and joint. [s], [deg], [deg/s], [N·m], [N·m], [°C], [°C]
    parts : ConstantSpeedParts
        The constant-velocity parts, with the bounds of their moves.
    period : float
        Time between samples. [s]
    came_from : ComingFrom
        The last move before these parts.

    Returns
    -------
    dict of str to ndarray, shape (rows,)
        The :data:`COLUMNS`. Accelerations at :data:`LAGS` [deg/s²]; ``spread`` is the standard
        deviation of the angle [deg], ``elapsed`` the time since the move began, or until it
        ends [s].
    """
    low, high, origin, clock = _halves(channels, parts)
    index = members(low, high)
    owner = np.repeat(np.arange(len(low)), high - low)
    distance = np.abs(channels["position"][index] - origin[owner])
    inside = (distance >= EDGES[0]) & (distance < EDGES[-1])
    index, owner, distance = index[inside], owner[inside], distance[inside]
    if not index.size:
        return {name: np.empty(0, kind) for name, kind in _KINDS.items()}
    number = np.searchsorted(EDGES, distance, side="right") - 1
    values = {name: channels[name][index] for name in MEANS}
    time = channels["time"]
    half = min(max(samples_in(_HALF_SPAN, period), 1), _MOST_NEIGHBOURS)
    acceleration = slope(time, channels["velocity"], half)
    for name, shift in LAGS.items():
        values[name] = acceleration[np.clip(index + shift, 0, len(time) - 1)]
    # torque as an average over the same window as the acceleration it goes with
    values["torque"] = window_mean(time, channels["torque"], half)[index]
    values["distance"] = distance
    values["spread"] = np.square(distance)
    values["elapsed"] = np.abs(values["time"] - clock[owner])
    key = owner * (len(EDGES) - 1) + number
    count = np.bincount(key)
    hit = np.flatnonzero(count)
    means = {name: np.bincount(key, value)[hit] / count[hit] for name, value in values.items()}
    means["spread"] = np.sqrt(np.maximum(means["spread"] - np.square(means["distance"]), 0.0))
    owner, number = np.divmod(hit, len(EDGES) - 1)
    speed = parts.speed[owner // 2]
    rows = means | {
        "move": owner // 2,
        "part": owner % 2,
        "direction": np.sign(speed).astype(np.int64),
        "reversal": _turned(channels["position"], parts, came_from)[owner // 2],
        "speed": np.abs(speed),
        "bin": number,
        "samples": count[hit],
    }
    return {name: rows[name] for name in COLUMNS}


def slope(time: Array, values: Array, half: int) -> Array:
    """Return the local slope of a channel; exact for ramps at any spacing.

    Parameters
    ----------
    time, values : ndarray, shape (samples,)
        Growing times and the channel. [s], any
    half : int
        Neighbours on either side; beyond the ends stands the last sample.

    Returns
    -------
    ndarray, shape (samples,)
        Slope. [1/s] of the channel's unit
    """
    rise, run = (np.zeros(len(time)) for _ in range(2))
    for step in range(1, half + 1):
        rise += step * _across(values, step)
        run += step * _across(time, step)
    return np.divide(rise, run, out=np.zeros_like(rise), where=run > 0)


def window_mean(time: Array, values: Array, half: int) -> Array:
    """Return the mean of a channel over the window of :func:`slope`: the slope of its integral.

    Parameters
    ----------
    time, values : ndarray, shape (samples,)
        Growing times and the channel. [s], any
    half : int
        Neighbours on either side.
    """
    area = np.diff(time) * (values[1:] + values[:-1]) / 2
    padded = np.concatenate([np.zeros(half), area, np.zeros(half)])
    window, rise, run = (np.zeros(len(time)) for _ in range(3))
    for step in range(1, half + 1):
        window += padded[half + step - 1 :][: len(time)] + padded[half - step :][: len(time)]
        rise += step * window
        run += step * _across(time, step)
    return np.divide(rise, run, out=np.zeros_like(rise), where=run > 0)


def _across(values: Array, step: int) -> Array:
    """Return the difference between the samples so many steps later and earlier."""
    padded = np.pad(values, step, mode="edge")
    return padded[2 * step :] - padded[: -2 * step]


def _halves(
    channels: dict[str, Array], parts: ConstantSpeedParts
) -> tuple[Numbers, Numbers, Array, Array]:
    """Return first and past-the-end sample, turning angle and its time of both halves of moves.

    A half whose end is cut off by the recording has no samples.
    """
    time, position, velocity = (channels[name] for name in ("time", "position", "velocity"))
    middle = (parts.first + parts.last) // 2
    low = np.column_stack([parts.first, middle]).ravel()
    high = np.column_stack([middle, parts.last]).ravel()
    end = np.column_stack([parts.first, parts.last - 1]).ravel()
    forward = parts.speed > 0
    lowest = np.column_stack([forward, ~forward]).ravel()
    turn = np.where(
        lowest, reduced(np.minimum, position, low, high), reduced(np.maximum, position, low, high)
    )
    cut_off = np.abs(velocity[end]) > _ROLLING * np.repeat(np.abs(parts.speed), 2)
    return low, np.where(cut_off, low, high), turn, time[end]


def _turned(position: Array, parts: ConstantSpeedParts, came_from: ComingFrom) -> Flags:
    """Return whether each move goes the other way than the joint came; so does one after nothing.

    The way it came is that of the last angle further away than :data:`_AWAY`, or else that of the
    move before. Standing is looked through: friction remembers the way, not the rest.
    """
    way = np.sign(parts.speed).astype(np.int64)
    since = np.append(came_from.since, parts.stop[:-1])
    since = np.clip(since, parts.first - BEHIND, parts.first).clip(min=0)
    length = parts.first - since
    behind = position[members(since, parts.first)] - np.repeat(position[parts.first], length)
    away = np.flatnonzero(np.abs(behind) > _AWAY)
    end = np.cumsum(length)
    last = np.searchsorted(away, end) - 1
    seen = last >= np.searchsorted(away, end - length)
    came = np.append(came_from.way, way[:-1])
    came[seen] = -np.sign(behind[away[last[seen]]])
    return way != came
