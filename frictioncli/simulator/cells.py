"""Cells of a run: each round trip in angle bins, as far as the velocity is constant there."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.motion_profile import MotionProfile, Servo, move_duration
from frictioncli.simulator.paper_protocol import MeasuringSeries, PaperProgram
from frictioncli.simulator.planted.operating_history import OperatingHistory
from frictioncli.simulator.planted.state import State, state_of
from frictioncli.simulator.thermal_history import History

BIN_WIDTH = 5.0
"""Width of the angle bins [deg]."""

SETTLING = 0.2
"""Settling time after acceleration, at most a quarter of the constant speed [s]."""

LAG = 0.03
"""Delay of the joint behind its command [s]."""

LEAST_COVERAGE = 0.6
"""Least share of a bin that is crossed at constant velocity [-]."""

_GAUSS_POINT = 1.0 / np.sqrt(3.0)
"""Points of the two-point Gauss rule for the mean over a bin, in half widths, are at ± this."""


@dataclass(frozen=True, slots=True)
class Cells:
    """The cells of one payload of a run.

    Attributes
    ----------
    trip : ndarray, shape (cells,)
        Round trip of each cell, counted in the run.
    position : ndarray, shape (cells,)
        Centre of the angle bin. [deg]
    count : ndarray, shape (cells,)
        Samples of each direction in it.
    state : State
        State of the joint; every array has the axes point in the bin, direction (forward first) and
        cell.
    """

    trip: Numbers
    position: Array
    count: Numbers
    state: State


@dataclass(frozen=True, slots=True)
class RoundTrips:
    """Round trips of a run, in order of time.

    Attributes
    ----------
    series : ndarray, shape (trips,)
        Series of each, counted in the run.
    begin : ndarray, shape (trips,)
        Start of its first move. [s]
    speed : ndarray, shape (trips,)
        Its speed. [deg/s]
    payload_index : ndarray, shape (trips,)
        Which of the run's payloads it carries.
    """

    series: Numbers
    begin: Array
    speed: Array
    payload_index: Numbers


def round_trips_of(
    program: PaperProgram, servo: Servo, series: tuple[MeasuringSeries, ...]
) -> RoundTrips:
    """Return the round trips of a run's series."""
    counts = [len(one.speeds) for one in series]
    return RoundTrips(
        series=np.repeat(np.arange(len(series)), counts),
        begin=np.concatenate(
            [one.start + program.for_series(one).trip_begins(servo, one.speeds) for one in series]
        ),
        speed=np.concatenate([one.speeds for one in series]),
        payload_index=np.repeat([one.payload_index for one in series], counts),
    )


def cells_of(
    joint: SimulatedJoint,
    program: PaperProgram,
    history: History,
    operation: OperatingHistory,
    trips: RoundTrips,
    *,
    payload_index: int,
    interval: float,
) -> Cells:
    """Return the cells of all round trips with one payload.

    Parameters
    ----------
    joint : SimulatedJoint
        The joint with that payload.
    program : PaperProgram
        Motion program.
    history : History
        Temperatures of the run.
    operation : OperatingHistory
        Operating history of the run.
    trips : RoundTrips
        Round trips of the run.
    payload_index : int
        Which of the run's payloads.
    interval : float
        Sampling interval. [s]

    Returns
    -------
    Cells
        The cells.
    """
    low, high = operation.angles
    acceleration = joint.servo.acceleration
    chosen = np.flatnonzero(trips.payload_index == payload_index)
    bins = {
        speed: _bins(speed, low, high, acceleration, interval) for speed in set(trips.speed[chosen])
    }
    sizes = [len(bins[trips.speed[number]][0]) for number in chosen]
    trip = np.repeat(chosen, sizes)
    empty = (np.empty(0), np.empty(0), np.empty(0))
    edges = [bins[trips.speed[number]] for number in chosen] or [empty]
    start, stop, count = (np.concatenate(column) for column in zip(*edges, strict=True))
    speed, begin = trips.speed[trip], trips.begin[trip]
    middle, half = (start + stop) / 2.0, (stop - start) / 2.0
    points = np.stack([middle - half * _GAUSS_POINT, middle + half * _GAUSS_POINT])
    position = np.stack([points, points], axis=1)
    # The reverse move comes half a round trip later, from the other end.
    distance = np.stack([points - low, high - points], axis=1)
    since = distance / speed + speed / (2.0 * acceleration) + LAG
    halves = {
        value: move_duration(joint.servo, distance=high - low, speed=value) + program.dwell
        for value in bins
    }
    later = np.array([0.0, 1.0])[:, None] * np.array([halves[value] for value in speed])
    time = begin + later + since
    signed_speed = np.array([1.0, -1.0])[:, None] * speed
    velocity = np.broadcast_to(signed_speed, position.shape)
    state = state_of(
        joint,
        operation,
        MotionProfile(position=position, velocity=velocity, acceleration=np.zeros(position.shape)),
        time=time,
        since_reversal=since,
        temperatures=history.at(time),
    )
    centre = (np.floor(middle / BIN_WIDTH) + 0.5) * BIN_WIDTH
    return Cells(trip=trip, position=centre, count=count.astype(np.int64), state=state)


def _bins(
    speed: float, low: float, high: float, acceleration: float, interval: float
) -> tuple[Array, Array, Array]:
    """Return start [deg], stop [deg] and samples of the bins that are covered at ``speed``."""
    ramp = speed**2 / (2.0 * acceleration)
    plateau = max((high - low - 2.0 * ramp) / speed, 0.0)
    settled = ramp + speed * (min(SETTLING, plateau / 4.0) + LAG)
    edges = np.arange(np.floor(low / BIN_WIDTH), np.ceil(high / BIN_WIDTH)) * BIN_WIDTH
    start = np.maximum(edges, low + settled)
    stop = np.minimum(edges + BIN_WIDTH, high - settled)
    count = np.maximum(np.round((stop - start) / speed / interval), 0.0)
    kept = (stop - start >= LEAST_COVERAGE * BIN_WIDTH) & (count >= 1.0)
    return start[kept], stop[kept], count[kept]
