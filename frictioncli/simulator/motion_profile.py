"""Moves of a joint: trapezoidal speed profiles as the servo follows them."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array, Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Servo:
    """Servo of a joint that follows a commanded speed.

    Attributes
    ----------
    acceleration : float
        Commanded acceleration at both ends of a move. [deg/s²]
    frequency : float
        Natural frequency of the position loop on the elastic arm. [Hz]
    damping : float
        Its damping ratio, below 1: the speed settles with a small oscillation. [-]
    """

    acceleration: float
    frequency: float
    damping: float


@dataclass(frozen=True, slots=True)
class MotionProfile:
    """Position, velocity and acceleration at sample times [deg, deg/s, deg/s²]."""

    position: Array
    velocity: Array
    acceleration: Array


def move_duration(servo: Servo, *, distance: float, speed: float) -> float:
    """Return the duration of a commanded move.

    Parameters
    ----------
    servo : Servo
        Servo of the joint.
    distance : float
        Angle of the move, > 0. [deg]
    speed : float
        Commanded speed. [deg/s]

    Returns
    -------
    float
        Duration. [s]

    Examples
    --------
    >>> servo = Servo(acceleration=400.0, frequency=6.0, damping=0.45)
    >>> move_duration(servo, distance=100.0, speed=50.0)
    2.125
    """
    ramp, cruise = _ramp_and_cruise(servo, distance=distance, speed=speed)
    return 2.0 * ramp + cruise


def follow(
    servo: Servo, *, time: ArrayLike, start: float, distance: float, speed: float
) -> MotionProfile:
    r"""Return the motion of a move that is commanded from time 0.

    Parameters
    ----------
    servo : Servo
        Servo of the joint.
    time : array_like
        Sample times. [s]
    start : float
        Angle before the move. [deg]
    distance : float
        Signed angle of the move. [deg]
    speed : float
        Commanded speed, > 0. [deg/s]

    Returns
    -------
    MotionProfile
        Position, velocity and acceleration at the times.

    Notes
    -----
    The command is a sum of four ramps of speed. The servo has the transfer function
    :math:`H(s) = \omega^2/(s^2 + 2\zeta\omega s + \omega^2)`, whose responses to step, ramp and
    parabola are known in closed form, so that velocity is the exact derivative of position.
    """
    ramp, cruise = _ramp_and_cruise(servo, distance=abs(distance), speed=speed)
    switches = ((0.0, 1.0), (ramp, -1.0), (ramp + cruise, -1.0), (2.0 * ramp + cruise, 1.0))
    times = np.asarray(time, dtype=float)
    scale = np.sign(distance) * servo.acceleration
    total = np.zeros((3, *times.shape))
    for switch, weight in switches:
        total += scale * weight * _responses(servo, times - switch)
    return MotionProfile(position=start + total[0], velocity=total[1], acceleration=total[2])


def round_trips(
    servo: Servo,
    *,
    speeds: tuple[float, ...],
    angles: tuple[float, float],
    lead: float,
    dwell: float,
    interval: float,
    delay: float = 0.0,
) -> tuple[MotionProfile, Array, Numbers]:
    """Return moves there and back at each speed, sampled from standing to standing.

    Parameters
    ----------
    servo : Servo
        Servo of the joint.
    speeds : tuple of float
        Speed of each round trip. [deg/s]
    angles : tuple of float
        Angles between which the joint turns; it starts at the first. [deg]
    lead : float
        Standing time before the first move. [s]
    dwell : float
        Standing time after each move. [s]
    interval : float
        Sampling interval. [s]
    delay : float
        Time by which the motion is earlier than its sample; the joint stands before it. [s]

    Returns
    -------
    MotionProfile
        The sampled motion.
    ndarray
        Times of that motion. [s]
    ndarray
        Number of the round trip that each sample belongs to.
    """
    first, second = angles
    distance = second - first
    moves: list[tuple[float, float, float, float]] = []
    clock = lead
    for speed in speeds:
        for start, signed in ((first, distance), (second, -distance)):
            moves.append((clock, start, signed, speed))
            clock += move_duration(servo, distance=abs(signed), speed=speed) + dwell
    times = np.arange(int(np.ceil(clock / interval)), dtype=np.float64) * interval
    times = times - delay
    # A move has the samples until the next one begins; the first also has the lead.
    edges = [-np.inf, *(begin for begin, *_ in moves[1:]), np.inf]
    profiles: list[MotionProfile] = []
    trips = np.zeros(times.shape, dtype=np.int64)
    for number, ((low, high), (begin, start, signed, speed)) in enumerate(
        zip(pairwise(edges), moves, strict=True)
    ):
        inside = (times >= low) & (times < high)
        trips[inside] = number // 2
        profiles.append(
            follow(servo, time=times[inside] - begin, start=start, distance=signed, speed=speed)
        )
    motion = MotionProfile(
        position=np.concatenate([move.position for move in profiles]),
        velocity=np.concatenate([move.velocity for move in profiles]),
        acceleration=np.concatenate([move.acceleration for move in profiles]),
    )
    return motion, times, trips


def _ramp_and_cruise(servo: Servo, *, distance: float, speed: float) -> tuple[float, float]:
    """Return the durations of a ramp and of the constant speed [s]."""
    ramp = speed / servo.acceleration
    if ramp * speed >= distance:  # too short to reach the speed: a triangle
        return float(np.sqrt(distance / servo.acceleration)), 0.0
    return ramp, distance / speed - ramp


def _responses(servo: Servo, time: Array) -> Array:
    """Return the responses of the servo to a unit parabola, ramp and step that begin at time 0."""
    omega, zeta = 2.0 * np.pi * servo.frequency, servo.damping
    pole = omega * complex(-zeta, np.sqrt(1.0 - zeta**2))
    t = np.maximum(time, 0.0)
    oscillation = np.exp(pole * t) * omega**2 / (2j * pole.imag)
    parabola = t**2 / 2.0 - 2.0 * zeta / omega * t + (4.0 * zeta**2 - 1.0) / omega**2
    ramp = t - 2.0 * zeta / omega
    step = np.ones_like(t)
    transients = 2.0 * np.real([oscillation / pole**3, oscillation / pole**2, oscillation / pole])
    return np.where(time > 0.0, np.array([parabola, ramp, step]) + transients, 0.0)
