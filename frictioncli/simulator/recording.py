"""What the controller logs of a series: equation (1) for the torque, and the registered signals."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.motion_profile import MotionProfile, round_trips
from frictioncli.simulator.noise import SimulatedNoise
from frictioncli.simulator.paper_protocol import PaperProgram, SeriesOfMoves
from frictioncli.simulator.planted.journey import Journey
from frictioncli.simulator.planted.state import STANDING_SPEED, Extra, State, state_of
from frictioncli.simulator.thermal_history import HOUSING, MOTOR, History


@dataclass(frozen=True, slots=True, kw_only=True)
class Logger:
    """How the controller samples and logs.

    Attributes
    ----------
    interval : float
        Sampling interval. [s]
    position_step : float
        Resolution of the joint encoder. [deg]
    torque_step : float
        Resolution of the torque. [N·m]
    motor_step : float
        Resolution of the registered motor temperature. [°C]
    housing_step : float
        Resolution of the housing sensor. [°C]
    sign : int
        +1: torque is load + friction in forward motion; -1: load - friction, as in the paper's (1).
    """

    interval: float
    position_step: float
    torque_step: float
    motor_step: float
    housing_step: float
    sign: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """The logged signals of one series.

    Attributes
    ----------
    time : ndarray
        Time since the recording's start. [s]
    position : ndarray
        Joint angle. [deg]
    torque : ndarray
        Control torque at the joint. [N·m]
    motor_temperature, housing_temperature : ndarray
        Registered temperatures. [°C]
    """

    time: Array
    position: Array
    torque: Array
    motor_temperature: Array
    housing_temperature: Array


def registered(value: ArrayLike, step: float) -> Array:
    """Return ``value`` as a sensor with resolution ``step`` registers it: the nearest step."""
    return np.asarray(np.floor(np.asarray(value, dtype=float) / step + 0.5) * step)


def control_torque(
    joint: SimulatedJoint,
    motion: MotionProfile,
    *,
    temperatures: dict[str, Array],
    sign: int,
    friction_offset: Array | float = 0.0,
) -> Array:
    r"""Return the control torque of a motion, without noise [N·m].

    Parameters
    ----------
    joint : SimulatedJoint
        The joint.
    motion : MotionProfile
        Its motion.
    temperatures : dict
        Node temperatures at the motion's samples. [°C]
    sign : int
        Sign convention of the log, +1 or -1.
    friction_offset : ndarray or float
        Further friction torque. [N·m]

    Notes
    -----
    Equation (1) of the paper for one joint, for which the Coriolis term is zero:

    .. math:: u = M \ddot\varphi + L(\varphi) \pm \operatorname{sign}(\dot\varphi) \tau
    """
    load = joint.arm.gravity_torque(motion.position)
    friction = joint.friction(load=load, speed=np.abs(motion.velocity), temperatures=temperatures)
    direction = np.clip(motion.velocity / STANDING_SPEED, -1.0, 1.0)
    inertial = joint.arm.inertia() * np.radians(motion.acceleration)
    return np.asarray(inertial + load + sign * direction * (friction + friction_offset))


def record(
    joint: SimulatedJoint,
    program: PaperProgram,
    history: History,
    series: SeriesOfMoves,
    *,
    logger: Logger,
    noise: SimulatedNoise,
    pair_offsets: Array,
    generator: np.random.Generator,
    hidden: Callable[[State], Extra] | None = None,
    journey: Journey | None = None,
) -> Recording:
    """Return what the controller logs of ``series``.

    Parameters
    ----------
    joint, program, history : SimulatedJoint, PaperProgram, History
        What moves, how, and at which temperatures.
    series : SeriesOfMoves
        The series to log.
    logger : Logger
        Sampling and resolutions.
    noise : SimulatedNoise
        Torque noise.
    pair_offsets : ndarray
        Friction offset of each of the series' round trips. [N·m]
    generator : numpy.random.Generator
        Source of the torque noise.
    hidden : callable, optional
        Returns what planted effects add at a state.
    journey : Journey, optional
        What the joint went through, for the effects.
    """
    motion, time, trips = round_trips(
        joint.servo,
        speeds=series.speeds,
        angles=program.angles,
        lead=program.lead,
        dwell=program.dwell,
        interval=logger.interval,
    )
    temperatures = history.at(series.start + time)
    torque = control_torque(
        joint,
        motion,
        temperatures=temperatures,
        sign=logger.sign,
        friction_offset=pair_offsets[trips],
    )
    if hidden is not None and journey is not None:
        begins = program.move_begins(joint.servo, series.speeds)
        move = np.maximum(np.searchsorted(begins, time, side="right") - 1, 0)
        state = state_of(
            joint,
            journey,
            motion,
            time=series.start + time,
            since_reversal=np.maximum(time - begins[move], 0.0),
            temperatures=temperatures,
        )
        extra = hidden(state)
        torque = torque + extra.load + logger.sign * state.direction * extra.friction
    torque = torque + noise.on(
        generator, torque=torque, velocity=motion.velocity, interval=logger.interval
    )
    return Recording(
        time=time,
        position=registered(motion.position, logger.position_step),
        torque=registered(torque, logger.torque_step),
        motor_temperature=registered(temperatures[MOTOR], logger.motor_step),
        housing_temperature=registered(temperatures[HOUSING], logger.housing_step),
    )
