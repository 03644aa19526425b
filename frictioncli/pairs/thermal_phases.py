"""Heat-up and cool-down: phases found from the trend of the motor temperature."""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frictioncli.arrays import Numbers

HEAT_UP, COOL_DOWN, SWEEP = "heat-up", "cool-down", "sweep"

_TURN = 3.0
"""A smaller reversal of the temperature is noise, not a new phase. [K]"""

_LEAST_SWING = 5.0
"""A smaller change of temperature is neither heating nor cooling. [K]"""


class _Point(NamedTuple):
    pair: int
    value: float


class ThermalPhase(NamedTuple):
    """Heat-up or cool-down from pair ``begin`` to ``end`` (excluded) of a run and joint."""

    begin: int
    end: int
    name: str


def phases(temperature: Iterable[float]) -> list[ThermalPhase]:
    """Return the thermal phases of a run in time order; pairs in none of them belong to a sweep.

    Parameters
    ----------
    temperature : iterable of float
        Motor temperature of each pair in time order, NaN where unknown. [°C]

    Returns
    -------
    list of ThermalPhase
        Heat-up and cool-down phases.

    Notes
    -----
    The temperatures are cut where they reverse by more than 3 K. Between two cuts, a rise by 5 K or
    more is heat-up, a fall by as much is cool-down, and anything else is a sweep.

    Examples
    --------
    >>> phases([20.0, 25.0, 30.0, 27.0, 22.0])
    [ThermalPhase(begin=0, end=3, name='heat-up'), ThermalPhase(begin=3, end=5, name='cool-down')]
    """
    known = (_Point(pair, value) for pair, value in enumerate(temperature) if math.isfinite(value))
    turns = _turning_points(known)
    found = []
    for first, last in pairwise(turns):
        swing = last.value - first.value
        if abs(swing) >= _LEAST_SWING:
            begin = first.pair + (first is not turns[0])
            found.append(ThermalPhase(begin, last.pair + 1, HEAT_UP if swing > 0 else COOL_DOWN))
    return found


def phases_of(pair: Numbers, found: list[ThermalPhase]) -> NDArray[np.object_]:
    """Return the name of each pair's phase.

    Parameters
    ----------
    pair : ndarray of int, shape (pairs,)
        Numbers of the pairs, as :func:`phases` counted them.
    found : list of ThermalPhase
        Phases of their run and joint.

    Returns
    -------
    ndarray of str, shape (pairs,)
        ``heat-up``, ``cool-down`` or ``sweep``.
    """
    names = np.array([*(phase.name for phase in found), SWEEP], dtype=object)
    begin, end = (np.array([phase[i] for phase in found], dtype=np.int64) for i in (0, 1))
    number = np.searchsorted(begin, pair, side="right") - 1
    inside = number >= 0
    inside[inside] = pair[inside] < end[number[inside]]
    return names[np.where(inside, number, len(found))]


def _turning_points(points: Iterable[_Point]) -> list[_Point]:
    """Return first, last and turning points of a sequence, without small reversals."""
    points = iter(points)
    first = next(points, None)
    if first is None:
        return []
    turns = [first]
    low = high = last = first
    rising: bool | None = None
    for point in points:
        last = point
        high = point if point.value > high.value else high
        low = point if point.value < low.value else low
        if rising is not False and point.value < high.value - _TURN:
            if abs(high.value - turns[-1].value) > _TURN:
                turns.append(high)
            rising, low, high = False, point, point
        elif rising is not True and point.value > low.value + _TURN:
            if abs(low.value - turns[-1].value) > _TURN:
                turns.append(low)
            rising, low, high = True, point, point
    return [*turns, last]
