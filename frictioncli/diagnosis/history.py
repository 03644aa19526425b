"""What a joint has been through before each pair: rests, hours, way travelled."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from frictioncli.diagnosis.layout import PairLayout
from frictioncli.model.zero_load import PAIR_KEY

Array = NDArray[np.float64]

_SERIES_GAP = 120.0
"""A pause longer than this begins a new measuring series. [s]"""

_WARMED = 0.2
"""A motor warmer by more than this after a pause has been moved in it. [°C]"""


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


def travel_of(rows: pd.DataFrame, layout: PairLayout) -> Array:
    """Return the way that the log's pairs have travelled before each pair, from its run's start."""
    grouped = rows.groupby(PAIR_KEY, sort=False, observed=True)["position"]
    stroke = 2 * (grouped.max() - grouped.min()).to_numpy(float)
    travel = np.zeros(len(stroke))
    for i in range(1, len(stroke)):
        if layout.run[i] == layout.run[i - 1]:
            travel[i] = travel[i - 1] + stroke[i - 1]
    return travel
