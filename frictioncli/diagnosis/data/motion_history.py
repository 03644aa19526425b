"""Motion of a joint before each pair: rest, time and distance travelled, recorded or not."""

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.heat_balance import rate_of_cooling
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.model.zero_load import PAIR_KEY

_SERIES_GAP = 120.0
"""A pause longer than this starts a new measuring series. [s]"""

_IDLE = 20.0
"""A pause longer than this leaves room for moves that are not recorded. [s]"""

_WARMED = 0.2
"""A motor that is warmer by more than this after a pause has moved during it. [°C]"""

_LEAST_SHARE = 0.25
"""Least heat of a pause that counts as motion, relative to the same median: midway between rest and
half the work."""

_THROUGHOUT = 0.8
"""A pause with more of it had motion throughout."""


def distance_of_pairs(rows: pd.DataFrame) -> Array:
    """Return the distance of each pair, there and back over its angles, shape (pairs,) [deg].

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    """
    grouped = rows.groupby(PAIR_KEY, sort=False, observed=True)
    ends = grouped["position"].agg(["min", "max"]).to_numpy(float)
    return 2 * (ends[:, 1] - ends[:, 0])


def pauses_of(layout: PairLayout, distance: Array) -> Array:
    """Return the time between the end of each pair and the start of the next, shape (pairs - 1,).

    Times of pairs are those of their middles. [s]

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    distance : ndarray, shape (pairs,)
        Distance of each. [deg]
    """
    moving = distance / layout.speed
    return np.maximum(np.diff(layout.time) - (moving[:-1] + moving[1:]) / 2, 0.0)


def series(layout: PairLayout, pause: Array, moved: Array) -> tuple[Array, Array]:
    """Return the rest before each pair's measuring series, and the pair's number in it.

    What a joint did not move of a pause is the rest, at its end: a joint is heated, and stands
    before it is measured. The rest before the first series of a run is infinite.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    pause : ndarray, shape (pairs - 1,)
        Time between two pairs. [s]
    moved : ndarray, shape (pairs - 1,)
        Share of it in which the joint moved. [-]

    Returns
    -------
    rest, order : ndarray, shape (pairs,)
        Rest, and number from 0. [s], [-]
    """
    rest, order = np.full(len(layout.time), np.inf), np.zeros(len(layout.time))
    for i in range(1, len(layout.time)):
        if layout.run[i] != layout.run[i - 1]:
            continue
        if pause[i - 1] > _SERIES_GAP:
            rest[i] = pause[i - 1] * (1.0 - moved[i - 1])
        else:
            rest[i], order[i] = rest[i - 1], order[i - 1] + 1
    return rest, order


def clock_of(layout: PairLayout) -> Array:
    """Return times in which runs follow each other without a pause, shape (pairs,) [s]."""
    clock = layout.time.copy()
    for run in np.unique(layout.run)[1:]:
        clock[layout.run == run] += clock[layout.run == run - 1][-1]
    return clock


def travel_of(layout: PairLayout, distance: Array, pause: Array, moved: Array) -> Array:
    """Return the distance that a joint has travelled before each pair since its run's start [deg].

    The log has the strokes of its pairs. In the pauses the joint is assumed to have moved at the
    highest recorded speed, as in a heating programme. That distance may be many times the recorded
    one, and runs a joint in as well.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    distance : ndarray, shape (pairs,)
        Distance of each. [deg]
    pause : ndarray, shape (pairs - 1,)
        Time between two. [s]
    moved : ndarray, shape (pairs - 1,)
        Share of it in which the joint moved. [-]
    """
    unrecorded = moved * pause * layout.speed.max()
    travel = np.append(0.0, np.cumsum(distance[:-1] + unrecorded))
    return travel - travel[np.searchsorted(layout.run, layout.run)]


def unrecorded_motion(layout: PairLayout, pause: Array, temperature: Array) -> tuple[Array, Array]:
    """Return the share of each pause in which the joint moved, and how warm the motor was then.

    The share is the heat of a pause that warmed the motor, or kept it warm against its cooling,
    relative to the median of those that warmed it. A balance of one node does not tell more than
    that a joint moved nearly throughout, or hardly. It stands after the motion, and its motor cools
    until the next pair.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    pause : ndarray, shape (pairs - 1,)
        Time between two pairs. [s]
    temperature : ndarray, shape (pairs,)
        Motor temperature of each pair; NaN where unknown: pauses are then rests. [°C]

    Returns
    -------
    moved, warmed_to : ndarray, shape (pairs - 1,)
        The share, 0 to 1, and the temperature of the motor at the end of the motion. [-], [°C]
    """
    same = np.diff(layout.run) == 0
    rise, seconds = np.diff(temperature), np.where(same, np.diff(layout.time), 0.0)
    ambient = _lowest(temperature, layout.run)[1:]
    above = (temperature[:-1] + temperature[1:]) / 2 - ambient
    warmed = same & (pause > _IDLE) & (rise > _WARMED)
    if not warmed.any():
        return np.zeros_like(rise), temperature[1:]
    # after a short pause the heat of the pairs about it may be what keeps the motor warm
    long = same & (pause > _SERIES_GAP) & np.isfinite(rise)
    cooling = rate_of_cooling(rise, seconds, above, long, _WARMED)
    heat = rise + cooling * above * seconds
    heated = warmed | (long & (heat > _WARMED))
    rate = np.divide(heat, pause, out=np.zeros_like(rise), where=heated)
    share = rate / float(np.median(rate[warmed]))
    moved = np.where(share < _LEAST_SHARE, 0.0, np.where(share > _THROUGHOUT, 1.0, share))
    rest = np.where(moved > 0, pause * (1.0 - moved), 0.0)
    return moved, ambient + (temperature[1:] - ambient) * np.exp(cooling * rest)


def _lowest(temperature: Array, run: Indices) -> Array:
    """Return the lowest temperature of the run of each pair [°C]."""
    lowest = np.full(int(run.max()) + 1, np.inf)
    np.fmin.at(lowest, run, temperature)
    return lowest[run]
