"""The ramps of moves: what lies before and behind the constant-velocity part, as a small table.

Accelerating after a reversal and braking before the next one are of no use for separating friction
from load, but they show what the constant-velocity part hides: inertia, and friction that is not
yet built up. A ramp takes a few tenths of a second, so it is reduced by the angle from the turning
point in geometric steps, and follows the first stretch at constant velocity too.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from frictioncli.motion.steady import SteadyPart

Array = NDArray[np.float64]

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

_HALF_SPAN = 0.015
"""Half of the time over which velocity is differentiated. [s]"""

_ROLLING = 0.25
"""A move that begins or ends above this share of its speed is cut off there, not turned round."""

_AWAY = 1.0
"""A joint that rings about its turning point stays nearer to it. [deg]"""


def ramp_rows(
    channels: dict[str, Array], parts: Sequence[SteadyPart], came_from: int = 0
) -> dict[str, Array]:
    """Return the ramps of moves as means per bin of distance from the turning point.

    Parameters
    ----------
    channels : dict of str to ndarray, shape (samples,)
        time, position, velocity, torque, load, motor_temperature, housing_temperature of one
        recording and joint. [s], [deg], [deg/s], [N·m], [N·m], [°C], [°C]
    parts : sequence of SteadyPart
        The constant-velocity parts, with the bounds of their moves.
    came_from : int
        Direction of the last move before these samples; 0 where it is not known.

    Returns
    -------
    dict of str to ndarray, shape (rows,)
        The :data:`COLUMNS`. Accelerations at :data:`LAGS` [deg/s²]; ``spread`` is the standard
        deviation of the angle [deg], ``elapsed`` the time since the move began, or until it
        ends [s].
    """
    if not parts:
        return {name: np.empty(0) for name in COLUMNS}
    halves = _halves(channels, parts)
    index = np.concatenate([np.arange(low, high) for low, high, _, _ in halves])
    owner = np.repeat(np.arange(len(halves)), [high - low for low, high, _, _ in halves])
    origin, clock = (np.array([half[i] for half in halves]) for i in (2, 3))
    distance = np.abs(channels["position"][index] - origin[owner])
    number = np.searchsorted(EDGES, distance, side="right") - 1
    inside = (number >= 0) & (number < len(EDGES) - 1)
    index, owner, number = index[inside], owner[inside], number[inside]
    if not index.size:
        return {name: np.empty(0) for name in COLUMNS}
    values = {name: channels[name][index] for name in MEANS}
    time = channels["time"]
    for name, shift in LAGS.items():
        values[name] = slope(time, channels["velocity"], index + shift)
    # torque as an average over the same window as the acceleration it goes with
    values["torque"] = slope(time, _integral(time, channels["torque"]), index)
    values["distance"] = distance[inside]
    values["spread"] = np.square(distance[inside])
    values["elapsed"] = np.abs(values["time"] - clock[owner])
    key = owner * (len(EDGES) - 1) + number
    count = np.bincount(key)
    hit = np.flatnonzero(count)
    means = {name: np.bincount(key, value)[hit] / count[hit] for name, value in values.items()}
    means["spread"] = np.sqrt(np.maximum(means["spread"] - np.square(means["distance"]), 0.0))
    owner, number = np.divmod(hit, len(EDGES) - 1)
    speed = np.array([part.speed for part in parts])[owner // 2]
    return means | {
        "move": owner // 2,
        "part": owner % 2,
        "direction": np.sign(speed),
        "reversal": _turned(channels["position"], parts, came_from)[owner // 2],
        "speed": np.abs(speed),
        "bin": number,
        "samples": count[hit],
    }


def _integral(time: Array, values: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(np.diff(time) * (values[1:] + values[:-1]) / 2)])


def slope(time: Array, values: Array, index: NDArray[np.intp]) -> Array:
    """Return the local slope of a channel around some samples; exact for ramps at any spacing.

    Parameters
    ----------
    time, values : ndarray, shape (samples,)
        Growing times and the channel. [s], any
    index : ndarray of int
        Samples wanted; beyond the ends stands the last one.

    Returns
    -------
    ndarray
        Slope. [1/s] of the channel's unit
    """
    last = len(time) - 1
    period = float(np.median(np.diff(time))) if last > 0 else _HALF_SPAN
    half = max(int(_HALF_SPAN / max(period, 1e-9)), 1)
    middle = np.clip(index, 0, last)
    rise, run = np.zeros(len(index)), np.zeros(len(index))
    for step in range(1, half + 1):
        low, high = np.maximum(middle - step, 0), np.minimum(middle + step, last)
        rise += step * (values[high] - values[low])
        run += step * (time[high] - time[low])
    return np.divide(rise, run, out=np.zeros_like(rise), where=run > 0)


def _halves(
    channels: dict[str, Array], parts: Sequence[SteadyPart]
) -> list[tuple[int, int, float, float]]:
    """Return first and past-the-end sample, turning angle and its time of both halves of moves.

    A half whose end is cut off by the recording has no samples.
    """
    time, position, velocity = (channels[name] for name in ("time", "position", "velocity"))
    halves = []
    for part in parts:
        middle = (part.first + part.last) // 2
        rolling = _ROLLING * abs(part.speed)
        forward = part.speed > 0
        for low, high, end, lowest in (
            (part.first, middle, part.first, forward),
            (middle, part.last, part.last - 1, not forward),
        ):
            if abs(velocity[end]) > rolling or low >= high:
                halves.append((low, low, 0.0, 0.0))
                continue
            turn = position[low:high].min() if lowest else position[low:high].max()
            halves.append((low, high, float(turn), float(time[end])))
    return halves


def _turned(position: Array, parts: Sequence[SteadyPart], came_from: int) -> NDArray[np.bool_]:
    """Return whether each move goes the other way than the joint came; so does one after nothing.

    The way it came is that of the last angle further away than :data:`_AWAY`, or else that of the
    move before. Standing is looked through: friction remembers the way, not the rest.
    """
    turned = []
    since = 0
    for part in parts:
        behind = position[since : part.first] - position[part.first]
        away = np.flatnonzero(np.abs(behind) > _AWAY)
        way = -np.sign(behind[away[-1]]) if away.size else came_from
        came_from, since = (1 if part.speed > 0 else -1), part.stop
        turned.append(way != came_from)
    return np.array(turned)
