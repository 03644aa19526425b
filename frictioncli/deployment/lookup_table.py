"""A table of friction over speed, temperature and load, as fine as linear interpolation needs."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from frictioncli.arrays import Array
from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.operating_conditions import Conditions
from frictioncli.errors import OptionError

Axes = tuple[Array, Array, Array]

_FINER = 4
"""Parts into which each cell is cut to see what interpolation misses in it."""

_MOST_ROWS = 50_000

_SHARE = 1e-3
"""Error of interpolation that nobody sees, as a share of the greatest friction."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Lookup:
    """A table to interpolate linearly.

    Attributes
    ----------
    axes : tuple of ndarray
        Knots of speed, temperature and load, growing. [deg/s], [°C], [N·m]
    friction : ndarray, shape (speeds, temperatures, loads)
        Friction torque at the knots, rounded as the file has it. [torque unit]
    error : float
        Greatest miss of interpolation between the knots. [torque unit]
    tolerance : float
        What it was allowed to be. [torque unit]
    """

    axes: Axes
    friction: Array
    error: float
    tolerance: float


def lookup(joint: DeployedModel, where: Conditions, tolerance: float | None) -> Lookup:
    r"""Return the coarsest table whose interpolation keeps the tolerance.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    where : Conditions
        Speeds to cover; temperatures and loads are those of the data.
    tolerance : float or None
        Greatest error of interpolation; a share of the greatest friction if none. [torque unit]

    Raises
    ------
    OptionError
        If the table would be too long.

    Notes
    -----
    Linear interpolation misses most where a function bends. Knots are even in a scale in which the
    bend is even: the fourth root of speed, as friction goes with its square root, and
    :math:`e^{-\delta T/2}`. Knots are added where they gain most, until what was measured on a
    grid four times as fine keeps the tolerance. A table has as many digits as that needs.
    """
    delta = joint.base.delta
    loads = 0.0, max(map(abs, where.loads))  # friction does not know the load's sign
    if tolerance is None:
        corners = tuple(np.array(ends) for ends in (where.speeds, where.temperatures, loads))
        tolerance = _SHARE * float(np.max(_friction(joint, corners)))  # type: ignore[arg-type]
    digits = max(0, int(np.ceil(-np.log10(tolerance))) + 2)
    counts = [2 if low < high else 1 for low, high in (where.speeds, where.temperatures, loads)]
    while True:
        axes = _axes(counts, where, loads, delta)
        if np.prod(counts) > _MOST_ROWS:
            raise OptionError(
                f"--tolerance {tolerance:g}: the table would have more than {_MOST_ROWS} rows;"
                " allow more, or fewer speeds"
            )
        table = np.round(_friction(joint, axes), digits)
        alone = [
            _missed(joint, axes, table, finer=tuple(_FINER if i == axis else 1 for i in range(3)))
            for axis in range(3)
        ]
        if max(alone) <= tolerance:
            error = _missed(joint, axes, table, finer=(_FINER, _FINER, _FINER))
            if error <= tolerance:
                return Lookup(axes=axes, friction=table, error=error, tolerance=tolerance)
        worst = int(np.argmax(alone))
        counts[worst] += max(1, counts[worst] // 8)


def csv_text(table: Lookup, columns: Sequence[str], remarks: Sequence[str]) -> str:
    """Return the table as CSV: remarks behind ``#``, names with units, a row per knot."""
    lines = [*(f"# {line}" for line in remarks), ",".join(columns)]
    for place in product(*(range(len(axis)) for axis in table.axes)):
        knots = [axis[i] for axis, i in zip(table.axes, place, strict=True)]
        lines.append(",".join(f"{value:.9g}" for value in (*knots, table.friction[place])))
    return "\n".join(lines) + "\n"


def _axes(
    counts: Sequence[int], where: Conditions, loads: tuple[float, float], delta: float
) -> Axes:
    low, high = where.speeds
    speed = np.linspace(low**0.25, high**0.25, counts[0]) ** 4
    cold, hot = where.temperatures
    temperature = np.linspace(cold, hot, counts[1])
    if delta > 0:
        ends = np.exp(-delta * cold / 2), np.exp(-delta * hot / 2)
        temperature = -2 * np.log(np.linspace(*ends, counts[1])) / delta
    return (
        _rounded(speed, where.speeds),
        _rounded(temperature, where.temperatures),
        _rounded(np.linspace(*loads, counts[2]), loads),
    )


def _rounded(knots: Array, ends: tuple[float, float]) -> Array:
    """Return knots as the file has them, with the ends themselves."""
    knots[0], knots[-1] = ends
    return np.array([float(f"{value:.9g}") for value in knots])


def _friction(joint: DeployedModel, axes: Axes) -> Array:
    speed, temperature, load = np.meshgrid(*axes, indexing="ij")
    return joint.friction(load=load, speed=speed, temperature=temperature)


def _missed(joint: DeployedModel, axes: Axes, table: Array, finer: tuple[int, ...]) -> float:
    """Return the greatest miss of interpolation, each axis cut so many times finer."""
    speed, temperature, load = (
        np.interp(np.arange((len(axis) - 1) * parts + 1) / parts, np.arange(len(axis)), axis)
        for axis, parts in zip(axes, finer, strict=True)
    )
    between = (speed, temperature, load)
    shown = table
    for number, (axis, wanted) in enumerate(zip(axes, between, strict=True)):
        shown = _interpolated(shown, number, axis, wanted)
    return float(np.max(np.abs(shown - _friction(joint, between))))


def _interpolated(table: Array, number: int, knots: Array, wanted: Array) -> Array:
    """Return a table linearly interpolated along one of its axes."""
    if len(knots) == 1:
        return table
    left = np.clip(np.searchsorted(knots, wanted, side="right") - 1, 0, len(knots) - 2)
    share = (wanted - knots[left]) / (knots[left + 1] - knots[left])
    share = np.expand_dims(share, [axis for axis in range(3) if axis != number])
    low: Array = np.take(table, left, axis=number)
    high: Array = np.take(table, left + 1, axis=number)
    return np.asarray(low + share * (high - low))
