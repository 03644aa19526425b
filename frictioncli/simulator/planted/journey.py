"""What a joint went through in a run, recorded or not: temperatures, heat, travel and rests."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.thermal_history import History

GRID = 10.0
"""Step at which temperatures and heat are kept [s]."""

LEAST_REST = 60.0
"""A joint that stands longer than this rests; shorter standing belongs to the motion [s]."""

NIGHT = 12 * 3600.0
"""Rest before the first motion of a run [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Before:
    """What lies before a run, and how long the whole experiment is.

    Attributes
    ----------
    run : int
        Number of the run, from 0.
    clock : float
        Time from the experiment's start to the run's. [s]
    operated : float
        Duration of the runs before. [s]
    travelled : float
        Angle turned in the runs before. [deg]
    total : float
        Duration of all runs together. [s]
    """

    run: int
    clock: float
    operated: float
    travelled: float
    total: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Journey:
    """A run's past at any time of it.

    Attributes
    ----------
    before : Before
        What lies before the run.
    angles : tuple of float
        Angles between which the joint turns, the lower first. [deg]
    times : ndarray
        Grid of times, :data:`GRID` apart. [s]
    temperatures : dict of str to ndarray
        Node temperatures on the grid. [°C]
    ambient : ndarray
        Ambient temperature on the grid. [°C]
    heat : ndarray
        Dissipated power on the grid. [W]
    edges, travel : ndarray
        Times at which the motion changes, and the angle turned until then in this run. [s], [deg]
    rest_ends, rests : ndarray
        When rests ended, and how long they were. [s]
    """

    before: Before
    angles: tuple[float, float]
    times: Array
    temperatures: dict[str, Array]
    ambient: Array
    heat: Array
    edges: Array
    travel: Array
    rest_ends: Array
    rests: Array

    def on_grid(self, values: Array, time: Array) -> Array:
        """Return values of the grid at times in s."""
        return np.asarray(np.interp(time, self.times, values))

    def travelled(self, time: Array) -> Array:
        """Return the angle turned since the experiment's start, at times in s [deg]."""
        return np.asarray(self.before.travelled + np.interp(time, self.edges, self.travel))

    def last_rest(self, time: Array) -> tuple[Array, Array]:
        """Return the last rest's duration [s] and the angle turned since it [deg]."""
        number = np.maximum(np.searchsorted(self.rest_ends, time, side="right") - 1, 0)
        since = self.travelled(time) - self.travelled(self.rest_ends)[number]
        return self.rests[number], np.maximum(since, 0.0)


def look_back(
    history: History, angles: tuple[float, float], *, first: float, before: Before
) -> Journey:
    """Return a run's journey.

    Parameters
    ----------
    history : History
        The run's temperatures and motions.
    angles : tuple of float
        Angles between which it turns. [deg]
    first : float
        Time of the run's first sample: the rest before it is a night's. [s]
    before : Before
        What lies before the run.
    """
    legs = history.legs()
    edges = np.array([legs[0].start, *(leg.end for leg in legs)])
    travel = np.concatenate([[0.0], np.cumsum([leg.turned for leg in legs])])
    ends, rests = [first], [NIGHT]
    standing = 0.0
    for leg in legs:
        if leg.power is not None:
            if standing > LEAST_REST:
                ends.append(leg.start)
                rests.append(standing)
            standing = 0.0
        else:
            standing += leg.end - leg.start
    times = np.append(np.arange(0.0, history.time, GRID), history.time)
    return Journey(
        before=before,
        angles=(min(angles), max(angles)),
        times=times,
        temperatures=history.at(times),
        ambient=history.ambient.at(times),
        heat=history.heat(times),
        edges=edges,
        travel=travel,
        rest_ends=np.array(ends),
        rests=np.array(rests),
    )
