"""Find columns that are derivatives of others: positions, velocities and their units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import position_units, unit_evidence
from frictioncli.logs.channels.column_name import unit_in_name
from frictioncli.logs.channels.unit_evidence import MotionUnits
from frictioncli.logs.channels.units import FACTORS, ONLY_WRITTEN

_LEAST_COSINE = 0.97
"""Least cosine between the change of a column and the integral of its derivative."""
_WINDOW = 8
"""Length of a window in long logs. [samples]"""
_SHORT_LOG = 200
"""Below this length, windows are one sample long. [samples]"""


@dataclass(frozen=True, slots=True)
class Derivative:
    """A column and its derivative.

    Attributes
    ----------
    position, velocity : int
        Columns.
    cosine : float
        Cosine between the change of position and the integral of velocity. [-]
    units : MotionUnits
        Units of time, position and velocity with which the two agree.
    travel : float
        Total travel of the position in both directions. [raw]
    """

    position: int
    velocity: int
    cosine: float
    units: MotionUnits
    travel: float


def find_derivatives(head: LogHead, time: int, time_units: Sequence[str]) -> list[Derivative]:
    """Return the pairs of a column and its derivative that agree in some units, best first.

    A velocity is not returned as a position, even if the acceleration is in the log too.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    time : int
        Column of the time.
    time_units : sequence of str
        Possible units of the time.
    """
    columns = [column for column in head.values if column != time]
    if not columns:
        return []
    changes, integrals = _over_windows(head, time, columns)
    cosines = _normalised_rows(changes) @ _normalised_rows(integrals).T
    np.fill_diagonal(cosines, 0.0)
    similarity = np.abs(cosines)
    found = []
    for i, j in zip(*np.nonzero(similarity > _LEAST_COSINE), strict=True):
        if similarity[:, i].max() > similarity[i, j]:
            continue  # itself a derivative: a velocity with its acceleration
        ratio = float(changes[i] @ integrals[j] / (integrals[j] @ integrals[j]))
        position = head.values[columns[i]]
        written = (
            unit_in_name(head.names[columns[i]], names.POSITION),
            unit_in_name(head.names[columns[j]], names.VELOCITY),
        )
        fitting = _fitting_units(position, ratio, time_units, written)
        if fitting is not None:
            travel = float(np.abs(np.diff(position)).sum())
            cosine = float(similarity[i, j])
            found.append(Derivative(columns[i], columns[j], cosine, fitting, travel))
    return sorted(found, key=lambda derivative: -derivative.cosine)


def _over_windows(head: LogHead, time: int, columns: Sequence[int]) -> tuple[Array, Array]:
    """Return the change and the integral of each column over windows, shape (columns, windows)."""
    clock = head.values[time]
    steps = np.diff(clock)
    width = 1 if len(steps) < _SHORT_LOG else _WINDOW
    period = float(np.median(steps))
    elapsed = clock[width:] - clock[:-width]
    without_gap = (elapsed > 0) & (elapsed < 2 * width * period)
    changes, integrals = [], []
    for column in columns:
        values = head.values[column]
        integral = np.concatenate(([0.0], np.cumsum(steps * (values[1:] + values[:-1]) / 2)))
        changes.append((values[width:] - values[:-width])[without_gap])
        integrals.append((integral[width:] - integral[:-width])[without_gap])
    return np.array(changes), np.array(integrals)


def _normalised_rows(rows: Array) -> Array:
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    return rows / np.where(lengths > 0, lengths, 1.0)


def _fitting_units(
    position: Array, ratio: float, time_units: Sequence[str], written: tuple[str | None, str | None]
) -> MotionUnits | None:
    """Return units that agree with the ratio of change to integral; None where none do.

    Units of position and velocity that are written in the header are preferred.
    """
    largest, span = float(np.max(np.abs(position))), float(np.ptp(position))
    usual = position_units.usual_position_unit(largest=largest, span=span, on_motor=False)
    possible, _ = position_units.possible_position_units(
        largest=largest, span=span, on_motor=False, paths_per_angle=()
    )
    if written[0] in ONLY_WRITTEN:
        possible = frozenset({written[0]})
    for time_unit in time_units:
        scaled = ratio / FACTORS[names.TIME][time_unit]
        found = unit_evidence.motion_units(
            declared=("s", *written), possible=possible, ratio=scaled, usual=usual
        )
        if found.velocity is not None and found.time == "s":
            return MotionUnits(
                time_unit, found.position, found.velocity, found.reversed_velocity, found.evidence
            )
    return None
