r"""Pauses between pairs in which the motor was heated, from its temperature alone.

A motor above ambient that does not cool is heated as surely as one that warms:

.. math:: \dot T = h - k\,(T - T_a)

The rate of cooling *k* is that of the pauses in which the motor cools; ambient is the lowest
temperature of the run.
"""

import numpy as np

from frictioncli.arrays import Array, Flags

_QUICK = 0.75
"""Quantile of the rates of cooling that counts, by what the motor cooled by: with motion at a lower
speed, or in a part of a pause, it cools more slowly than at rest."""


def rate_of_cooling(rise: Array, seconds: Array, above: Array, long: Flags, seen: float) -> float:
    """Return the rate at which a motor at rest loses its excess over ambient [1/s].

    Where it never cools, its warming tells: with equal work it slows down as the excess grows.

    Parameters
    ----------
    rise, seconds : ndarray, shape (intervals,)
        Rise of the motor's temperature, and duration. [°C], [s]
    above : ndarray, shape (intervals,)
        Mean temperature above ambient. [°C]
    long : ndarray of bool, shape (intervals,)
        Intervals that are long enough to tell how fast the motor cools.
    seen : float
        Least change of temperature that counts. [°C]

    Examples
    --------
    A motor that cools by a tenth of its excess in 200 s:

    >>> import numpy as np
    >>> rise, above = np.array([6.0, 0.0, -3.0]), np.array([10.0, 30.0, 30.0])
    >>> rate_of_cooling(rise, np.full(3, 200.0), above, np.full(3, True), 0.2)
    0.0005
    """
    cools = long & (rise < -seen) & (above > 0)
    if cools.any():
        lost = -rise[cools]
        rates = lost / (above * seconds)[cools]
        return float(np.quantile(rates, _QUICK, weights=lost, method="inverted_cdf"))
    if np.count_nonzero(long) < 3 or np.ptp(above[long]) <= 0:
        return 0.0
    slope = np.polyfit(above[long], rise[long] / seconds[long], 1, w=np.sqrt(seconds[long]))[0]
    return max(float(-slope), 0.0)
