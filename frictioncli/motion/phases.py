"""Heat-up and cool-down: phases found from the trend of the motor temperature."""

from itertools import pairwise

import numpy as np
import pandas as pd
from numpy.typing import NDArray

HEAT_UP, COOL_DOWN, SWEEP = "heat-up", "cool-down", "sweep"

_TURN = 3.0
"""A reversal smaller than this is noise of the temperature, not a new phase. [°C]"""

_LEAST_SWING = 5.0
"""A phase that changes the temperature by less is neither heating nor cooling. [°C]"""


def add_phases(pairs: pd.DataFrame, given: pd.Series) -> pd.DataFrame:
    """Return the pairs with their ``phase``: as given, else from the trend of the temperature.

    Parameters
    ----------
    pairs : DataFrame
        Rows with run, joint, pair, time and motor_temperature.
    given : Series
        Phase of each row as the manifest says; missing where it does not.
    """
    phase = pd.Series(given.to_numpy(dtype=object), index=pairs.index)
    for _, group in pairs.groupby(["run", "joint"], observed=True):
        unknown = phase.loc[group.index].isna()
        if not unknown.any():
            continue
        heads = group.drop_duplicates("pair").sort_values("time")
        found = pd.Series(
            phases_of(heads["motor_temperature"].to_numpy(float)), index=heads["pair"]
        )
        rows = group.index[unknown]
        phase.loc[rows] = pairs.loc[rows, "pair"].map(found).to_numpy()
    return pairs.assign(phase=phase)


def phases_of(temperature: NDArray[np.float64]) -> NDArray[np.str_]:
    """Return the phase at each of a run's temperatures in time order.

    Parameters
    ----------
    temperature : ndarray, shape (pairs,)
        Motor temperature, NaN where unknown. [°C]

    Notes
    -----
    The temperatures are cut where they turn by more than 3 °C. A stretch that rises by 5 °C or more
    is heat-up, one that falls as much is cool-down, anything else is a sweep.
    """
    phases = np.full(len(temperature), SWEEP, dtype="<U9")
    known = np.flatnonzero(np.isfinite(temperature))
    turns = _turning_points(temperature[known])
    for first, last in pairwise(turns):
        swing = temperature[known[last]] - temperature[known[first]]
        if abs(swing) >= _LEAST_SWING:
            begin = known[first] + (first > 0)
            phases[begin : known[last] + 1] = HEAT_UP if swing > 0 else COOL_DOWN
    return phases


def _turning_points(values: NDArray[np.float64]) -> list[int]:
    """Return first, last and turning points of a sequence, small reversals ignored."""
    if len(values) < 2:
        return []
    turns = [0]
    low = high = 0
    rising: bool | None = None
    for i, value in enumerate(values):
        if value > values[high]:
            high = i
        if value < values[low]:
            low = i
        if rising is not False and value < values[high] - _TURN:
            if abs(values[high] - values[turns[-1]]) > _TURN:
                turns.append(high)
            rising, low = False, i
            high = i
        elif rising is not True and value > values[low] + _TURN:
            if abs(values[low] - values[turns[-1]]) > _TURN:
                turns.append(low)
            rising, high = True, i
            low = i
    return [*turns, len(values) - 1]
