"""Steps that effects share: from rows to pairs and back, and what integrates from pair to pair."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.effects.base import EffectTable

_HALF_WINDOW = 300.0
"""How far around a moment pairs tell of its heat and of the motor's warming. [s]"""

_FEW_SERIES = 5
"""With fewer series a change may come before any pair."""

_MOST_MOMENTS = 160
"""Moments that a change is looked for at, at most."""

_CUT_ALIKE = 10.0
"""What is cut off a stroke at constant speed is alike at both ends within this. [deg]"""


@dataclass(frozen=True, slots=True)
class PairHeads:
    """Where the pairs of a table are.

    Attributes
    ----------
    first : ndarray of int, shape (pairs,)
        First row of each pair.
    of_row : ndarray of int, shape (rows,)
        Place of each row's pair among the pairs.
    """

    first: Indices
    of_row: Indices

    def spread(self, per_pair: Array) -> Array:
        """Return one value per row from one value per pair."""
        return per_pair[self.of_row]

    def mean(self, per_row: Array) -> Array:
        """Return the mean over each pair's rows."""
        return np.add.reduceat(per_row, self.first) / np.bincount(self.of_row)

    def minimum(self, per_row: Array) -> Array:
        """Return the least value of each pair."""
        return np.asarray(np.minimum.reduceat(per_row, self.first))

    def maximum(self, per_row: Array) -> Array:
        """Return the greatest value of each pair."""
        return np.asarray(np.maximum.reduceat(per_row, self.first))


def pair_heads(table: EffectTable) -> PairHeads:
    """Return where the pairs of a table are; a pair of another run is another pair."""
    begins = starts(table.pair) | starts(table.run)
    return PairHeads(np.flatnonzero(begins), np.cumsum(begins) - 1)


def starts(labels: Indices) -> Flags:
    """Return where a label differs from the one before; the first one does."""
    return np.concatenate([np.ones(min(1, len(labels)), bool), labels[1:] != labels[:-1]])


def first_order_lag(*, time: Array, value: Array, restart: Flags, time_constant: float) -> Array:
    r"""Return by how much a first-order follower is above the value it follows.

    Parameters
    ----------
    time : ndarray, shape (pairs,)
        Moments of the values, growing between two restarts. [s]
    value : ndarray, shape (pairs,)
        What is followed, linear from one moment to the next.
    restart : ndarray of bool, shape (pairs,)
        Where the follower stands at the value itself.
    time_constant : float
        Time in which the follower closes 63 % of its lag. [s]

    Returns
    -------
    ndarray, shape (pairs,)
        Follower less value, in the value's unit.

    Notes
    -----
    With :math:`\theta \dot y = u - y`, input :math:`u` linear over a step :math:`h` and lag
    :math:`x = y - u`, exactly

    .. math:: x_1 = x_0 e^{-h/\theta} - (u_1 - u_0) \frac{1 - e^{-h/\theta}}{h/\theta}
    """
    ratio = np.maximum(np.diff(time), 0.0) / time_constant
    share = np.where(ratio > 0, -np.expm1(-ratio) / np.where(ratio > 0, ratio, 1.0), 1.0)
    return _accumulated(np.exp(-ratio), -np.diff(value) * share, restart)


def first_order_response(
    *, time: Array, level: Array, restart: Flags, time_constant: float
) -> Array:
    r"""Return a first-order follower of an input that is constant between two moments.

    Parameters
    ----------
    time : ndarray, shape (pairs,)
        Moments, growing between two restarts. [s]
    level : ndarray, shape (pairs - 1,)
        Input from each moment to the next.
    restart : ndarray of bool, shape (pairs,)
        Where the follower stands at zero.
    time_constant : float
        Time in which the follower closes 63 % of its distance to the input. [s]

    Returns
    -------
    ndarray, shape (pairs,)
        The follower, in the input's unit.

    Notes
    -----
    .. math:: y_1 = y_0 e^{-h/\theta} + u (1 - e^{-h/\theta})
    """
    ratio = np.maximum(np.diff(time), 0.0) / time_constant
    return _accumulated(np.exp(-ratio), -level * np.expm1(-ratio), restart)


def _accumulated(decay: Array, gain: Array, restart: Flags) -> Array:
    """Return x with ``x[i + 1] = decay[i] x[i] + gain[i]``, and 0 at each restart."""
    state = 0.0
    states = [state]
    for kept, added, anew in zip(decay.tolist(), gain.tolist(), restart[1:].tolist(), strict=True):
        state = 0.0 if anew else kept * state + added
        states.append(state)
    return np.array(states)


def friction_power(table: EffectTable, heads: PairHeads) -> Array:
    """Return the heat that friction gives off from each pair to the next.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    heads : PairHeads
        Where its pairs are.

    Returns
    -------
    ndarray, shape (pairs - 1,)
        Mean power; 1 at 100 deg/s and the table's mean friction.

    Notes
    -----
    While the joint moves, the power is friction times speed, averaged over the pairs of ten
    minutes. What it does between pairs is often not recorded: it is taken to move all the time
    while the motor warms, and else only for the way recorded.
    """
    run, time = table.run[heads.first], table.time[heads.first]
    friction, speed = heads.mean(table.friction), table.speed[heads.first]
    motor, travel = table.motor_temperature[heads.first], table.travel[heads.first]
    level = np.zeros(max(len(time) - 1, 0))
    begins = np.flatnonzero(starts(run))
    for begin, end in zip(begins, np.append(begins[1:], len(time)), strict=True):
        t = time[begin:end]
        middle, duration = (t[1:] + t[:-1]) / 2, np.diff(t)
        power = _mean_around(t, (friction * speed)[begin:end])
        moving = np.diff(travel[begin:end]) / speed[begin : end - 1]
        duty = np.clip(np.divide(moving, duration, where=duration > 0, out=0 * moving), 0.0, 1.0)
        later = np.interp(middle + _HALF_WINDOW, t, motor[begin:end])
        earlier = np.interp(middle - _HALF_WINDOW, t, motor[begin:end])
        duty[later > earlier] = 1.0
        level[begin : end - 1] = duty * (power[1:] + power[:-1]) / 2
    typical = 100.0 * float(np.mean(np.abs(friction)))
    return level / typical if typical > 0 else level


def _mean_around(time: Array, value: Array) -> Array:
    """Return the mean of the values within half a window before and after each moment."""
    total = np.concatenate([[0.0], np.cumsum(value)])
    low = np.searchsorted(time, time - _HALF_WINDOW, side="left")
    high = np.searchsorted(time, time + _HALF_WINDOW, side="right")
    return (total[high] - total[low]) / (high - low)


def measured_share(table: EffectTable) -> Array:
    """Return the share of all pairs that were measured before each row's pair, by the clock."""
    heads = pair_heads(table)
    clock = table.clock[heads.first]
    return heads.spread(np.searchsorted(np.sort(clock), clock, side="left") / len(clock))


def series_starts(table: EffectTable) -> Array:
    """Return the shares of all pairs measured before each measuring series, shape (moments,).

    What is done to a joint is done between two series. If a table has more than 160 of them, only
    every second is returned, or every third, and so on.
    """
    heads = pair_heads(table)
    clock = table.clock[heads.first]
    share = np.searchsorted(np.sort(clock), clock, side="left") / len(clock)
    begins = np.unique(share[(table.order[heads.first] == 0) & (share > 0)])
    if len(begins) < _FEW_SERIES:
        begins = np.unique(share)[1:]
    return np.asarray(begins[:: max(1, -(-len(begins) // _MOST_MOMENTS))])


def stroke_ends(table: EffectTable, *, distance: Array | float) -> tuple[Array, Array]:
    """Return how near each row is to the low and to the high end of its pair's angles.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float or ndarray, shape (rows,)
        Distance from the end at which nearness has fallen to 37 %. [deg]

    Returns
    -------
    low, high : ndarray, shape (rows,)
        Nearness, 1 in the outermost bin.
    """
    heads = pair_heads(table)
    ends = heads.minimum(table.position), heads.maximum(table.position)
    return _nearness(table, heads, ends, distance)


def turning_points(table: EffectTable, *, distance: float) -> tuple[Array, Array]:
    """Return how near each row is to the low and to the high angle where its pair turns.

    A fast move reaches its speed later, so its first bin lies further from where it turned, and its
    last one as far from the other turn. Pairs that lack as much of their run's angles at one end as
    at the other are taken to turn at the outermost angles; others where they end.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float
        Distance from the turn at which nearness has fallen to 37 %. [deg]

    Returns
    -------
    low, high : ndarray, shape (rows,)
        Nearness, 1 in the outermost bin.
    """
    heads = pair_heads(table)
    lowest, highest = heads.minimum(table.position), heads.maximum(table.position)
    run = table.run[heads.first]
    for number in np.unique(run):
        own = run == number
        least, most = np.min(lowest[own]), np.max(highest[own])
        cut_low, cut_high = lowest - least, most - highest
        same = own & (np.abs(cut_low - cut_high) < _CUT_ALIKE)
        lowest[same], highest[same] = least, most
    return _nearness(table, heads, (lowest, highest), distance)


def _nearness(
    table: EffectTable, heads: PairHeads, ends: tuple[Array, Array], distance: Array | float
) -> tuple[Array, Array]:
    """Return how near each row is to the low and to the high of its pair's two angles."""
    low = table.position - heads.spread(ends[0])
    high = heads.spread(ends[1]) - table.position
    return np.exp(-low / distance), np.exp(-high / distance)
