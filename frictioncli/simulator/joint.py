"""Simulated joint: arm, servo, friction zones, thermal network and dissipated power."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.arm import Arm
from frictioncli.simulator.friction_zones import Zone, friction_torque
from frictioncli.simulator.motion_profile import Servo, move_duration, round_trips
from frictioncli.simulator.thermal_network import ThermalNetwork


@dataclass(frozen=True, slots=True, kw_only=True)
class HeatEntry:
    """Nodes at which the dissipated power enters the thermal network.

    The shares determine the sign of the hysteresis between heating and cooling. While heating, the
    grease is colder than the motor if the heat enters there, and warmer if it enters at the gear.

    Attributes
    ----------
    copper_loss : float
        Copper loss per square of the control torque. [W/(N·m)²]
    shares : mapping of str to float
        Share of copper loss and friction heat that enters at each node; they sum to 1. [-]
    """

    copper_loss: float
    shares: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class SplitHeatEntry(HeatEntry):
    """Nodes at which copper loss and friction heat enter, each at its own.

    Attributes
    ----------
    copper_shares : mapping of str to float
        Share of the copper loss that enters at each node; :attr:`shares` are those of the friction
        heat. [-]
    """

    copper_shares: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedJoint:
    """True parameters of the simulated joint."""

    arm: Arm
    servo: Servo
    zones: tuple[Zone, ...]
    network: ThermalNetwork
    heat: HeatEntry

    def friction(
        self, *, load: ArrayLike, speed: ArrayLike, temperatures: Mapping[str, ArrayLike]
    ) -> Array:
        """Return the friction torque at node temperatures [N·m]."""
        return friction_torque(self.zones, load=load, speed=speed, temperatures=temperatures)

    def heat_shares(self) -> Array:
        """Return the share of the heat per node, in the network's order [-]."""
        return np.array([self.heat.shares.get(name, 0.0) for name in self.network.names])

    def copper_shares(self) -> Array | None:
        """Return the same of the copper loss, None where it enters with the friction heat [-]."""
        if not isinstance(self.heat, SplitHeatEntry):
            return None
        return np.array([self.heat.copper_shares.get(name, 0.0) for name in self.network.names])


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundTripMotion:
    """Continued moves there and back at one speed.

    Attributes
    ----------
    speed : float
        Speed of the constant-speed segment. [deg/s]
    angles : tuple of float
        Angles between which the joint turns. [deg]
    dwell : float
        Standing time after each move. [s]
    """

    speed: float
    angles: tuple[float, float]
    dwell: float


HEAT_INTERVAL = 0.005
"""Time step of a round trip for its mean power [s]."""


class MeanPower:
    """Power dissipated by continued round trips, averaged over one of them.

    Attributes
    ----------
    turning : float
        Mean absolute velocity, standing times included. [rad/s]
    """

    def __init__(self, joint: SimulatedJoint, trips: RoundTripMotion) -> None:
        distance = abs(trips.angles[1] - trips.angles[0])
        moving = move_duration(joint.servo, distance=distance, speed=trips.speed)
        motion, _, _ = round_trips(
            joint.servo,
            speeds=(trips.speed,),
            angles=trips.angles,
            lead=0.0,
            dwell=trips.dwell,
            interval=HEAT_INTERVAL,
        )
        inertial = joint.arm.inertia() * np.radians(motion.acceleration)
        frictionless = joint.arm.gravity_torque(motion.position) + inertial
        load = joint.arm.gravity_torque(np.linspace(*trips.angles, 181))
        self._zones = joint.zones
        self._speed = trips.speed
        self._load = float(np.sqrt(np.mean(np.square(load))))
        self._copper = joint.heat.copper_loss
        self._frictionless_square = float(np.mean(np.square(frictionless)))
        self._moving = moving / (moving + trips.dwell)
        self.turning = float(np.radians(distance)) / (moving + trips.dwell)

    def __call__(self, temperatures: Mapping[str, float]) -> float:
        """Return copper loss and friction heat together at node temperatures in °C [W]."""
        return float(self.at(temperatures))

    def at(self, temperatures: Mapping[str, ArrayLike]) -> Array:
        """Return the same at many temperatures per node [W]."""
        copper, friction = self.parts(temperatures)
        return copper + friction

    def parts(self, temperatures: Mapping[str, ArrayLike]) -> tuple[Array, Array]:
        """Return copper loss and friction heat at node temperatures in °C [W]."""
        friction = friction_torque(
            self._zones, load=self._load, speed=self._speed, temperatures=temperatures
        )
        # Friction changes sign on the way back, so it is uncorrelated with the other torques.
        square = self._frictionless_square + self._moving * friction**2
        return self._copper * square, friction * self.turning
