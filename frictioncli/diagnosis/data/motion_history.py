"""What a joint has been through before each pair: rests, hours, way travelled."""

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.model.zero_load import PAIR_KEY

_SERIES_GAP = 120.0
"""A pause longer than this begins a new measuring series. [s]"""

_WARMED = 0.2
"""A motor warmer by more than this after a pause has been moved in it. [°C]"""

_LEAST_PACE = 0.4
"""It was moved all the time if it warmed at least so fast, relative to the median of such pauses; a
longer pause with some motion in it tells neither heating nor cooling."""


def series(layout: PairLayout, temperature: Array) -> tuple[Array, Array]:
    """Return the rest before each pair's measuring series, and the pair's place in it.

    A joint whose motor is warmer after a pause than before it has moved in between, unrecorded:
    such a pause is no rest. Before a run's first series the joint has rested for long.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    temperature : ndarray, shape (pairs,)
        Motor temperature of each pair; NaN where unknown: then every pause is a rest. [°C]

    Returns
    -------
    rest, order : ndarray, shape (pairs,)
        Rest, and place from 0. [s], [-]
    """
    rest, order = np.full(len(layout.time), np.inf), np.zeros(len(layout.time))
    for i in range(1, len(layout.time)):
        pause = layout.time[i] - layout.time[i - 1]
        if layout.run[i] != layout.run[i - 1]:
            continue
        if pause > _SERIES_GAP:
            rest[i] = 0.0 if temperature[i] - temperature[i - 1] > _WARMED else pause
        else:
            rest[i], order[i] = rest[i - 1], order[i - 1] + 1
    return rest, order


def clock_of(layout: PairLayout) -> Array:
    """Return times on which runs follow each other."""
    clock = layout.time.copy()
    for run in np.unique(layout.run)[1:]:
        clock[layout.run == run] += clock[layout.run == run - 1][-1]
    return clock


def travel_of(rows: pd.DataFrame, layout: PairLayout, temperature: Array) -> Array:
    """Return the way that a joint has travelled before each pair, from its run's start [deg].

    The log has the way of its pairs. A motor that warms in a pause tells of more: the joint is then
    taken to have moved at the highest speed recorded, as one does to heat it. That way may be many
    times the recorded one, and runs-in a joint as well.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    layout : PairLayout
        Their pairs.
    temperature : ndarray, shape (pairs,)
        Motor temperature of each pair; NaN where unknown: then pauses are rests. [°C]
    """
    grouped = rows.groupby(PAIR_KEY, sort=False, observed=True)
    ends = grouped["position"].agg(["min", "max"]).to_numpy(float)
    stroke, speed = 2 * (ends[:, 1] - ends[:, 0]), grouped["speed"].first().to_numpy(float)
    pause = np.diff(layout.time) - (stroke / speed)[:-1]
    rise = np.diff(temperature)
    warmed = (pause > _SERIES_GAP) & (rise > _WARMED) & (np.diff(layout.run) == 0)
    moved = moved_throughout(rise, pause, warmed)
    way = stroke[:-1] + np.where(moved, pause * speed.max(), 0.0)
    travel = np.append(0.0, np.cumsum(way))
    return travel - travel[np.searchsorted(layout.run, layout.run)]


def moved_throughout(rise: Array, seconds: Array, warmed: Flags) -> Flags:
    """Return in which of the pauses that warmed the motor the joint moved all the time.

    Parameters
    ----------
    rise, seconds : ndarray, shape (pauses,)
        Rise of the motor's temperature, and duration. [°C], [s]
    warmed : ndarray of bool, shape (pauses,)
        Pauses that warmed it.
    """
    if not warmed.any():
        return warmed
    pace = np.divide(rise, seconds, out=np.zeros_like(rise), where=warmed)
    return warmed & (pace >= _LEAST_PACE * float(np.median(pace[warmed])))
