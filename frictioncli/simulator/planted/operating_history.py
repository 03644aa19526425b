"""Operating history of a joint: temperatures, heat, travel and rests, recorded or not."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.thermal_history import History

TIME_STEP = 10.0
"""Step of the grid on which temperatures and heat are kept [s]."""

SHORTEST_REST = 60.0
"""Standing for longer than this is a rest; shorter standing belongs to the motion [s]."""

NIGHT = 12 * 3600.0
"""Rest before the first motion of a run [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EarlierRuns:
    """Totals of the runs before a run, and the duration of the whole experiment.

    Attributes
    ----------
    operated : float
        Duration of the runs before. [s]
    travelled : float
        Angle turned in the runs before. [deg]
    total : float
        Duration of all runs together. [s]
    """

    operated: float
    travelled: float
    total: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingHistory:
    """Operating history of a run.

    Attributes
    ----------
    earlier : EarlierRuns
        Totals of the runs before.
    angles : tuple of float
        Angles between which the joint turns, the lower first. [deg]
    times : ndarray, shape (times,)
        Grid of times, :data:`TIME_STEP` apart. [s]
    temperatures : dict of str to ndarray, shape (times,)
        Node temperatures on the grid. [°C]
    ambient : ndarray, shape (times,)
        Ambient temperature on the grid. [°C]
    heat : ndarray, shape (times,)
        Dissipated power on the grid. [W]
    edges : ndarray, shape (intervals + 1,)
        Times at which the motion changes. [s]
    travel : ndarray, shape (intervals + 1,)
        Angle turned until then in this run. [deg]
    rest_ends : ndarray, shape (rests,)
        Ends of the rests. [s]
    rests : ndarray, shape (rests,)
        Durations of the rests. [s]
    """

    earlier: EarlierRuns
    angles: tuple[float, float]
    times: Array
    temperatures: dict[str, Array]
    ambient: Array
    heat: Array
    edges: Array
    travel: Array
    rest_ends: Array
    rests: Array

    def at(self, time: Array, values: Array) -> Array:
        """Return values on the grid, interpolated at times in s."""
        return np.asarray(np.interp(time, self.times, values))

    def travelled(self, time: Array) -> Array:
        """Return the angle turned since the experiment's start, at times in s [deg]."""
        return np.asarray(self.earlier.travelled + np.interp(time, self.edges, self.travel))

    def last_rest(self, time: Array) -> tuple[Array, Array]:
        """Return the duration of the last rest [s] and the angle turned since it [deg]."""
        number = np.maximum(np.searchsorted(self.rest_ends, time, side="right") - 1, 0)
        since = self.travelled(time) - self.travelled(self.rest_ends)[number]
        return self.rests[number], np.maximum(since, 0.0)


def operating_history(
    history: History, angles: tuple[float, float], *, first: float, earlier: EarlierRuns
) -> OperatingHistory:
    """Return the operating history of a run.

    Parameters
    ----------
    history : History
        Temperatures and motions of the run.
    angles : tuple of float
        Angles between which it turns. [deg]
    first : float
        Time of the run's first sample; the rest before it is a night's. [s]
    earlier : EarlierRuns
        Totals of the runs before.

    Returns
    -------
    OperatingHistory
        Temperatures, heat, travel and rests of the run.
    """
    intervals = history.intervals()
    edges = np.array([intervals[0].start, *(one.end for one in intervals)])
    travel = np.concatenate([[0.0], np.cumsum([one.turned for one in intervals])])
    ends, rests = [first], [NIGHT]
    standing = 0.0
    for interval in intervals:
        if interval.power is not None:
            if standing > SHORTEST_REST:
                ends.append(interval.start)
                rests.append(standing)
            standing = 0.0
        else:
            standing += interval.end - interval.start
    times = np.append(np.arange(0.0, history.time, TIME_STEP), history.time)
    return OperatingHistory(
        earlier=earlier,
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
