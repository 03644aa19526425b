r"""Ringing of the servo behind the ramp of a move.

A plateau begins where the speed has come within its tolerance. A servo that is damped weakly goes
on ringing about it: an oscillation of the speed by :math:`\Delta v` at the frequency *f* is an
acceleration of :math:`2\pi f \Delta v`, and its torque that share of the ramp's torque which this
is of the ramp's acceleration. It has ended where the speed stays within what it does later in the
same plateau, or within what would be a small share of the ramp.
"""

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.slices import fill_slices, reduce_slices, slice_means

HOLD = 0.15
"""Time for which the speed must stay near its mean: half a period of the slowest ringing. [s]"""

_LEAST_HOLD = 4
"""Samples in that time below which nothing can be said."""

_LATER = (0.5, 0.75)
"""Part of the plateau that tells what its speed does once it has settled. [-]"""

_BEYOND = 1.5
"""By how many times the greatest deviation there ringing exceeds it."""

_SHARE = 0.05
"""Share of the ramp's torque below which the torque of ringing does not count: less would leave
nothing of the short plateaus of fast moves, whose servo settles as any does."""

_USUAL = 5.0
"""Frequency at which servos of arms ring, or a higher one. [Hz]"""

_LEAST = 1e-3
"""Least deviation that counts, relative to the speed."""


def ringing_ends(
    speed: Array, begin: Numbers, end: Numbers, hold: Numbers, acceleration: Array
) -> Numbers:
    """Return from which sample on the speed of each plateau does not ring, at most its middle.

    Parameters
    ----------
    speed : ndarray, shape (samples,)
        Moving mean of the speed. [deg/s]
    begin, end : ndarray of int, shape (plateaus,)
        First and past-the-end sample of plateaus that do not overlap, in order.
    hold : ndarray of int, shape (plateaus,)
        Samples in :data:`HOLD`.
    acceleration : ndarray, shape (plateaus,)
        Greatest acceleration of the ramp before. [deg/s²]

    Returns
    -------
    ndarray of int, shape (plateaus,)
        The samples; the first one of a plateau that does not ring.

    Examples
    --------
    Ringing by 4 % of the speed is within 0.6 % after 13 samples, a ripple of 0.1 % goes on:

    >>> sample = np.arange(400)
    >>> ringing = 2.0 * np.exp(-sample / 10) * np.cos(sample / 3)
    >>> speed = 50.0 + 0.05 * np.sin(sample) + ringing
    >>> one = np.array([0]), np.array([400]), np.array([15])
    >>> ringing_ends(speed, *one, acceleration=np.array([200.0]))
    array([13])
    """
    later = [begin + (share * (end - begin)).astype(np.int64) for share in _LATER]
    known = np.flatnonzero((hold >= _LEAST_HOLD) & (later[1] > later[0]))
    if not len(known):
        return begin
    start, stop, wait = begin[known], later[0][known], hold[known]
    level = slice_means(speed, stop, later[1][known])
    away = speed - fill_slices(level, start, end[known], len(speed), 0.0)
    np.abs(away, out=away)
    limit = _BEYOND * reduce_slices(np.maximum, away, stop, later[1][known])
    np.maximum(limit, _LEAST * level, out=limit)
    np.maximum(limit, _SHARE * acceleration[known] / (2 * np.pi * _USUAL), out=limit)
    beyond = np.flatnonzero(away > fill_slices(limit, start, stop, len(speed), np.inf))
    owner = np.searchsorted(start, beyond, side="right") - 1
    before = np.append(-1, beyond[:-1])
    first = np.diff(owner, prepend=-1) != 0
    before[first] = start[owner[first]] - 1
    # what follows the first quiet stretch is no ringing
    quiet = np.cumsum(beyond - before > wait[owner])
    earlier = np.append(0, quiet)[np.flatnonzero(first)]
    ringing = quiet == earlier[np.cumsum(first) - 1]
    found = begin.copy()
    np.maximum.at(found, known[owner[ringing]], beyond[ringing] + 1)
    return found
