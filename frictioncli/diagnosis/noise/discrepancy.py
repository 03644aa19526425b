r"""Smooth discrepancy: what every model of a joint gets wrong a little, as random functions.

No equation is exactly true. Beside the noise of the measurement, the torque has a discrepancy: the
sum of random functions of angle, speed and temperature and of their products, in friction and in
load [1]_. Each function is a series of cosines

.. math:: f(u) = \omega \sum_k s_k \gamma_k \cos \pi k u, \quad \gamma_k \sim N(0, 1)

over the range of its quantity, with :math:`s_k` falling with *k*, so that it is smooth. The
coefficients of the base model are free, so that only the part of a function that is orthogonal to
the base counts [2]_. The amplitude :math:`\omega` of each function has a lognormal prior about
1 % of the mean friction, shared among the functions, and is estimated with each rival in place.

References
----------
.. [1] M. C. Kennedy and A. O'Hagan, "Bayesian calibration of computer models," J. R. Stat. Soc. B
   63(3), 2001, doi:10.1111/1467-9868.00294.
.. [2] M. Plumlee, "Bayesian calibration of inexact computer models," J. Am. Stat. Assoc. 112(519),
   2017, doi:10.1080/01621459.2016.1211016.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import ModelColumns, reduced
from frictioncli.effects.base import EffectTable

SHARE = 0.01
"""RMS of the whole discrepancy that is expected beforehand, relative to the mean friction."""

SPREAD = 0.7
"""Standard deviation of the natural logarithm of each function's amplitude beforehand."""

_HALF = 4.0
"""Order from which on the cosines of a function of the angle become weaker."""

_ANGLE, _ANGLE_IN_PRODUCT, _SPEED, _TEMPERATURE = 16, 6, 6, 5
"""Greatest orders of the cosines."""


@dataclass(frozen=True, slots=True)
class Component:
    """A random function of the discrepancy.

    Attributes
    ----------
    axes : tuple of str
        The quantities that it depends on: ``position``, ``speed``, ``temperature``.
    channel : {"friction", "load"}
        The channel in which it shows.
    columns : slice
        Its columns.
    """

    axes: tuple[str, ...]
    channel: Literal["friction", "load"]
    columns: slice


@dataclass(frozen=True, slots=True, kw_only=True)
class Discrepancy:
    """Columns of the discrepancy, a random function after the other.

    Attributes
    ----------
    components : tuple of Component
        The functions.
    friction, load : ndarray, shape (rows, columns)
        Their columns in both channels: of each function the squares sum to 1 on average.
    columns : ModelColumns
        The same, reduced.
    amplitude : float
        RMS of each function that is expected beforehand. [N·m]
    """

    components: tuple[Component, ...]
    friction: Array
    load: Array
    columns: ModelColumns
    amplitude: float

    @property
    def widths(self) -> Array:
        """Number of columns of each function, shape (components,)."""
        return np.array([one.columns.stop - one.columns.start for one in self.components], float)


def discrepancy_of(problem: Problem, share: float = SHARE) -> Discrepancy:
    """Return the discrepancy over the rows of a problem.

    Parameters
    ----------
    problem : Problem
        One joint's rows.
    share : float, optional
        RMS of the whole discrepancy relative to the mean friction; 0 for none.
    """
    friction = _functions(problem.table, _FRICTION)
    load = [] if problem.has_load_channel else _functions(problem.table, _LOAD)
    if share == 0:
        friction, load = [], []
    parts = [("friction", *one) for one in friction] + [("load", *one) for one in load]
    count, rows = sum(one[2].shape[1] for one in parts), len(problem.friction)
    columns = {channel: np.zeros((rows, count)) for channel in ("friction", "load")}
    components, first = [], 0
    for channel, axes, values in parts:
        place = slice(first, first + values.shape[1])
        columns[channel][:, place] = values
        components.append(Component(axes, channel, place))  # type: ignore[arg-type]
        first = place.stop
    mean = float(np.mean(np.abs(problem.friction)))
    return Discrepancy(
        components=tuple(components),
        friction=columns["friction"],
        load=columns["load"],
        columns=reduced(problem.layout, columns["friction"], columns["load"]),
        amplitude=share * mean / np.sqrt(max(len(components), 1)),
    )


_FRICTION = (
    ("position",),
    ("speed",),
    ("temperature",),
    ("position", "speed"),
    ("position", "temperature"),
    ("speed", "temperature"),
)

_LOAD = (
    ("position",),
    ("speed",),
    ("temperature",),
    ("position", "speed"),
    ("position", "temperature"),
)


def _functions(
    table: EffectTable, wanted: tuple[tuple[str, ...], ...]
) -> list[tuple[tuple[str, ...], Array]]:
    """Return the axes and the columns of each function whose quantities vary."""
    unit = {
        "position": _unit(table.position),
        "speed": _unit(np.log(np.maximum(table.speed, 1e-9))),
        "temperature": _unit(table.temperature),
    }
    found = []
    for axes in wanted:
        values = [unit[axis] for axis in axes]
        if any(np.ptp(one) == 0 for one in values):
            continue
        alone = len(axes) == 1
        columns = _cosines(axes[0], values[0], alone=alone)
        for axis, one in zip(axes[1:], values[1:], strict=True):
            second = _cosines(axis, one, alone=False)
            columns = np.einsum("ij,ik->ijk", columns, second).reshape(len(one), -1)
        square = float(np.sum(np.mean(np.square(columns), axis=0)))
        if square > 0:
            found.append((axes, columns / np.sqrt(square)))
    return found


def _unit(values: Array) -> Array:
    """Return values from 0 to 1; zeros where they do not vary."""
    span = float(np.ptp(values))
    if not np.isfinite(span) or span <= 1e-9 * max(float(np.max(np.abs(values))), 1e-9):
        return np.zeros_like(values)
    return (values - np.min(values)) / span


def _cosines(axis: str, unit: Array, *, alone: bool) -> Array:
    """Return weighted cosines of growing order over a range, shape (rows, orders)."""
    distinct = len(np.unique(np.round(unit, 6)))
    most = {"position": _ANGLE, "speed": _SPEED, "temperature": _TEMPERATURE}[axis]
    if not alone:
        most = {"position": _ANGLE_IN_PRODUCT, "speed": 3, "temperature": 3}[axis]
    order = np.arange(1, min(most, distinct - 1) + 1)
    weight = 1 / (1 + np.square(order / _HALF)) if axis == "position" else 1 / order
    return np.asarray(weight * np.cos(np.pi * order * unit[:, np.newaxis]))
