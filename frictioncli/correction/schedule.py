r"""Instants of correction by criterion (20): Algorithm 3 of the paper [1]_.

A correction is due when :math:`t - t_a > \min(k\,\Delta t, t_{max})` (20), where
:math:`t_a` is the time of the last correction and :math:`\Delta t` the time in which the registered
motor temperature changes by 1 °C. The paper's pseudocode, taken literally, renews :math:`\Delta t`
in every cycle, so that :math:`t - t_a` could never exceed :math:`k\,\Delta t` for k >= 1. Two
readings work:

first_degree
    :math:`\Delta t` is the time from :math:`t_a` to the first change by 1 °C.
latest_degree
    :math:`\Delta t` is the duration of the most recent change by 1 °C since :math:`t_a`.

Before the first change since :math:`t_a` it is unknown and :math:`t_{max}` alone decides.

Schedules with many k and :math:`t_{max}` are computed together: the next change by 1 °C is found
once for all instants, and each step advances every schedule to its next event.

References
----------
.. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of industrial
   robot joint with temperature correction by example of KUKA KR10," J. Robotics, 2019,
   doi:10.1155/2019/6931563.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array, Indices
from frictioncli.correction.degree_crossings import next_degree_changes


def first_degree(
    time: Array, temperature: Array, *, k: ArrayLike, tmax: ArrayLike
) -> list[Indices]:
    """Return the instants of correction with the first-degree reading of (20).

    Parameters
    ----------
    time : ndarray, shape (instants,)
        Increasing times at which the criterion is evaluated; the first one is a correction. [s]
    temperature : ndarray, shape (instants,)
        Registered motor temperature. [°C]
    k : array_like, shape (schedules,)
        Scale of the criterion in each schedule.
    tmax : array_like, shape (schedules,)
        Time after which a correction is forced. [s]

    Returns
    -------
    list of ndarray of int
        For each schedule increasing indices into ``time``, beginning with 0.

    Examples
    --------
    >>> time = 60.0 * np.arange(10)
    >>> temperature = 20.0 + np.arange(10)  # 1 °C per minute
    >>> first_degree(time, temperature, k=[2.0, 5.0], tmax=[3600.0, 3600.0])
    [array([0, 3, 6, 9]), array([0, 6])]
    """
    clock, k, tmax = _Clock.of(time), np.atleast_1d(k), np.atleast_1d(tmax)
    changes = np.append(next_degree_changes(temperature), len(time))
    schedule = np.arange(len(k))
    last = np.zeros_like(schedule)
    events = [(schedule, last)]
    while len(schedule):
        change = changes[last]
        forced = clock.first_after(last, tmax[schedule])
        due = clock.first_after(last, k[schedule] * clock.between(last, change))
        # a change is known only when it has occurred
        last = np.minimum(forced, np.maximum(change, due))
        schedule, last = schedule[last < len(time)], last[last < len(time)]
        events.append((schedule, last))
    return _by_schedule(events, len(k))


def latest_degree(
    time: Array, temperature: Array, *, k: ArrayLike, tmax: ArrayLike
) -> list[Indices]:
    """Return the instants of correction with the latest-degree reading of (20).

    Parameters and return value are those of :func:`first_degree`.

    Examples
    --------
    >>> time = 60.0 * np.arange(10)
    >>> latest_degree(time, 20.0 + np.arange(10), k=[2.0], tmax=[3600.0])
    [array([0, 3, 6, 9])]
    """
    clock, k, tmax = _Clock.of(time), np.atleast_1d(k), np.atleast_1d(tmax)
    changes = np.append(next_degree_changes(temperature), len(time))
    schedule = np.arange(len(k))
    last = np.zeros_like(schedule)
    # ``reference``: start of the current change by a degree; ``due``: next correction without it
    reference, forced = last, clock.first_after(last, tmax)
    due = forced
    events = [(schedule, last)]
    while len(schedule):
        change = changes[reference]
        corrects = (due < change) | (forced <= change)
        wait = k[schedule] * clock.between(reference, change)
        after_change = np.maximum(change, clock.first_after(last, wait))
        last, reference = np.where(corrects, (due, due), (last, change))
        going = last < len(time)
        events.append((schedule[corrects & going], last[corrects & going]))
        schedule, last, reference = schedule[going], last[going], reference[going]
        forced = clock.first_after(last, tmax[schedule])
        due = np.where(corrects[going], forced, np.minimum(forced, after_change[going]))
    return _by_schedule(events, len(k))


BY_READING = {"first_degree": first_degree, "latest_degree": latest_degree}
"""Function that returns the instants, by reading of (20)."""


def equally_spaced(time: Array, count: int) -> Indices:
    """Return a given number of instants, equally spaced in time.

    Parameters
    ----------
    time : ndarray, shape (instants,)
        Increasing times. [s]
    count : int
        Number of corrections; the first one is at the first instant.

    Returns
    -------
    ndarray of int, shape (corrections,)
        Indices into ``time``.

    Examples
    --------
    >>> equally_spaced(np.arange(10.0), 3)
    array([0, 3, 6])
    """
    wanted = time[0] + (time[-1] - time[0]) * np.arange(count) / max(count, 1)
    return np.unique(np.searchsorted(time, wanted - 1e-9))


@dataclass(frozen=True, slots=True)
class _Clock:
    """Times of the instants, followed by an infinite one.

    ``first`` and ``following`` are, for each instant, the first one at the same time and the first
    one at a later time.
    """

    time: Array
    first: Indices
    following: Indices

    @classmethod
    def of(cls, time: Array) -> "_Clock":
        padded = np.append(time, np.inf)
        changes = np.flatnonzero(np.append(True, np.diff(padded) != 0))
        borders = np.append(changes, len(padded))
        lengths = np.diff(borders)
        return cls(padded, np.repeat(changes, lengths), np.repeat(borders[1:], lengths))

    def between(self, start: Indices, end: Indices) -> Array:
        """Return the times between instants; infinite if the later one does not exist [s]."""
        return self.time[end] - self.time[start]

    def first_after(self, start: Indices, wait: Array) -> Indices:
        """Return the first instants at which more than ``wait`` [s] has passed since ``start``."""
        never = len(self.time) - 1
        found = np.searchsorted(self.time, self.time[start] + wait, side="right")
        found = np.minimum(found, never)
        # the sum rounds differently from the difference that (20) compares
        before = self.first[found - 1]
        found = np.where(self.between(start, before) > wait, before, found)
        found = np.where(self.between(start, found) <= wait, self.following[found], found)
        return np.minimum(found, never)


def _by_schedule(events: list[tuple[Indices, Indices]], schedules: int) -> list[Indices]:
    """Return the instants of each schedule from the schedules and instants of each step."""
    schedule, instant = (np.concatenate(part) for part in zip(*events, strict=True))
    order = np.argsort(schedule, kind="stable")
    borders = np.searchsorted(schedule[order], np.arange(schedules + 1))
    return [instant[order[begin:end]] for begin, end in pairwise(borders)]
