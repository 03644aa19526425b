"""A joint that follows equation (16) exactly, so that planted effects are its only deviation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.arm import Arm
from frictioncli.simulator.joint import HeatEntry, SimulatedJoint
from frictioncli.simulator.motion_profile import Servo
from frictioncli.simulator.thermal_history import HOUSING, MOTOR
from frictioncli.simulator.thermal_network import ThermalLink, ThermalNetwork, ThermalNode

NETWORK = ThermalNetwork(
    nodes=(
        ThermalNode(name=MOTOR, capacity=10500.0, to_ambient=0.4),
        ThermalNode(name="gear", capacity=3500.0, to_ambient=0.0),
        ThermalNode(name=HOUSING, capacity=2900.0, to_ambient=1.6),
    ),
    links=(
        ThermalLink(first=MOTOR, second="gear", conductance=3.3),
        ThermalLink(first="gear", second=HOUSING, conductance=2.8),
        ThermalLink(first=MOTOR, second=HOUSING, conductance=0.4),
    ),
)
"""Thermal network; the motor's node has the sensor, which therefore has no lag."""

COPPER_LOSS = 0.0026
"""Copper loss per square of the control torque [W/(N·m)²]."""

HOUSING_HEAT_SHARE = 0.2
"""Share of the heat not entering at the motor that enters at the housing [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFriction:
    r"""Friction of the joint by equation (16), at the motor temperature.

    Attributes
    ----------
    tau_c : float
        Coulomb torque. [N·m]
    alpha : float
        Torque per square of the load. [1/(N·m)]
    beta : float
        Viscous coefficient at high temperature. [N·m/(deg/s)^0.5]
    gamma : float
        Viscous coefficient that decreases with temperature, at 0 °C. [N·m/(deg/s)^0.5]
    delta : float
        Rate of this decrease. [1/K]
    name : str
        Name of the zone.
    node : str
        Thermal node that has its temperature.

    Notes
    -----
    .. math:: \tau = \tau_c + \alpha L^2 + (\beta + \gamma e^{-\delta T}) \sqrt{|\dot\varphi|}
    """

    tau_c: float = 10.57
    alpha: float = 0.0014
    beta: float = 3.48
    gamma: float = 15.66
    delta: float = 0.056
    name: str = "whole joint"
    node: str = MOTOR

    def torque(self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike) -> Array:
        """Return the friction torque.

        Parameters
        ----------
        load : array_like
            Load torque. [N·m]
        speed : array_like
            Absolute joint velocity. [deg/s]
        temperature : array_like
            Motor temperature. [°C]

        Returns
        -------
        ndarray
            Friction torque. [N·m]

        Examples
        --------
        >>> JointFriction().torque(load=[0.0], speed=25.0, temperature=40.0).round(2)
        array([36.31])
        """
        viscous = self.beta + self.gamma * np.exp(-self.delta * np.asarray(temperature))
        square = np.square(np.asarray(load, dtype=float))
        return np.asarray(self.tau_c + self.alpha * square + viscous * np.sqrt(speed))


def plain_joint(*, arm: Arm, servo: Servo, motor_heat_share: float) -> SimulatedJoint:
    """Return the plain joint.

    Parameters
    ----------
    arm : Arm
        Arm that it moves.
    servo : Servo
        Servo of the joint.
    motor_heat_share : float
        Share of the dissipated heat that enters at the motor. [-]
    """
    elsewhere = 1.0 - motor_heat_share
    return SimulatedJoint(
        arm=arm,
        servo=servo,
        zones=(JointFriction(),),
        network=NETWORK,
        heat=HeatEntry(
            copper_loss=COPPER_LOSS,
            shares={
                MOTOR: motor_heat_share,
                "gear": elsewhere * (1.0 - HOUSING_HEAT_SHARE),
                HOUSING: elsewhere * HOUSING_HEAT_SHARE,
            },
        ),
    )
