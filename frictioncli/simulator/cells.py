"""Cells of a run: each round trip in angle bins, as far as the velocity is constant there."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.motion_profile import MotionProfile, Servo, move_duration
from frictioncli.simulator.nuisances.definition import NO_NUISANCES, Nuisances
from frictioncli.simulator.nuisances.motion_and_torque import rippled
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

_GAUSS_POINTS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
"""Points of the two-point Gauss rule for the mean over a bin, in half widths."""

_MANY_POINTS = (np.arange(8) - 3.5) / 4.0
"""Midpoints of equal parts of a bin, for structure finer than the bin, in half widths."""

_FILTER_NODES, _FILTER_WEIGHTS = np.polynomial.laguerre.laggauss(3)
"""Gauss-Laguerre rule for the mean over what a first-order filter remembers."""


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
    logged : ndarray
        Logged angles of the points that are averaged; axes as in the state. [deg]
    state : State
        State of the joint there; every array has the axes point in the bin, direction (forward
        first) and cell.
    earlier : tuple of (float, State)
        States whose torque is logged there, with weights that sum to 1: the state itself unless the
        torque is late or filtered.
    """

    trip: Numbers
    position: Array
    count: Numbers
    logged: Array
    state: State
    earlier: tuple[tuple[float, State], ...]


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
    nuisances: Nuisances = NO_NUISANCES,
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
    nuisances : Nuisances, optional
        What joint and log do besides.

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
    inside = _MANY_POINTS if nuisances else _GAUSS_POINTS
    points = middle + inside[:, None] * half
    logged = np.stack([points, points], axis=1)
    way = np.array([1.0, -1.0])[:, None]
    position = logged - way * nuisances.size("backlash") / 2.0
    # The reverse move comes half a round trip later, from the other end.
    distance = np.stack([position[:, 0] - low, high - position[:, 1]], axis=1)
    since = distance / speed + speed / (2.0 * acceleration) + LAG
    halves = {
        value: move_duration(joint.servo, distance=high - low, speed=value) + program.dwell
        for value in bins
    }
    later = np.array([0.0, 1.0])[:, None] * np.array([halves[value] for value in speed])
    time = begin + later + since
    velocity = np.broadcast_to(way * speed, position.shape)

    def state_before(delay: float) -> State:
        motion = MotionProfile(
            position=position - velocity * delay,
            velocity=velocity,
            acceleration=np.zeros(position.shape),
        )
        return state_of(
            joint,
            operation,
            rippled(motion, nuisances),
            time=time - delay,
            since_reversal=np.maximum(since - delay, 0.0),
            temperatures=history.at(time - delay),
        )

    state = state_before(0.0)
    delays = _delays(nuisances)
    return Cells(
        trip=trip,
        position=(np.floor(middle / BIN_WIDTH) + 0.5) * BIN_WIDTH,
        count=count.astype(np.int64),
        logged=logged,
        state=state,
        earlier=tuple((weight, state_before(delay)) for weight, delay in delays)
        if delays
        else ((1.0, state),),
    )


def _delays(nuisances: Nuisances) -> list[tuple[float, float]]:
    """Return weights and delays [s] of the torques that are logged together, none if there are."""
    late, time_constant = nuisances.size("torque_delay"), nuisances.size("torque_filter")
    if time_constant > 0.0:
        nodes = late + time_constant * _FILTER_NODES
        return list(zip(_FILTER_WEIGHTS.tolist(), nodes.tolist(), strict=True))
    return [(1.0, late)] if late > 0.0 else []


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
