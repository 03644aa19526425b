"""Ramps of moves: means per bin of distance from the turning point.

Accelerating after a reversal and braking before the next one cannot be used to separate friction
from load, but they show what a constant-speed segment hides: inertia, and friction that has not
built up yet. A ramp takes a few tenths of a second. It is averaged in bins of the angle from the
turning point, in geometric steps, which reach into the constant-speed segment.
"""

from typing import NamedTuple

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.chunks import NEIGHBOURS_BEFORE
from frictioncli.pairs.constant_speed import ConstantSpeedSegments
from frictioncli.pairs.moves import samples_in
from frictioncli.pairs.slices import reduce_slices, slice_indices

EDGES = np.geomspace(0.1, 30.0, 13)
"""Edges of the bins of distance from the turning point. [deg]"""

PARTS = ("accelerating", "braking")
"""Halves of a move: distance counts from its start, or to its end."""

LAGS = {
    "acceleration": 0,
    "acceleration_before": -1,
    "acceleration_after": 1,
    "acceleration_2_before": -2,
    "acceleration_2_after": 2,
}
"""Samples by which acceleration is taken later than torque, for models with a lag."""

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

SHARED = "shared"
"""Whether another joint moved; beside the columns."""

COLUMNS = ("move", "part", "direction", "reversal", "speed", "bin", *MEANS, *_MOTION, "samples")
"""Columns of the rows; ``move`` is the number of the segment, ``part`` that in :data:`PARTS`."""

_KINDS = dict.fromkeys(COLUMNS, np.float64) | {
    "move": np.int64,
    "part": np.int64,
    "direction": np.int64,
    "reversal": np.bool_,
    "bin": np.int64,
    "samples": np.int64,
    SHARED: np.bool_,
}

_HALF_WINDOW = 0.015
"""Half of the time over which velocity is differentiated. [s]"""

_MOST_NEIGHBOURS = 500
"""Bound on the window, for clocks that were read in a wrong unit. [samples]"""

_CUT_OFF_SPEED = 0.25
"""A move that begins or ends above this share of its speed is cut off there, not reversed."""

_RINGING = 1.0
"""Greatest oscillation of a joint about its turning point. [deg]"""


class PreviousMove(NamedTuple):
    """The last move before a chunk.

    Attributes
    ----------
    direction : int
        +1 or -1; 0 where unknown.
    stop : int
        Past-the-end sample of its segment, counted in the chunk; negative where it lies before.
    """

    direction: int = 0
    stop: int = 0


def ramp_means(
    channels: dict[str, Array],
    segments: ConstantSpeedSegments,
    period: float,
    previous: PreviousMove,
) -> dict[str, Array]:
    """Return the ramps of moves as means per bin of distance from the turning point.

    Parameters
    ----------
    channels : dict of str to ndarray, shape (samples,)
        time, position, velocity, torque, load, motor_temperature, housing_temperature and
        other_speed of one recording and joint. [s], [deg], [deg/s], [N·m], [N·m], [°C], [°C],
        [deg/s]
    segments : ConstantSpeedSegments
        Constant-speed segments, with the bounds of their moves.
    period : float
        Sampling period. [s]
    previous : PreviousMove
        The last move before these segments.

    Returns
    -------
    dict of str to ndarray, shape (rows,)
        The :data:`COLUMNS` and :data:`SHARED`: accelerations at :data:`LAGS` [deg/s²]; ``spread``
        is the standard deviation of the angle [deg]; ``elapsed`` is the time since the start of the
        move, or until its end. [s]
    """
    low, high, origin, clock = _halves(channels, segments)
    index = slice_indices(low, high)
    owner = np.repeat(np.arange(len(low)), high - low)
    distance = np.abs(channels["position"][index] - origin[owner])
    inside = (distance >= EDGES[0]) & (distance < EDGES[-1])
    index, owner, distance = index[inside], owner[inside], distance[inside]
    if not index.size:
        return {name: np.empty(0, kind) for name, kind in _KINDS.items()}
    number = np.searchsorted(EDGES, distance, side="right") - 1
    values = {name: channels[name][index] for name in MEANS}
    time = channels["time"]
    half = min(max(samples_in(_HALF_WINDOW, period), 1), _MOST_NEIGHBOURS)
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
    shared = np.bincount(key, channels["other_speed"][index] > 0)[hit] > 0
    means = {name: np.bincount(key, value)[hit] / count[hit] for name, value in values.items()}
    means["spread"] = np.sqrt(np.maximum(means["spread"] - np.square(means["distance"]), 0.0))
    owner, number = np.divmod(hit, len(EDGES) - 1)
    speed = segments.speed[owner // 2]
    rows = means | {
        "move": owner // 2,
        "part": owner % 2,
        "direction": np.sign(speed).astype(np.int64),
        "reversal": _reversed(channels["position"], segments, previous)[owner // 2],
        "speed": np.abs(speed),
        "bin": number,
        "samples": count[hit],
        SHARED: shared,
    }
    return {name: rows[name] for name in (*COLUMNS, SHARED)}


def slope(time: Array, values: Array, half: int) -> Array:
    """Return the local slope of a channel; exact for ramps at any spacing.

    Parameters
    ----------
    time, values : ndarray, shape (samples,)
        Increasing times and the channel. [s], [any unit]
    half : int
        Neighbours on either side; beyond the ends the last sample is repeated.

    Returns
    -------
    ndarray, shape (samples,)
        Slope. [unit of the channel per s]

    Examples
    --------
    >>> slope(np.arange(4.0), np.array([0.0, 2.0, 4.0, 6.0]), 1)
    array([2., 2., 2., 2.])
    """
    rise, run = (np.zeros(len(time)) for _ in range(2))
    for step in range(1, half + 1):
        rise += step * _central_difference(values, step)
        run += step * _central_difference(time, step)
    return np.divide(rise, run, out=np.zeros_like(rise), where=run > 0)


def window_mean(time: Array, values: Array, half: int) -> Array:
    """Return the mean of a channel over the window of :func:`slope`: the slope of its integral.

    Parameters
    ----------
    time, values : ndarray, shape (samples,)
        Increasing times and the channel. [s], [any unit]
    half : int
        Neighbours on either side.

    Returns
    -------
    ndarray, shape (samples,)
        Means. [unit of the channel]

    Examples
    --------
    >>> window_mean(np.arange(4.0), np.full(4, 3.0), 1)
    array([3., 3., 3., 3.])
    """
    area = np.diff(time) * (values[1:] + values[:-1]) / 2
    padded = np.concatenate([np.zeros(half), area, np.zeros(half)])
    window, rise, run = (np.zeros(len(time)) for _ in range(3))
    for step in range(1, half + 1):
        window += padded[half + step - 1 :][: len(time)] + padded[half - step :][: len(time)]
        rise += step * window
        run += step * _central_difference(time, step)
    return np.divide(rise, run, out=np.zeros_like(rise), where=run > 0)


def _central_difference(values: Array, step: int) -> Array:
    """Return the difference between the samples ``step`` later and ``step`` earlier."""
    padded = np.pad(values, step, mode="edge")
    return padded[2 * step :] - padded[: -2 * step]


def _halves(
    channels: dict[str, Array], segments: ConstantSpeedSegments
) -> tuple[Numbers, Numbers, Array, Array]:
    """Return first and past-the-end sample, turning angle and its time for both halves of moves.

    A half whose end is cut off by the recording is empty.
    """
    time, position, velocity = (channels[name] for name in ("time", "position", "velocity"))
    middle = (segments.move_start + segments.move_stop) // 2
    low = np.column_stack([segments.move_start, middle]).ravel()
    high = np.column_stack([middle, segments.move_stop]).ravel()
    end = np.column_stack([segments.move_start, segments.move_stop - 1]).ravel()
    forward = segments.speed > 0
    lowest = np.column_stack([forward, ~forward]).ravel()
    turn = np.where(
        lowest,
        reduce_slices(np.minimum, position, low, high),
        reduce_slices(np.maximum, position, low, high),
    )
    cut_off = np.abs(velocity[end]) > _CUT_OFF_SPEED * np.repeat(np.abs(segments.speed), 2)
    return low, np.where(cut_off, low, high), turn, time[end]


def _reversed(position: Array, segments: ConstantSpeedSegments, previous: PreviousMove) -> Flags:
    """Return whether each move goes against the motion before it; true where that is unknown.

    The direction before is that from the last angle further away than :data:`_RINGING`, or else
    that of the previous move. A rest in between makes no difference to friction.
    """
    direction = np.sign(segments.speed).astype(np.int64)
    since = np.append(previous.stop, segments.stop[:-1])
    since = np.clip(since, segments.move_start - NEIGHBOURS_BEFORE, segments.move_start).clip(min=0)
    length = segments.move_start - since
    offset = position[slice_indices(since, segments.move_start)] - np.repeat(
        position[segments.move_start], length
    )
    distant = np.flatnonzero(np.abs(offset) > _RINGING)
    end = np.cumsum(length)
    last = np.searchsorted(distant, end) - 1
    seen = last >= np.searchsorted(distant, end - length)
    before = np.append(previous.direction, direction[:-1])
    before[seen] = -np.sign(offset[distant[last[seen]]])
    return direction != before
