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

Schedules of many k and :math:`t_{max}` are followed side by side: when the temperature next changes
by 1 °C is found once for all instants, and each step takes every schedule to its next event.

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
from frictioncli.correction.degree_crossings import next_changes


def first_degree(
    time: Array, temperature: Array, *, k: ArrayLike, tmax: ArrayLike
) -> list[Indices]:
    """Return the instants of correction with the first-degree reading of (20).

    Parameters
    ----------
    time : ndarray, shape (instants,)
        Growing times at which the criterion is looked at; the first one is a correction. [s]
    temperature : ndarray, shape (instants,)
        Registered motor temperature. [°C]
    k : array_like, shape (schedules,)
        Scale of the criterion in each schedule.
    tmax : array_like, shape (schedules,)
        Time after which a correction is forced. [s]

    Returns
    -------
    list of ndarray of int
        For each schedule the indices into ``time``, growing, beginning with 0.
    """
    clock, k, tmax = _Clock.of(time), np.atleast_1d(k), np.atleast_1d(tmax)
    changes = np.append(next_changes(temperature), len(time))
    schedule = np.arange(len(k))
    last = np.zeros_like(schedule)
    events = [(schedule, last)]
    while len(schedule):
        change = changes[last]
        forced = clock.first_after(last, tmax[schedule])
        due = clock.first_after(last, k[schedule] * clock.between(last, change))
        # the change itself must have been seen before it can count
        last = np.minimum(forced, np.maximum(change, due))
        schedule, last = schedule[last < len(time)], last[last < len(time)]
        events.append((schedule, last))
    return _by_schedule(events, len(k))


def latest_degree(
    time: Array, temperature: Array, *, k: ArrayLike, tmax: ArrayLike
) -> list[Indices]:
    """Return the instants of correction with the latest-degree reading of (20).

    Parameters and return value are those of :func:`first_degree`.
    """
    clock, k, tmax = _Clock.of(time), np.atleast_1d(k), np.atleast_1d(tmax)
    changes = np.append(next_changes(temperature), len(time))
    schedule = np.arange(len(k))
    last = np.zeros_like(schedule)
    # a change by a degree is under way since ``reference``; what was seen before it lets ``due``
    reference, forced = last, clock.first_after(last, tmax)
    due = forced
    events = [(schedule, last)]
    while len(schedule):
        change = changes[reference]
        corrects = (due < change) | (forced <= change)
        patience = k[schedule] * clock.between(reference, change)
        patient = np.maximum(change, clock.first_after(last, patience))
        last, reference = np.where(corrects, (due, due), (last, change))
        going = last < len(time)
        events.append((schedule[corrects & going], last[corrects & going]))
        schedule, last, reference = schedule[going], last[going], reference[going]
        forced = clock.first_after(last, tmax[schedule])
        due = np.where(corrects[going], forced, np.minimum(forced, patient[going]))
    return _by_schedule(events, len(k))


BY_READING = {"first_degree": first_degree, "latest_degree": latest_degree}
"""Reading of (20) -> the search for its instants."""


def equally_spaced(time: Array, count: int) -> Indices:
    """Return the given number of instants, spread evenly over the time.

    Parameters
    ----------
    time : ndarray, shape (instants,)
        Growing times. [s]
    count : int
        Number of corrections; the first one is at the first instant.
    """
    wanted = time[0] + (time[-1] - time[0]) * np.arange(count) / max(count, 1)
    return np.unique(np.searchsorted(time, wanted - 1e-9))


@dataclass(frozen=True, slots=True)
class _Clock:
    """The instants, and after them one that never comes.

    ``first`` and ``following`` are, for each instant, the first one of the same time and the first
    one of a later time.
    """

    time: Array
    first: Indices
    following: Indices

    @classmethod
    def of(cls, time: Array) -> "_Clock":
        whole = np.append(time, np.inf)
        changes = np.flatnonzero(np.append(True, np.diff(whole) != 0))
        borders = np.append(changes, len(whole))
        lengths = np.diff(borders)
        return cls(whole, np.repeat(changes, lengths), np.repeat(borders[1:], lengths))

    def between(self, start: Indices, end: Indices) -> Array:
        """Return the times from one to another instant; infinite if the latter never comes. [s]."""
        return self.time[end] - self.time[start]

    def first_after(self, start: Indices, wait: Array) -> Indices:
        """Return the first instants from which on more than ``wait`` [s] has passed."""
        never = len(self.time) - 1
        found = np.searchsorted(self.time, self.time[start] + wait, side="right")
        found = np.minimum(found, never)
        # the sum is rounded otherwise than the difference that (20) compares
        before = self.first[found - 1]
        found = np.where(self.between(start, before) > wait, before, found)
        found = np.where(self.between(start, found) <= wait, self.following[found], found)
        return np.minimum(found, never)


def _by_schedule(events: list[tuple[Indices, Indices]], schedules: int) -> list[Indices]:
    """Return the instants of each schedule from pairs of schedules and instants, step by step."""
    schedule, instant = (np.concatenate(part) for part in zip(*events, strict=True))
    order = np.argsort(schedule, kind="stable")
    borders = np.searchsorted(schedule[order], np.arange(schedules + 1))
    return [instant[order[begin:end]] for begin, end in pairwise(borders)]
