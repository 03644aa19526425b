"""Columns that describe any torque along one axis of the experiment, or along two."""

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.base import Channel

_HARMONICS = 12
"""Harmonics of the joint angle."""

_COSINES = 10
"""Cosines over the range of temperature or load."""

_HALF = 5.0
"""Order from which on harmonics and cosines become weaker: nature is smooth."""

_WAVES = 6
"""Cosines over the time of the experiment."""

_LEVELS = 8
"""Quantile bins of a continuous quantity in products."""

_SLOW_HARMONICS = 4
"""Harmonics of the angle in products with another quantity."""

_HYSTERESIS = 0.5
"""Amplitude of the difference between warming and cooling, relative to a function's own."""

_MOST_LEVELS = 16
"""Speed levels with a column of their own."""


def axis_columns(problem: Problem) -> dict[tuple[tuple[str, ...], Channel], Array]:
    """Return columns by axis and channel, shape (rows, columns) each."""
    table = problem.table
    angle = np.radians(table.position)
    orders = np.repeat(np.arange(1, _HARMONICS + 1), 2)
    harmonics = _weights(orders) * np.column_stack(
        [wave(n * angle) for n in range(1, _HARMONICS + 1) for wave in (np.sin, np.cos)]
    )
    speed = _indicators(problem.layout.level)[problem.layout.row_pair]
    temperature, load = _cosines(table.temperature), _cosines(table.load)
    time = _cosines(table.clock)[:, :_WAVES]
    warming = _HYSTERESIS * (2 * _rising(problem) - 1)[:, np.newaxis]
    squared = np.square(table.load)[:, np.newaxis] / max(float(np.max(np.square(table.load))), 1e-9)
    waves = harmonics[:, : 2 * _SLOW_HARMONICS]
    levels = _levels(table.temperature)
    relative_temperature = ((table.temperature - table.temperature.mean()) / 10.0)[:, np.newaxis]
    relative_speed = (table.speed / table.speed.mean())[:, np.newaxis]
    return {
        (("speed",), "friction"): speed,
        (("temperature",), "friction"): np.hstack([temperature, warming * temperature]),
        (("position",), "friction"): harmonics,
        (("position",), "load"): harmonics,
        (("load",), "friction"): load,
        (("load",), "load"): load,
        (("time",), "load"): np.hstack([time, time * np.cos(angle)[:, np.newaxis]]),
        (("load", "speed"), "friction"): squared * speed,
        (("load", "temperature"), "friction"): squared * levels,
        (("speed", "temperature"), "friction"): _products(_levels(table.speed), levels),
        (("position", "temperature"), "friction"): waves * relative_temperature,
        (("position", "speed"), "friction"): waves * relative_speed,
        (("position", "time"), "friction"): _products(waves, time[:, :2]),
        (("position", "speed"), "load"): waves * relative_speed,
        (("speed",), "load"): speed,
        (("temperature",), "load"): np.hstack([levels, levels * np.cos(angle)[:, np.newaxis]]),
    }


def _cosines(values: Array) -> Array:
    """Return weighted cosines over the range of a quantity, shape (rows, orders)."""
    unit = (values - np.min(values)) / max(float(np.ptp(values)), 1e-9)
    orders = np.arange(1, _COSINES + 1)
    return np.asarray(_weights(orders) * np.cos(np.pi * orders * unit[:, np.newaxis]))


def _weights(orders: Indices) -> Array:
    return np.asarray(1 / (1 + np.square(orders / _HALF)))


def _levels(values: Array) -> Array:
    """Return an indicator column per level of a quantity, at most eight, equally filled."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _LEVELS + 1)[1:-1]))
    return np.eye(len(edges) + 1)[np.searchsorted(edges, values, side="left")]


def _indicators(level: Indices) -> Array:
    """Return an indicator column per level, the rarest ones together beyond sixteen."""
    names, place, count = np.unique(level, return_inverse=True, return_counts=True)
    common = np.argsort(-count)[:_MOST_LEVELS]
    column = np.full(len(names), len(common))
    column[common] = np.arange(len(common))
    return np.eye(len(common) + 1)[column[place]]


def _products(first: Array, second: Array) -> Array:
    """Return the product of each column of one array with each of another, shape (rows, -1)."""
    return np.einsum("ij,ik->ijk", first, second).reshape(len(first), -1)


def _rising(problem: Problem) -> Array:
    """Return 1 where the temperature rises over nine neighbouring pairs, else 0, shape (rows,)."""
    layout = problem.layout
    temperature = layout.means(problem.table.temperature[:, np.newaxis])[:, 0]
    trend = np.gradient(
        np.convolve(np.pad(temperature, 4, mode="edge"), np.full(9, 1 / 9), "valid")
    )
    return (trend > 0).astype(float)[layout.row_pair]
