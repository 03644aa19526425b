r"""What the extended model still misses, and along which axis.

A model is adequate where its misfit on a run that it has not seen is that of the noise,
:math:`r \approx n`. From :math:`r > 1.25\,n` on something is left, of RMS
:math:`\sqrt{r^2 - n^2}`. The axis along which it shows most is that with the greatest RMS of bin
means,

.. math:: s^2 = \sum_b w_b (m_b^2 - e_b^2),

with the share :math:`w_b` of the rows in a bin, their mean :math:`m_b` and its standard error
:math:`e_b` from the scatter between pairs. The mean over the whole run is taken off before: where
it is larger than all that varies, it is what is told.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.diagnose import Diagnosis, predicting
from frictioncli.diagnosis.documents.remainder_record import WHOLE_RUN, RemainderRecord
from frictioncli.diagnosis.fit.extension import misfits
from frictioncli.diagnosis.search.axis_columns import load_over_angle, varying_axes
from frictioncli.diagnosis.search.new_run_changes import ADEQUATE

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
    """

    axis: str
    channel: str
    size: float


def remainder_record(diagnosis: Diagnosis) -> RemainderRecord | None:
    """Return what a diagnosis leaves on the rows it is judged on; None where that is noise.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis of a joint.
    """
    problem, extension, floor = diagnosis.judged, diagnosis.extension, diagnosis.floor
    friction, load = (
        (problem.friction_misfit, problem.load_misfit)
        if extension is None
        else misfits(problem, predicting(extension, diagnosis.causes))
    )
    rmse = float(np.sqrt(np.mean(problem.squared(friction, load))))
    if rmse <= ADEQUATE * floor:
        return None
    whole = {"friction": float(np.mean(friction))}
    if not problem.has_load_channel:
        whole["load"] = float(np.mean(load))
    varying = {"friction": friction, "load": load}
    most = largest_structure(problem, *(varying[name] - mean for name, mean in whole.items()))
    for channel, mean in whole.items():
        if abs(mean) > most.size:
            most = AxisStructure(WHOLE_RUN, channel, abs(mean))
    return RemainderRecord(
        basis="within_run" if diagnosis.held_out is None else "new_run",
        rmse=rmse,
        noise_floor=floor,
        size=float(np.sqrt(rmse**2 - floor**2)),
        axis=most.axis,
        channel=most.channel,
        axis_size=most.size,
    )


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
    channels = {"friction": friction} if load is None else {"friction": friction, "load": load}
    found = [
        AxisStructure(axis, channel, _size(values, _bins(getattr(problem.table, column)), pair))
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


def _size(misfit: Array, bins: Indices, pair: Indices) -> float:
    """Return the RMS of the means in bins, without what the scatter between pairs gives."""
    cells, cell = np.unique(np.stack([bins, pair]), axis=1, return_inverse=True)
    cell = cell.reshape(-1)
    means = np.bincount(cell, misfit) / np.bincount(cell)
    count = np.bincount(cells[0])
    used = count > 1
    mean = np.bincount(cells[0], means)[used] / count[used]
    scatter = np.bincount(cells[0], np.square(means))[used] / count[used] - np.square(mean)
    error = np.maximum(scatter, 0.0) / (count[used] - 1)
    weight = count[used] / max(count[used].sum(), 1)
    return float(np.sqrt(max(weight @ (np.square(mean) - error), 0.0)))
