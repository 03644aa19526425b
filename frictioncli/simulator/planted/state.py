"""State of the joint at each sample, on which the laws of planted effects depend."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.motion_profile import MotionProfile
from frictioncli.simulator.planted.operating_history import OperatingHistory
from frictioncli.simulator.thermal_history import MOTOR

STANDING_SPEED = 0.2
"""Velocity below which friction falls linearly to zero, so that torque is load at rest [deg/s]."""


@dataclass(frozen=True, slots=True)
class AddedTorque:
    """Torque that an effect adds.

    Attributes
    ----------
    friction : ndarray or float
        Torque that opposes the motion where positive. [N·m]
    load : ndarray or float
        Torque that is the same in both directions. [N·m]
    """

    friction: Array | float = 0.0
    load: Array | float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """State of the joint at samples of one run.

    Attributes
    ----------
    joint : SimulatedJoint
        The joint without planted effects.
    operation : OperatingHistory
        Its operating history.
    time : ndarray
        Time in the run's thermal history. [s]
    position, velocity, acceleration : ndarray
        Motion. [deg], [deg/s], [deg/s²]
    since_reversal : ndarray
        Time since the start of the stroke. [s]
    temperatures : mapping of str to ndarray
        Node temperatures. [°C]
    load, friction, inertial : ndarray
        Gravity, friction and inertial torque without the effect. [N·m]
    """

    joint: SimulatedJoint
    operation: OperatingHistory
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    since_reversal: Array
    temperatures: Mapping[str, Array]
    load: Array
    friction: Array
    inertial: Array

    @property
    def speed(self) -> Array:
        """Absolute velocity [deg/s]."""
        return np.abs(self.velocity)

    @property
    def direction(self) -> Array:
        """+1 forward, -1 in reverse, in between near rest [-]."""
        return np.clip(self.velocity / STANDING_SPEED, -1.0, 1.0)

    @property
    def motor(self) -> Array:
        """True motor temperature, without the sensor's lag [°C]."""
        return self.temperatures.get("motor", self.temperatures[MOTOR])

    @property
    def gear(self) -> Array:
        """Gear temperature [°C]."""
        return self.temperatures["gear"]

    @property
    def travelled(self) -> Array:
        """Angle turned since the experiment's start, unrecorded moves included [deg]."""
        return self.operation.travelled(self.time)

    @property
    def operated(self) -> Array:
        """Duration of the runs so far, without the nights [s]."""
        return self.operation.earlier.operated + self.time

    @property
    def progress(self) -> Array:
        """Share of the duration of all runs that has passed [-]."""
        return self.operated / self.operation.earlier.total

    @property
    def since_turn(self) -> Array:
        """Angle since the last reversal [deg]."""
        low, high = self.operation.angles
        forward = self.velocity > 0.0
        return np.maximum(np.where(forward, self.position - low, high - self.position), 0.0)


def state_of(
    joint: SimulatedJoint,
    operation: OperatingHistory,
    motion: MotionProfile,
    *,
    time: Array,
    since_reversal: Array,
    temperatures: Mapping[str, Array],
) -> State:
    """Return the state of a joint in motion; parameters as the attributes of :class:`State`."""
    load = joint.arm.gravity_torque(motion.position)
    return State(
        joint=joint,
        operation=operation,
        time=time,
        position=motion.position,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        since_reversal=since_reversal,
        temperatures=temperatures,
        load=load,
        friction=joint.friction(
            load=load, speed=np.abs(motion.velocity), temperatures=temperatures
        ),
        inertial=joint.arm.inertia() * np.radians(motion.acceleration),
    )
