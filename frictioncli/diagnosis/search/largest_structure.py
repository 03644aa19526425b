r"""Axis along which a misfit varies most, and whether it makes a model inadequate on a new run.

That axis is the one with the greatest RMS of bin means,

.. math:: s^2 = \sum_b w_b (m_b^2 - e_b^2),

with the share :math:`w_b` of the rows in a bin, their mean :math:`m_b` and its standard error
:math:`e_b` from the scatter between pairs. The mean over the whole run is taken off before: where
it is larger than all that varies, it is what counts.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.search.axis_columns import load_over_angle, varying_axes
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.distributions import chi2_tail
from frictioncli.effects.base import Channel

WHOLE_RUN = "run"
"""Axis of a misfit that is the same over the whole run."""

INADEQUATE = 2.5
"""Misfit of a new run relative to the noise, from which on a model lacks something that it has.

Days differ a little anyway, by what is weak and in no model: up to 2.4 on 90 simulated joints."""

BETWEEN_DAYS = 0.03
"""Least difference of the friction of a whole run from the others that is more than days differ by,
relative to the mean friction."""

LEAST_PART = 0.1
"""Share of the mean square of a misfit from which on it varies with an axis."""

_BINS = 8
"""Bins of equal filling along an axis of many values."""

_AXES = {
    "position": "position",
    "speed": "speed",
    "temperature": "temperature",
    "time": "clock",
    "load": "load",
}
"""Axes of the experiment, with the columns of the table that hold them."""


@dataclass(frozen=True, slots=True)
class AxisStructure:
    """Mean misfit along one axis.

    Attributes
    ----------
    axis : str
        The axis.
    channel : {"friction", "load"}
        The part of the torque.
    size : float
        RMS of the bin means, without what noise contributes. [N·m]
    interval : (float, float)
        95 % interval of that, from the scatter between pairs. [N·m]
    """

    axis: str
    channel: Channel
    size: float
    interval: tuple[float, float]


def left_structure(problem: Problem, friction: Array, load: Array) -> AxisStructure:
    """Return the axis along which a misfit has the most structure, or its mean if that is larger.

    Parameters
    ----------
    problem : Problem
        The rows.
    friction, load : ndarray, shape (rows,)
        Misfit in both channels. [N·m]
    """
    misfit: dict[Channel, Array] = {"friction": friction}
    if not problem.has_load_channel:
        misfit["load"] = load
    pair = problem.layout.row_pair
    means = [
        AxisStructure(WHOLE_RUN, channel, *_size(values, np.zeros_like(pair), pair))
        for channel, values in misfit.items()
    ]
    varying = largest_structure(
        problem, *(values - float(np.mean(values)) for values in misfit.values())
    )
    return max([varying, *means], key=lambda one: one.size)


def inadequacy(
    problem: Problem, friction: Array, load: Array, *, floor: float, margin: float
) -> Structure | None:
    """Return what a model lacks on a new run as structure; None where its misfit may be noise.

    Nothing along an axis that is below the margin is lacking, though several together may be above.
    Along time where it varies with nothing that is measured: it is of that run. By how much the
    friction of days differs anyway, in constant parts and in proportion, is not lacking.

    Parameters
    ----------
    problem : Problem
        Rows of the new run.
    friction, load : ndarray, shape (rows,)
        Misfit of the model in both channels. [N·m]
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    margin : float
        Smallest size worth a name. [N·m]
    """
    beyond = friction - _between_days(problem, friction)
    square = float(np.mean(problem.squared(beyond, load)))
    rest = square - floor**2
    if square <= (INADEQUATE * floor) ** 2 or rest <= margin**2:
        return None
    found = left_structure(problem, beyond, load)
    size, interval, pairs = found.size, found.interval, len(problem.layout.time)
    along, channel = found.axis, found.channel
    if channel == "friction" and along in _AXES:
        # along that axis, all of it is lacking
        size = size_along(problem, along, friction)
        interval = (interval[0] * size / found.size, interval[1] * size / found.size)
    if along == WHOLE_RUN:
        along = "time"
    elif size**2 < LEAST_PART * rest:
        along, size, interval = "time", float(np.sqrt(rest)), (0.0, np.inf)
        of_load = 0.0 if problem.has_load_channel else float(np.mean(np.square(load)))
        channel = "load" if of_load > square / 2 else "friction"
    if size <= margin:
        return None
    ratio = square / max(floor, 1e-9) ** 2
    return Structure(
        axes=(along,),
        channel=channel,
        # as if the pairs were all that is independent
        p_value=chi2_tail(pairs * ratio, pairs),
        statistic=pairs * (ratio - 1.0),
        size=size,
        interval=interval,
        only_on=problem.runs[-1],
    )


def size_along(problem: Problem, axis: str, misfit: Array) -> float:
    """Return how much a misfit varies along an axis, RMS of its bin means without noise [N·m].

    Parameters
    ----------
    problem : Problem
        The rows.
    axis : str
        The axis.
    misfit : ndarray, shape (rows,)
        Misfit in one channel. [N·m]
    """
    bins = _bins(getattr(problem.table, _AXES[axis]))
    return _size(misfit - float(np.mean(misfit)), bins, problem.layout.row_pair)[0]


def _between_days(problem: Problem, misfit: Array) -> Array:
    """Return the part of a misfit of friction by which days differ; 0 where that is too much."""
    simulated = problem.friction - misfit
    columns = np.column_stack([np.ones_like(simulated), simulated])
    part = np.asarray(columns @ np.linalg.lstsq(columns, misfit)[0])
    most = BETWEEN_DAYS * float(np.mean(np.abs(problem.friction)))
    return part if float(np.sqrt(np.mean(np.square(part)))) < most else np.zeros_like(part)


def largest_structure(
    problem: Problem, friction: Array, load: Array | None = None
) -> AxisStructure:
    """Return the axis and channel along which a misfit has the most structure.

    Axes along which nothing varies are left out.

    Parameters
    ----------
    problem : Problem
        The rows.
    friction, load : ndarray, shape (rows,)
        Misfit in both channels; no load where it is not simulated. [N·m]
    """
    varying = varying_axes(problem)
    if load_over_angle(problem) is not None:
        # bins do not show which of both it is: structure along the angle is the simpler statement
        varying -= {"load"}
    channels: dict[Channel, Array] = {"friction": friction}
    if load is not None:
        channels["load"] = load
    found = [
        AxisStructure(axis, channel, *_size(values, _bins(getattr(problem.table, column)), pair))
        for axis, column in _AXES.items()
        if axis in varying
        for channel, values in channels.items()
        for pair in [problem.layout.row_pair]
    ]
    return max(found, key=lambda one: one.size)


def _bins(values: Array) -> Indices:
    """Return the bin of each row, at most eight, equally filled where there are more values."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _BINS + 1)[1:-1]))
    return np.searchsorted(edges, values, side="left")


def _size(misfit: Array, bins: Indices, pair: Indices) -> tuple[float, tuple[float, float]]:
    """Return the RMS of the means in bins, without what the scatter between pairs gives.

    With its 95 % interval.
    """
    pairs = int(pair.max(initial=0)) + 1
    cells, cell, rows = np.unique(bins * pairs + pair, return_inverse=True, return_counts=True)
    means = np.bincount(cell, misfit) / rows
    own = cells // pairs
    count, inside = np.bincount(own), np.bincount(own, rows)
    used = count > 1
    mean = np.bincount(own, rows * means) / np.maximum(inside, 1.0)
    # a pair counts by its rows, as in the RMS of the misfit
    scatter = np.bincount(own, np.square(rows * (means - mean[own])))[used]
    count, inside, mean = count[used], inside[used], mean[used]
    error = scatter / np.square(inside) * count / (count - 1)
    weight = inside / max(inside.sum(), 1.0)
    square = float(weight @ (np.square(mean) - error))
    reach = 2 * Z95 * float(np.sqrt(np.sum(np.square(weight * mean) * error)))
    size, low, high = (
        float(np.sqrt(max(one, 0.0))) for one in (square, square - reach, square + reach)
    )
    return size, (low, high)
