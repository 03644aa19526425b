"""Which column is the derivative of which: that tells position, velocity and their units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import unit_evidence
from frictioncli.logs.channels.unit_evidence import MotionUnits
from frictioncli.logs.channels.units import FACTORS

_ALIKE = 0.97
"""Least cosine between the change of one column and the integral of another."""

_FULL = 8
_SHORT = 200


@dataclass(frozen=True, slots=True)
class Derivative:
    """A column and its derivative.

    Attributes
    ----------
    position, velocity : int
        Columns.
    cosine : float
        How alike change and integral are, 1 at most.
    units : MotionUnits
        Units of time, position and velocity with which the two fit.
    travel : float
        Way of the position, there and back. [its unit]
    """

    position: int
    velocity: int
    cosine: float
    units: MotionUnits
    travel: float


def derivatives(found: Probe, time: int, time_units: Sequence[str]) -> list[Derivative]:
    """Return pairs of a column and its derivative whose units can be told, most alike first.

    A velocity is no position although its acceleration may be in the file too.

    Parameters
    ----------
    found : Probe
        The beginning of the log.
    time : int
        Column of the time.
    time_units : sequence of str
        Units that the time may have.
    """
    columns = [column for column in found.values if column != time]
    if not columns:
        return []
    changes, areas = _windows(found, time, columns)
    cosines = _unit_rows(changes) @ _unit_rows(areas).T
    np.fill_diagonal(cosines, 0.0)
    alike = np.abs(cosines)
    pairs = []
    for i, j in zip(*np.nonzero(alike > _ALIKE), strict=True):
        if alike[:, i].max() > alike[i, j]:
            continue  # itself a derivative: a velocity and its acceleration
        ratio = float(changes[i] @ areas[j] / (areas[j] @ areas[j]))
        position = found.values[columns[i]]
        fitting = _units(position, ratio, time_units)
        if fitting is not None:
            travel = float(np.abs(np.diff(position)).sum())
            pairs.append(Derivative(columns[i], columns[j], float(alike[i, j]), fitting, travel))
    return sorted(pairs, key=lambda pair: -pair.cosine)


def _windows(found: Probe, time: int, columns: Sequence[int]) -> tuple[Array, Array]:
    """Return each column's change over short windows, and its integral over the same windows."""
    clock = found.values[time]
    steps = np.diff(clock)
    width = 1 if len(steps) < _SHORT else _FULL
    period = float(np.median(steps))
    elapsed = clock[width:] - clock[:-width]
    even = (elapsed > 0) & (elapsed < 2 * width * period)
    changes, areas = [], []
    for column in columns:
        values = found.values[column]
        area = np.concatenate(([0.0], np.cumsum(steps * (values[1:] + values[:-1]) / 2)))
        changes.append((values[width:] - values[:-width])[even])
        areas.append((area[width:] - area[:-width])[even])
    return np.array(changes), np.array(areas)


def _unit_rows(rows: Array) -> Array:
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    return rows / np.where(lengths > 0, lengths, 1.0)


def _units(position: Array, ratio: float, time_units: Sequence[str]) -> MotionUnits | None:
    """Return the units that fit; None where no usual ones do."""
    possible, _ = unit_evidence.possible_position_units(
        largest=float(np.max(np.abs(position))),
        span=float(np.ptp(position)),
        on_motor=False,
        path_per_angle=None,
    )
    for time_unit in time_units:
        scaled = ratio / FACTORS[names.TIME][time_unit]
        found = unit_evidence.motion_units(
            declared=("s", None, None), possible=possible, ratio=scaled
        )
        if found.velocity is not None and found.time == "s":
            return MotionUnits(
                time_unit, found.position, found.velocity, found.reversed_velocity, found.evidence
            )
    return None
