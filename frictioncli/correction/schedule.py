r"""When to correct the temperature: Algorithm 3 of the source paper, event to event.

A correction is due when :math:`t - t_a > \min(k\,\Delta t, t_{max})` (20), with :math:`\Delta t`
the time in which the registered motor temperature changes by 1 °C. Read literally, the paper's
pseudocode renews :math:`\Delta t` in every cycle, so that :math:`t - t_a` could never exceed
:math:`k\,\Delta t` for k >= 1. Two readings work:

first_degree
    :math:`\Delta t` is the time from :math:`t_a` to the first change by 1 °C.
latest_degree
    :math:`\Delta t` is the duration of the most recent change by 1 °C since :math:`t_a`.

Before any change since :math:`t_a` it is unknown and :math:`t_{max}` alone decides.

References
----------
.. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of industrial
   robot joint with temperature correction by example of KUKA KR10," J. Robotics, 2019,
   doi:10.1155/2019/6931563.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEGREE = 1.0
"""Change of the motor temperature that the criterion waits for. [°C]"""

_ROUNDING = 1e-9
"""Readings are whole degrees; converting from Kelvin must not turn 1 °C into less. [°C]"""


def first_degree(time: Array, temperature: Array, *, k: float, tmax: float) -> list[int]:
    """Return the instants of correction with the first-degree reading of (20).

    Parameters
    ----------
    time : ndarray, shape (instants,)
        Growing times at which the criterion is looked at; the first one is a correction. [s]
    temperature : ndarray, shape (instants,)
        Registered motor temperature. [°C]
    k : float
        Scale of the criterion.
    tmax : float
        Time after which a correction is forced. [s]

    Returns
    -------
    list of int
        Indices into ``time``, growing, beginning with 0.
    """
    return _events(time, tmax, lambda last, limit: _first_due(time, temperature, last, limit, k))


def latest_degree(time: Array, temperature: Array, *, k: float, tmax: float) -> list[int]:
    """Return the instants of correction with the latest-degree reading of (20).

    Parameters and return value are those of :func:`first_degree`.
    """
    return _events(time, tmax, lambda last, limit: _latest_due(time, temperature, last, limit, k))


def equally_spaced(time: Array, count: int) -> list[int]:
    """Return the given number of instants, spread evenly over the time.

    Parameters
    ----------
    time : ndarray, shape (instants,)
        Growing times. [s]
    count : int
        Number of corrections; the first one is at the first instant.
    """
    if count <= 0:
        return []
    wanted = time[0] + (time[-1] - time[0]) * np.arange(count) / count
    return sorted({int(index) for index in np.searchsorted(time, wanted - 1e-9)})


def _events(time: Array, tmax: float, due: Callable[[int, int], int]) -> list[int]:
    """Return correction after correction; ``due`` finds the next before the forced one."""
    found = [0]
    while True:
        last = found[-1]
        forced = int(np.searchsorted(time, time[last] + tmax, side="right"))
        following = due(last, forced)
        if following >= len(time):
            return found
        found.append(following)


def _first_change(temperature: Array, start: int, limit: int) -> int:
    """Return the first instant after ``start`` with 1 °C of change; ``limit`` if there is none."""
    block = 64
    begin = start + 1
    while begin < limit:
        end = min(begin + block, limit)
        changed = np.abs(temperature[begin:end] - temperature[start]) >= DEGREE - _ROUNDING
        if changed.any():
            return begin + int(np.argmax(changed))
        begin, block = end, 2 * block
    return limit


def _first_due(time: Array, temperature: Array, last: int, limit: int, k: float) -> int:
    change = _first_change(temperature, last, min(limit, len(time)))
    if change >= min(limit, len(time)):
        return limit
    patience = time[last] + k * (time[change] - time[last])
    # the change itself must have been seen before it can count
    return min(limit, max(change, int(np.searchsorted(time, patience, side="right"))))


def _latest_due(time: Array, temperature: Array, last: int, limit: int, k: float) -> int:
    end = min(limit, len(time))
    reference, change = last, _first_change(temperature, last, end)
    while change < end:
        patience = time[last] + k * (time[change] - time[reference])
        reference, change = change, _first_change(temperature, change, end)
        # this patience holds until the next change by a degree is seen
        due = max(reference, int(np.searchsorted(time, patience, side="right")))
        if due < change:
            return due
    return limit
