r"""Friction heat from one pair to the next, with what the log does not have of the motion.

A recorded move there and back dissipates its friction over its angle. Between measuring series
joints often move unrecorded, to be heated; for how long, the measured motor temperature tells. With
:math:`\dot T = h p - k (T - T_\infty)` for the motor, :math:`k` and :math:`T_\infty` from
stretches in which it cools and *h* from those in which it warms, a stretch had motion in the share

.. math:: x = \frac{\dot T + k (T - T_\infty)}{h p}

Half of *p* goes with the power of friction, the other half is constant: the winding warms the motor
as well, and its losses depend less on the temperature.
"""

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import PairHeads, reversals, starts

_HALF_WINDOW = 30.0
"""Least half of the window in which the warming of the motor is seen. [s]"""

_TURNING = 10.0
"""Between moves that follow each other within this time no other move is made. [s]"""

_FASTEST = 0.95
"""Least share of a run's highest speed that counts as the highest."""

_THROUGHOUT = 0.6
"""A stretch whose estimated share of motion is greater than this had motion throughout: a balance
of one node does not tell more. One in which the motor cools had none."""

_LEAST_RATE = 5e-4
"""Rate of warming below which a joint may as well stand: recorded moves before and after a pause,
or the hall, warm a motor as much. [°C/s]"""

_TYPICAL = 0.75
"""Quantile of the warming per power, among stretches that warmed the motor, that counts as that of
motion throughout: some stretches have pauses."""

_FEW = 5
"""Least number of stretches of which a property is estimated."""

_OUTLYING = 3.0
"""Times between moves that deviate by more median deviations than this are left out."""


def friction_power(table: EffectTable, heads: PairHeads) -> Array:
    """Return the mean friction power from each pair to the next.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    heads : PairHeads
        Positions of its pairs.

    Returns
    -------
    ndarray, shape (pairs - 1,)
        Mean power, relative to the reference of the table's friction power. [-]

    Notes
    -----
    Unrecorded motion is assumed to be at the highest recorded speed, or as fast as ramps and pauses
    at the reversals allow, as in a heating programme. Between the moves of a series the joint
    stands.
    """
    run, time = table.run[heads.first], table.time[heads.first]
    moved, speed = heads.mean(table.friction_power), table.speed[heads.first]
    motor = table.motor_temperature[heads.first]
    lowest, highest = reversals(table, heads)
    stroke = 2 * (highest - lowest)
    level = np.zeros(max(len(time) - 1, 0))
    begins = np.flatnonzero(starts(run))
    for begin, end in zip(begins, np.append(begins[1:], len(time)), strict=True):
        one = slice(begin, end)
        level[begin : end - 1] = _of_run(
            time=time[one],
            power=moved[one],
            speed=speed[one],
            stroke=stroke[one],
            motor=motor[one],
        )
    return level


def _of_run(*, time: Array, power: Array, speed: Array, stroke: Array, motor: Array) -> Array:
    """Return the mean power from each pair of a run to the next."""
    middle, duration = (time[1:] + time[:-1]) / 2, np.diff(time)
    fastest = speed > _FASTEST * speed.max()
    moving = stroke / speed
    # from the middle of a pair to that of the next there are half of each
    idle = np.maximum(duration - (moving[1:] + moving[:-1]) / 2, 0.0)
    heat = moving * power
    fast = np.interp(middle, time[fastest], power[fastest])
    fast = fast * _mean_speed_share(idle, speed, float(np.median(stroke[fastest])))
    unrecorded = np.where(idle > _TURNING, idle, 0.0)
    unrecorded = unrecorded * _share_in_motion(time, motor, fast, idle > _TURNING)
    total = (heat[1:] + heat[:-1]) / 2 + unrecorded * fast
    return np.divide(total, duration, where=duration > 0, out=0 * duration)


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


def _share_in_motion(time: Array, motor: Array, power: Array, gap: Flags) -> Array:
    """Return the share of each stretch between pairs in which the joint moved unrecorded.

    Parameters
    ----------
    time, motor : ndarray, shape (pairs,)
        Time, and temperature of the motor. [s], [°C]
    power : ndarray, shape (pairs - 1,)
        Power of unrecorded motion. [-]
    gap : ndarray of bool, shape (pairs - 1,)
        Stretches that may have such motion.
    """
    middle = (time[1:] + time[:-1]) / 2
    half = np.maximum(np.diff(time) / 2, _HALF_WINDOW)
    begin, end = np.clip([middle - half, middle + half], time[0], time[-1])
    earlier, later = np.interp(begin, time, motor), np.interp(end, time, motor)
    rate, mean = (later - earlier) / np.maximum(end - begin, 1e-9), (later + earlier) / 2
    warmed = gap & (power > 0) & (rate > 0)
    if np.sum(warmed & (rate > _LEAST_RATE)) < _FEW:
        return (rate > _LEAST_RATE).astype(float)
    heat = rate + _loss(rate, mean, gap & (rate < 0))
    heat_of_motion = (power + np.median(power[warmed])) / 2
    typical = float(np.quantile(heat[warmed] / heat_of_motion[warmed], _TYPICAL))
    share = np.divide(heat, typical * heat_of_motion, where=warmed, out=np.zeros_like(rate))
    share[share > _THROUGHOUT] = 1.0
    return share


def _loss(rate: Array, mean: Array, cooling: Flags) -> Array:
    """Return the rate at which a motor at some temperatures would cool at rest [°C/s].

    Parameters
    ----------
    rate, mean : ndarray, shape (stretches,)
        Its warming, and its mean temperature. [°C/s], [°C]
    cooling : ndarray of bool, shape (stretches,)
        Stretches in which it cooled.
    """
    if np.sum(cooling) < _FEW:
        return np.zeros_like(rate)
    columns = np.column_stack([np.ones_like(mean), mean])
    line = np.linalg.lstsq(columns[cooling], -rate[cooling], rcond=1e-9)[0]
    if line[1] <= 0:
        return np.zeros_like(rate)
    return np.asarray(np.maximum(columns @ line, 0.0))
