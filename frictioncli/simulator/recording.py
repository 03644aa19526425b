"""Recording of a measuring series: control torque by equation (1), and the registered signals."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array, Numbers
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.motion_profile import MotionProfile, round_trips
from frictioncli.simulator.noise import SimulatedNoise
from frictioncli.simulator.nuisances.definition import NO_NUISANCES, Nuisances
from frictioncli.simulator.nuisances.motion_and_torque import (
    clock_factor,
    filtered,
    logged_position,
    other_joint_torque,
    rippled,
)
from frictioncli.simulator.paper_protocol import MeasuringSeries, PaperProgram
from frictioncli.simulator.planted.operating_history import OperatingHistory
from frictioncli.simulator.planted.planting import PlantedEffects
from frictioncli.simulator.planted.state import STANDING_SPEED, state_of
from frictioncli.simulator.thermal_history import HOUSING, MOTOR, History


@dataclass(frozen=True, slots=True, kw_only=True)
class Logger:
    """Sampling and resolutions of the controller's log.

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
    """Logged signals of one series.

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
    """Return a value as a sensor registers it: rounded to the nearest step.

    Parameters
    ----------
    value : array_like
        True value. [any unit]
    step : float
        Resolution of the sensor. [same unit]

    Returns
    -------
    ndarray
        Registered value. [same unit]

    Examples
    --------
    >>> registered([24.4, 24.5], 1.0)
    array([24., 25.])
    """
    return np.asarray(np.floor(np.asarray(value, dtype=float) / step + 0.5) * step)


def control_torque(
    joint: SimulatedJoint,
    motion: MotionProfile,
    *,
    temperatures: dict[str, Array],
    sign: int,
    friction_offset: Array | float = 0.0,
) -> Array:
    r"""Return the control torque of a motion, without noise.

    Parameters
    ----------
    joint : SimulatedJoint
        The joint.
    motion : MotionProfile
        Its motion.
    temperatures : dict of str to ndarray
        Node temperatures at the samples. [°C]
    sign : int
        Sign convention of the log, +1 or -1.
    friction_offset : ndarray or float
        Further friction torque. [N·m]

    Returns
    -------
    ndarray, shape (samples,)
        Control torque. [N·m]

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
    series: MeasuringSeries,
    *,
    logger: Logger,
    noise: SimulatedNoise,
    pair_offsets: Array,
    generator: np.random.Generator,
    planted: PlantedEffects | None = None,
    operation: OperatingHistory | None = None,
    nuisances: Nuisances = NO_NUISANCES,
    number: tuple[int, int] = (0, 0),
) -> Recording:
    """Return the recording of a series.

    Parameters
    ----------
    joint : SimulatedJoint
        The joint.
    program : PaperProgram
        Its moves.
    history : History
        Its temperatures.
    series : MeasuringSeries
        The series to record.
    logger : Logger
        Sampling and resolutions.
    noise : SimulatedNoise
        Torque noise.
    pair_offsets : ndarray
        Friction offset of each of the series' round trips. [N·m]
    generator : numpy.random.Generator
        Source of the torque noise.
    planted : PlantedEffects, optional
        Effects that add torque.
    operation : OperatingHistory, optional
        Operating history on which the effects depend.
    nuisances : Nuisances, optional
        What joint and log do besides.
    number : tuple of int
        Numbers of the run and of the series in it.

    Returns
    -------
    Recording
        Logged signals.
    """
    interval = logger.interval * clock_factor(nuisances)

    def sampled(delay: float) -> tuple[MotionProfile, Array, Numbers]:
        motion, time, trips = round_trips(
            joint.servo,
            speeds=series.speeds,
            angles=program.angles,
            lead=program.lead,
            dwell=program.dwell,
            interval=interval,
            delay=delay,
        )
        return rippled(motion, nuisances), time, trips

    logged, logged_time, _ = sampled(0.0)
    # the torque of a sample is that of an earlier moment if it is logged late
    motion, time, trips = sampled(nuisances.size("torque_delay"))
    temperatures = history.at(series.start + time)
    torque = control_torque(
        joint,
        motion,
        temperatures=temperatures,
        sign=logger.sign,
        friction_offset=pair_offsets[trips],
    )
    if planted is not None and operation is not None:
        begins = program.move_begins(joint.servo, series.speeds)
        move = np.maximum(np.searchsorted(begins, time, side="right") - 1, 0)
        state = state_of(
            joint,
            operation,
            motion,
            time=series.start + time,
            since_reversal=np.maximum(time - begins[move], 0.0),
            temperatures=temperatures,
        )
        added = planted.torque(state)
        torque = torque + added.load + logger.sign * state.direction * added.friction
    if nuisances:
        torque = filtered(
            torque + other_joint_torque(nuisances, *number, since_start=time), interval, nuisances
        )
        torque = torque + nuisances.size("torque_offset")
    torque = torque + noise.torque_noise(
        generator, torque=torque, velocity=motion.velocity, interval=logger.interval
    )
    registers = history.at(series.start + logged_time)
    return Recording(
        time=logged_time / clock_factor(nuisances),
        position=registered(logged_position(logged, nuisances), logger.position_step),
        torque=registered(torque, logger.torque_step),
        motor_temperature=registered(registers[MOTOR], logger.motor_step),
        housing_temperature=registered(registers[HOUSING], logger.housing_step),
    )
