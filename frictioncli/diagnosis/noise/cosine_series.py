r"""Series of cosines over the ranges of angle, speed and temperature, and their products.

A quantity counts by its place *u* from 0 to 1 between the ends of the range that was measured, the
speed by its logarithm. The columns are :math:`\cos \pi k u`, of two quantities all products, each
with a weight that falls with the order *k*, so that a random function with independent coefficients
is smooth.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import EffectTable

HALF = 4.0
"""Order from which on the cosines of a function of the angle become weaker."""

_ALONE = {"position": 16, "speed": 6, "temperature": 5}
_IN_PRODUCT = {"position": 6, "speed": 3, "temperature": 3}
"""Greatest orders of the cosines."""

_LEAST_SPEED = 1e-9
"""Speeds below count as this. [deg/s]"""

AXES = ("position", "speed", "temperature")
"""Quantities that a series can depend on."""

Range = tuple[float, float]


def coordinate(axis: str, table: EffectTable) -> Array:
    """Return a quantity as series count it, shape (rows,): the logarithm of the speed.

    Parameters
    ----------
    axis : {"position", "speed", "temperature", "load"}
        The quantity.
    table : EffectTable
        The rows.
    """
    values = getattr(table, axis)
    return np.log(np.maximum(values, _LEAST_SPEED)) if axis == "speed" else np.asarray(values)


def ranges_of(table: EffectTable) -> dict[str, Range]:
    """Return the range of each quantity that varies over some rows, the speed's of its logarithm.

    Parameters
    ----------
    table : EffectTable
        The rows.
    """
    found = {}
    for axis in AXES:
        values = coordinate(axis, table)
        low, high = float(np.min(values)), float(np.max(values))
        if np.isfinite(high - low) and high - low > 1e-9 * max(abs(low), abs(high), 1e-9):
            found[axis] = (low, high)
    return found


@dataclass(frozen=True, slots=True)
class CosineSeries:
    """Columns of a function of one quantity or two.

    Attributes
    ----------
    axes : tuple of str
        The quantities: ``position``, ``speed``, ``temperature``.
    orders : tuple of int
        Greatest order of the cosines in each.
    """

    axes: tuple[str, ...]
    orders: tuple[int, ...]

    @classmethod
    def of(
        cls, axes: tuple[str, ...], table: EffectTable, ranges: Mapping[str, Range]
    ) -> "CosineSeries":
        """Return the series that the values of some rows can tell.

        Parameters
        ----------
        axes : tuple of str
            The quantities, all of which vary.
        table : EffectTable
            The rows.
        ranges : mapping of str to (float, float)
            Range of each quantity.
        """
        most = _ALONE if len(axes) == 1 else _IN_PRODUCT
        orders = []
        for axis in axes:
            place = _place(coordinate(axis, table), ranges[axis])
            orders.append(min(most[axis], len(np.unique(np.round(place, 6))) - 1))
        return cls(axes, tuple(orders))

    @property
    def weights(self) -> Array:
        """Weight of each column, shape (columns,)."""
        found = np.ones(1)
        for axis, most in zip(self.axes, self.orders, strict=True):
            order = np.arange(1, most + 1)
            own = 1 / (1 + np.square(order / HALF)) if axis == "position" else 1 / order
            found = np.multiply.outer(found, own).ravel()
        return found

    def columns(self, table: EffectTable, ranges: Mapping[str, Range]) -> Array:
        """Return the columns without weights, shape (rows, columns).

        Parameters
        ----------
        table : EffectTable
            The rows; beyond an end of a range counts as that end.
        ranges : mapping of str to (float, float)
            Range of each quantity.
        """
        found = np.ones((len(table.speed), 1))
        for axis, most in zip(self.axes, self.orders, strict=True):
            place = np.clip(_place(coordinate(axis, table), ranges[axis]), 0.0, 1.0)
            own = np.cos(np.pi * np.arange(1, most + 1) * place[:, np.newaxis])
            found = np.einsum("ij,ik->ijk", found, own).reshape(len(place), -1)
        return found


def _place(values: Array, within: Range) -> Array:
    """Return the places of values in a range, 0 and 1 at its ends."""
    low, high = within
    return np.asarray((values - low) / (high - low))
