"""Columns that describe any torque along one axis of the experiment, or along two."""

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.base import Channel
from frictioncli.linear_algebra import orthonormal_basis

_HARMONICS = 12
"""Harmonics of the joint angle."""

_COSINES = 10
"""Cosines over the range of temperature or load."""

_HALF_WAVES = (5.0, 10.0)
"""Half a period of the finest cosine over a stroke, a usual angle bin; and two, where moves over
different parts of the stroke are too few for more. [deg]"""

_MOST_OF_PAIRS = 0.5
"""Greatest number of columns that differ from pair to pair, as a share of the pairs."""

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

_CENTRAL = (0.05, 0.95)
"""Quantiles between which a quantity must vary for its axis to be told from others."""

_LEAST_RELATIVE = 0.05
"""Least spread of speed relative to its mean, and of load relative to its greatest."""

_OF_SPEED = 4
"""Cosines over the logarithm of the speed in products with the angle."""

_LEAST_SPEED = 1e-3
"""Least speed relative to the mean, of which there is a logarithm."""

_LEAST_LOAD = 0.02
"""Least spread of a simulated load relative to the mean friction: less carries no structure."""

_LEAST_ANGLE = 5.0
"""Least spread of the joint angle. [deg]"""

_LEAST_TEMPERATURE = 1.0
"""Least spread of the temperature: one step of a register. [°C]"""

_TOLD = 0.02
"""Spread of the load at an angle, relative to its whole spread, below which the angle tells it."""

_TWICE = 0.5
"""Share of the angles whose amount of load must occur at other angles too, so that friction which
depends on the load differs from friction which depends on the angle."""


def varying_axes(problem: Problem) -> frozenset[str]:
    """Return the axes along which the quantity varies; time always does.

    Where all pairs have one speed, functions of angle and speed are functions of the angle: no data
    can show that something depends on what is always the same.

    Parameters
    ----------
    problem : Problem
        The rows.
    """
    table = problem.table
    load = _LEAST_RELATIVE * float(np.max(np.abs(table.load)))
    if not problem.has_load_channel:
        load = max(load, _LEAST_LOAD * float(np.mean(np.abs(problem.friction))))
    least = {
        "position": (table.position, _LEAST_ANGLE),
        "speed": (table.speed, _LEAST_RELATIVE * float(np.mean(table.speed))),
        "temperature": (table.temperature, _LEAST_TEMPERATURE),
        "load": (table.load, load),
    }
    varying = (name for name, (values, spread) in least.items() if _spread(values) > spread)
    return frozenset(["time", *varying])


def _spread(values: Array) -> float:
    return float(np.ptp(np.quantile(values, _CENTRAL)))


def load_over_angle(problem: Problem) -> Array | None:
    """Return the load at each angle; None where it is no function of the angle.

    With one payload and pose it is one, and what goes with the load goes with the angle, too.

    Parameters
    ----------
    problem : Problem
        The rows.

    Returns
    -------
    ndarray, shape (angles,), or None
        The mean load at each angle, in the order of angles. [N·m]
    """
    load = problem.table.load
    angles, place = np.unique(np.round(problem.table.position, 3), return_inverse=True)
    mean = np.bincount(place, load) / np.bincount(place)
    is_told = len(angles) > 1 and np.std(load - mean[place]) < _TOLD * np.std(load)
    return mean if is_told else None


def friction_tells_load(problem: Problem) -> bool:
    """Return whether friction along the load differs from friction along the angle.

    Friction is the same for loads to either side. Where most amounts of load occur at one angle
    only, functions of the load are functions of the angle, and the angle is the simpler statement.

    Parameters
    ----------
    problem : Problem
        The rows.
    """
    load = load_over_angle(problem)
    if load is None:
        return True
    amount = np.abs(load)
    rises = np.diff(amount) > 0
    branches = np.split(amount, np.flatnonzero(rises[1:] != rises[:-1]) + 2)
    within = [(amount >= one.min()) & (amount <= one.max()) for one in branches]
    return bool(np.mean(np.sum(within, axis=0) > 1) > _TWICE)


def axis_columns(problem: Problem) -> dict[tuple[tuple[str, ...], Channel], Array]:
    """Return columns by axis and channel, shape (rows, columns) each.

    Axes along which nothing varies are left out, and a measured load as the axis of itself.

    Parameters
    ----------
    problem : Problem
        The rows.
    """
    table = problem.table
    angle = np.radians(table.position)
    harmonics = _harmonics(angle, _HARMONICS)
    speed = _indicators(problem.layout.level)[problem.layout.row_pair]
    temperature = cosines(table.temperature)
    # a stroke of less than a turn has finer structure than harmonics of a turn show; the load has
    # as many columns, so that which of both it is does not depend on how fine they are
    for half_wave in _HALF_WAVES:
        halves = max(round(float(np.ptp(table.position)) / half_wave), _COSINES)
        position = np.hstack([harmonics, cosines(table.position, halves)])
        if can_be_judged(problem, position):
            break
    load = cosines(table.load, halves)
    # friction is the same for loads to either side: with one payload that tells it from the angle
    amount = np.abs(table.load)
    part = float(np.ptp(amount)) / max(float(np.ptp(table.load)), 1e-9)
    of_load = cosines(amount, max(round(part * halves), _COSINES))
    time = cosines(table.clock)[:, :_WAVES]
    warming = _HYSTERESIS * (2 * _rising(problem) - 1)[:, np.newaxis]
    squared = np.square(table.load)[:, np.newaxis] / max(float(np.max(np.square(table.load))), 1e-9)
    # over a part of a turn a wave has a mean, whose product with a quantity is one of that alone
    waves = harmonics[:, : 2 * _SLOW_HARMONICS] - harmonics[:, : 2 * _SLOW_HARMONICS].mean(axis=0)
    levels = _levels(table.temperature)
    relative_temperature = ((table.temperature - table.temperature.mean()) / 10.0)[:, np.newaxis]
    relative_speed = (table.speed / table.speed.mean())[:, np.newaxis]
    columns: dict[tuple[tuple[str, ...], Channel], Array] = {
        (("speed",), "friction"): speed,
        (("temperature",), "friction"): np.hstack([temperature, warming * temperature]),
        (("position",), "friction"): position,
        (("position",), "load"): position,
        (("load",), "friction"): of_load,
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
    varying = varying_axes(problem)
    if problem.has_load_channel:
        # along a measured load its own noise is structure
        del columns[("load",), "load"]
    if not friction_tells_load(problem):
        del columns[("load",), "friction"]
    return {place: values for place, values in columns.items() if varying.issuperset(place[0])}


def angle_and_speed(problem: Problem) -> Array:
    """Return columns of angle and speed with as many functions of the speed as those of the load.

    A law of the logarithm of the speed is none of the speed alone, and with few functions of it the
    load, which has all levels of the speed, would be likelier than the angle.

    Parameters
    ----------
    problem : Problem
        The rows.

    Returns
    -------
    ndarray, shape (rows, columns)
    """
    speed = problem.table.speed / problem.table.speed.mean()
    of_logarithm = cosines(np.log(np.maximum(speed, _LEAST_SPEED)), _OF_SPEED)
    waves = _harmonics(np.radians(problem.table.position), _SLOW_HARMONICS)
    return _products(waves, np.column_stack([speed, of_logarithm]))


def can_be_judged(problem: Problem, columns: Array) -> bool:
    """Return whether columns leave enough pairs to know the noise of the pair means by.

    Parameters
    ----------
    problem : Problem
        The rows.
    columns : ndarray, shape (rows, columns)
        The columns.
    """
    means = problem.layout.means(columns)
    rank = orthonormal_basis(means, tolerance=1e-7).shape[1]
    return bool(rank <= _MOST_OF_PAIRS * len(means))


def cosines(values: Array, count: int = _COSINES) -> Array:
    """Return weighted cosines over the range of a quantity, shape (rows, count).

    Parameters
    ----------
    values : ndarray, shape (rows,)
        The quantity.
    count : int, optional
        Number of cosines.
    """
    unit = (values - np.min(values)) / max(float(np.ptp(values)), 1e-9)
    orders = np.arange(1, count + 1)
    return np.asarray(_weights(orders) * np.cos(np.pi * orders * unit[:, np.newaxis]))


def _harmonics(angle: Array, count: int) -> Array:
    """Return weighted sines and cosines of an angle in rad, in turn, shape (rows, 2 * count)."""
    orders = np.arange(1, count + 1)
    waves = [wave(order * angle) for order in orders for wave in (np.sin, np.cos)]
    return np.asarray(_weights(np.repeat(orders, 2)) * np.column_stack(waves))


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
