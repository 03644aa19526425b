"""Table of friction over speed, temperature and load for linear interpolation."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from frictioncli.arrays import Array
from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.operating_conditions import OperatingConditions
from frictioncli.errors import OptionError

Axes = tuple[Array, Array, Array]

_PARTS = 4
"""Number of parts of each cell in which the interpolation error is evaluated."""

_MOST_ROWS = 50_000
"""Greatest number of rows."""

_RELATIVE_TOLERANCE = 1e-3
"""Default interpolation error, relative to the greatest friction."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LookupTable:
    """Table for linear interpolation.

    Attributes
    ----------
    axes : tuple of ndarray
        Increasing knots of speed [deg/s], temperature [°C] and load [N·m].
    friction : ndarray, shape (speeds, temperatures, loads)
        Friction torque at the knots, rounded as in the file. [torque unit]
    error : float
        Greatest interpolation error between the knots. [torque unit]
    tolerance : float
        Greatest error allowed. [torque unit]
    """

    axes: Axes
    friction: Array
    error: float
    tolerance: float


def lookup_table(
    joint: DeployedModel, conditions: OperatingConditions, tolerance: float | None
) -> LookupTable:
    r"""Return a coarse table whose interpolation error is within a tolerance.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    conditions : OperatingConditions
        Range of speeds; temperatures and loads cover the range of the data.
    tolerance : float or None
        Greatest interpolation error; None: a thousandth of the greatest friction. [torque unit]

    Raises
    ------
    OptionError
        If the table would be too long.

    Notes
    -----
    The error of linear interpolation is greatest where the curvature is. Knots are equally spaced
    in a scale that equalises it: the fourth root of speed, because friction depends on the square
    root, and :math:`e^{-\delta T/2}`. Knots are added along the axis with the greatest error until
    the error on a grid four times as fine is within the tolerance. The number of digits follows
    from the tolerance.
    """
    delta = joint.base.delta
    loads = 0.0, max(map(abs, conditions.loads))  # friction depends on the absolute load
    tolerance = tolerance_of(joint, conditions, tolerance)
    digits = max(0, int(np.ceil(-np.log10(tolerance))) + 2)
    counts = [
        2 if low < high else 1 for low, high in (conditions.speeds, conditions.temperatures, loads)
    ]
    while True:
        axes = _axes(counts, conditions, loads, delta)
        if np.prod(counts) > _MOST_ROWS:
            raise OptionError(
                f"--tolerance {tolerance:g}: the table would have more than {_MOST_ROWS} rows;"
                " allow more, or fewer speeds"
            )
        table = np.round(_friction(joint, axes), digits)
        errors = [
            _interpolation_error(
                joint, axes, table, finer=tuple(_PARTS if i == axis else 1 for i in range(3))
            )
            for axis in range(3)
        ]
        if max(errors) <= tolerance:
            error = _interpolation_error(joint, axes, table, finer=(_PARTS, _PARTS, _PARTS))
            if error <= tolerance:
                return LookupTable(axes=axes, friction=table, error=error, tolerance=tolerance)
        worst = int(np.argmax(errors))
        counts[worst] += max(1, counts[worst] // 8)


def tolerance_of(
    joint: DeployedModel, conditions: OperatingConditions, tolerance: float | None
) -> float:
    """Return the greatest interpolation error: a thousandth of the greatest friction by default.

    Parameters
    ----------
    joint, conditions, tolerance
        As of :func:`lookup_table`.
    """
    if tolerance is not None:
        return tolerance
    speeds, temperatures = np.array(conditions.speeds), np.array(conditions.temperatures)
    corners = speeds, temperatures, np.array([0.0, max(map(abs, conditions.loads))])
    return _RELATIVE_TOLERANCE * float(np.max(_friction(joint, corners)))


def csv_text(table: LookupTable, columns: Sequence[str], remarks: Sequence[str]) -> str:
    """Return a table as CSV: remarks as comments, column names with units, one row per knot."""
    lines = [*(f"# {line}" for line in remarks), ",".join(columns)]
    for place in product(*(range(len(axis)) for axis in table.axes)):
        knots = [axis[i] for axis, i in zip(table.axes, place, strict=True)]
        lines.append(",".join(f"{value:.9g}" for value in (*knots, table.friction[place])))
    return "\n".join(lines) + "\n"


def _axes(
    counts: Sequence[int], conditions: OperatingConditions, loads: tuple[float, float], delta: float
) -> Axes:
    low, high = conditions.speeds
    speed = np.linspace(low**0.25, high**0.25, counts[0]) ** 4
    cold, hot = conditions.temperatures
    temperature = np.linspace(cold, hot, counts[1])
    if delta > 0:
        ends = np.exp(-delta * cold / 2), np.exp(-delta * hot / 2)
        temperature = -2 * np.log(np.linspace(*ends, counts[1])) / delta
    return (
        _rounded(speed, conditions.speeds),
        _rounded(temperature, conditions.temperatures),
        _rounded(np.linspace(*loads, counts[2]), loads),
    )


def _rounded(knots: Array, ends: tuple[float, float]) -> Array:
    """Return knots rounded as in the file, with exact ends."""
    knots[0], knots[-1] = ends
    return np.array([float(f"{value:.9g}") for value in knots])


def _friction(joint: DeployedModel, axes: Axes) -> Array:
    speed, temperature, load = np.meshgrid(*axes, indexing="ij")
    return joint.friction(load=load, speed=speed, temperature=temperature)


def _interpolation_error(
    joint: DeployedModel, axes: Axes, table: Array, finer: tuple[int, ...]
) -> float:
    """Return the greatest interpolation error on a grid that is finer by a factor per axis."""
    speed, temperature, load = (
        np.interp(np.arange((len(axis) - 1) * parts + 1) / parts, np.arange(len(axis)), axis)
        for axis, parts in zip(axes, finer, strict=True)
    )
    between = (speed, temperature, load)
    interpolated = table
    for number, (axis, values) in enumerate(zip(axes, between, strict=True)):
        interpolated = _interpolate(interpolated, number, axis, values)
    return float(np.max(np.abs(interpolated - _friction(joint, between))))


def _interpolate(table: Array, number: int, knots: Array, values: Array) -> Array:
    """Return a table linearly interpolated along one of its axes."""
    if len(knots) == 1:
        return table
    left = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, len(knots) - 2)
    share = (values - knots[left]) / (knots[left + 1] - knots[left])
    share = np.expand_dims(share, [axis for axis in range(3) if axis != number])
    low: Array = np.take(table, left, axis=number)
    high: Array = np.take(table, left + 1, axis=number)
    return np.asarray(low + share * (high - low))
