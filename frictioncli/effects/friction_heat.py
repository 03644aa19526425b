"""Friction heat from one pair to the next, with that of motion that the log does not have.

A recorded move there and back dissipates its friction over its angle. Between measuring series
joints often move unrecorded, to be heated; for how long, the table says.
"""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import PairHeads, reversals, starts

_TURNING = 10.0
"""Between moves that follow each other within this time no other move is made. [s]"""

_FASTEST = 0.95
"""Least share of a run's highest speed that counts as the highest."""

_FEW = 5
"""Least number of stretches of which the time of turning is estimated."""

_OUTLYING = 3.0
"""Times between moves that deviate by more median deviations than this are left out."""


def friction_power(table: EffectTable, heads: PairHeads) -> Array:
    """Return the mean friction power from each pair to the next, shape (pairs - 1,).

    From the last pair of a run to the first of the next it is zero. Relative to the reference of
    the table's friction power. [-]

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    heads : PairHeads
        Positions of its pairs.
    """
    recorded, unrecorded = friction_heat(table, heads)
    same = np.diff(table.run[heads.first]) == 0
    duration = np.diff(table.time[heads.first])
    heat = (recorded[1:] + recorded[:-1]) / 2 + unrecorded
    return np.divide(heat, duration, where=same & (duration > 0), out=np.zeros_like(heat))


def friction_heat(table: EffectTable, heads: PairHeads) -> tuple[Array, Array]:
    """Return the friction heat of the pairs, and of unrecorded motion between them.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    heads : PairHeads
        Positions of its pairs.

    Returns
    -------
    recorded : ndarray, shape (pairs,)
        Heat of each pair, relative to the reference of the table's friction power. [s]
    unrecorded : ndarray, shape (pairs - 1,)
        Heat between two pairs. [s]

    Notes
    -----
    Unrecorded motion is assumed to be at the highest recorded speed, or as fast as ramps and pauses
    at the reversals allow, as in a heating programme. Between the moves of a series the joint
    stands.
    """
    run, time = table.run[heads.first], table.time[heads.first]
    power, speed = heads.mean(table.friction_power), table.speed[heads.first]
    lowest, highest = reversals(table, heads)
    stroke = 2 * (highest - lowest)
    moving = stroke / speed
    unrecorded = table.moved[heads.first][1:].copy()
    begins = np.flatnonzero(starts(run))
    for begin, end in zip(begins, np.append(begins[1:], len(time)), strict=True):
        one, between = slice(begin, end), slice(begin, end - 1)
        fastest = speed[one] > _FASTEST * speed[one].max()
        middle = (time[one][1:] + time[one][:-1]) / 2
        # from the middle of a pair to that of the next there are half of each
        halves = (moving[one][1:] + moving[one][:-1]) / 2
        idle = np.maximum(np.diff(time[one]) - halves, 0.0)
        fast = np.interp(middle, time[one][fastest], power[one][fastest])
        fastest_stroke = float(np.median(stroke[one][fastest]))
        unrecorded[between] *= fast * _mean_speed_share(idle, speed[one], fastest_stroke)
    return moving * power, unrecorded


def _mean_speed_share(idle: Array, speed: Array, stroke: float) -> float:
    """Return the mean speed of moves made one after the other, as a share of the highest speed.

    A pair of stroke *s* takes s / v + c + d v + e / v: pauses, ramps, and angles that were not
    recorded. So the mean speed is at most (s + e) / (c + 2 sqrt(d (s + e))).

    Parameters
    ----------
    idle : ndarray, shape (pairs - 1,)
        Time from pair to pair less that of moves at constant speed. [s]
    speed : ndarray, shape (pairs,)
        Speeds. [deg/s]
    stroke : float
        Angle there and back of the fastest pairs. [deg]
    """
    chosen = (idle > 0) & (idle <= _TURNING)
    columns = np.column_stack([np.ones_like(speed), speed, 1.0 / speed])
    columns = ((columns[1:] + columns[:-1]) / 2)[chosen]
    if stroke <= 0 or np.linalg.matrix_rank(columns) < columns.shape[1] or len(columns) < _FEW:
        return 1.0
    pause, ramp, more = np.maximum(_robust_line(columns, idle[chosen]), 0.0)
    whole = stroke + more
    shortest = pause + 2 * np.sqrt(ramp * whole)
    return min(1.0, float(whole / shortest / speed.max())) if shortest > 0 else 1.0


def _robust_line(columns: Array, values: Array) -> Array:
    """Return coefficients fitted to values, without those that lie far off."""
    kept = np.ones(len(values), dtype=bool)
    found: Array = np.zeros(columns.shape[1])
    for _ in range(3):
        found = np.asarray(np.linalg.lstsq(columns[kept], values[kept], rcond=1e-9)[0])
        away = np.abs(values - columns @ found)
        kept = away <= max(_OUTLYING * float(np.median(away)), 1e-9)
    return found
