"""The cells of a run: each round trip in angle bins, as far as velocity is constant there."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.motion_profile import MotionProfile, Servo, move_duration
from frictioncli.simulator.paper_protocol import PaperProgram, SeriesOfMoves
from frictioncli.simulator.planted.journey import Journey
from frictioncli.simulator.planted.state import State, state_of
from frictioncli.simulator.thermal_history import History

BIN = 5.0
"""Width of the angle bins [deg]."""

SETTLING = 0.2
"""Time after acceleration that is not yet constant velocity, at most a quarter of the rest [s]."""

LAG = 0.03
"""Time by which the joint follows its command [s]."""

COVERED = 0.6
"""Least share of a bin that must be passed at constant velocity."""

_POINTS = 1.0 / np.sqrt(3.0)
"""Both points of Gauss's rule that stand for the mean over a bin, in half widths."""


@dataclass(frozen=True, slots=True)
class Cells:
    """The cells of one payload of a run.

    Attributes
    ----------
    trip : ndarray
        Number of the round trip in the run that each cell belongs to.
    position : ndarray
        Centre of its angle bin. [deg]
    count : ndarray
        Samples of either direction in it.
    state : State
        State of the joint; every array has the axes point in the bin, direction (forward first) and
        cell.
    """

    trip: Numbers
    position: Array
    count: Numbers
    state: State


@dataclass(frozen=True, slots=True)
class Trips:
    """All round trips of a run, in order of time.

    Attributes
    ----------
    series : ndarray
        Number of the series that each belongs to.
    begin : ndarray
        When its first move begins. [s]
    speed : ndarray
        Its speed. [deg/s]
    load : ndarray
        Number of the payload.
    """

    series: Numbers
    begin: Array
    speed: Array
    load: Numbers


def trips_of(program: PaperProgram, servo: Servo, series: tuple[SeriesOfMoves, ...]) -> Trips:
    """Return the round trips of a run's series."""
    counts = [len(one.speeds) for one in series]
    return Trips(
        series=np.repeat(np.arange(len(series)), counts),
        begin=np.concatenate(
            [one.start + program.of(one).trip_begins(servo, one.speeds) for one in series]
        ),
        speed=np.concatenate([one.speeds for one in series]),
        load=np.repeat([one.load for one in series], counts),
    )


def cells_of(
    joint: SimulatedJoint,
    program: PaperProgram,
    history: History,
    journey: Journey,
    trips: Trips,
    *,
    load: int,
    interval: float,
) -> Cells:
    """Return the cells of all round trips with one payload.

    Parameters
    ----------
    joint : SimulatedJoint
        The joint with that payload.
    program, history, journey, trips : PaperProgram, History, Journey, Trips
        The run.
    load : int
        Number of the payload.
    interval : float
        Sampling interval. [s]
    """
    low, high = journey.angles
    acceleration = joint.servo.acceleration
    own = np.flatnonzero(trips.load == load)
    bins = {
        speed: _bins(speed, low, high, acceleration, interval) for speed in set(trips.speed[own])
    }
    sizes = [len(bins[trips.speed[number]][0]) for number in own]
    trip = np.repeat(own, sizes)
    empty = (np.empty(0), np.empty(0), np.empty(0))
    edges = [bins[trips.speed[number]] for number in own] or [empty]
    start, stop, count = (np.concatenate(column) for column in zip(*edges, strict=True))
    speed, begin = trips.speed[trip], trips.begin[trip]
    middle, half = (start + stop) / 2.0, (stop - start) / 2.0
    points = np.stack([middle - half * _POINTS, middle + half * _POINTS])
    position = np.stack([points, points], axis=1)
    # The reverse move comes half a round trip later, from the other end.
    away = np.stack([points - low, high - points], axis=1)
    since = away / speed + speed / (2.0 * acceleration) + LAG
    halves = {
        value: move_duration(joint.servo, distance=high - low, speed=value) + program.dwell
        for value in bins
    }
    later = np.array([0.0, 1.0])[:, None] * np.array([halves[value] for value in speed])
    time = begin + later + since
    way = np.array([1.0, -1.0])[:, None] * speed
    velocity = np.broadcast_to(way, position.shape)
    state = state_of(
        joint,
        journey,
        MotionProfile(position=position, velocity=velocity, acceleration=np.zeros(position.shape)),
        time=time,
        since_reversal=since,
        temperatures=history.at(time),
    )
    centre = (np.floor(middle / BIN) + 0.5) * BIN
    return Cells(trip=trip, position=centre, count=count.astype(np.int64), state=state)


def _bins(
    speed: float, low: float, high: float, acceleration: float, interval: float
) -> tuple[Array, Array, Array]:
    """Return start [deg], stop [deg] and samples of the bins that are covered at ``speed``."""
    ramp = speed**2 / (2.0 * acceleration)
    plateau = max((high - low - 2.0 * ramp) / speed, 0.0)
    settled = ramp + speed * (min(SETTLING, plateau / 4.0) + LAG)
    edges = np.arange(np.floor(low / BIN), np.ceil(high / BIN)) * BIN
    start = np.maximum(edges, low + settled)
    stop = np.minimum(edges + BIN, high - settled)
    count = np.maximum(np.round((stop - start) / speed / interval), 0.0)
    kept = (stop - start >= COVERED * BIN) & (count >= 1.0)
    return start[kept], stop[kept], count[kept]
