"""A joint of which equation (16) is exactly true, so that a planted effect is all it lacks."""

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
"""Heat flow; the motor's node carries its sensor, which therefore has no lag."""

COPPER_LOSS = 0.0026
"""Copper loss per square of the control torque [W/(N·m)²]."""

HOUSING_HEAT_SHARE = 0.2
"""Share of the heat not entering at the motor that enters at the housing [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeFriction:
    r"""The whole friction of the joint by equation (16), at the motor's temperature.

    Attributes
    ----------
    tau_c : float
        Coulomb torque. [N·m]
    alpha : float
        Torque per square of the load. [1/(N·m)]
    beta : float
        Viscous coefficient that stays when hot. [N·m/(deg/s)^0.5]
    gamma : float
        Viscous coefficient that falls with temperature, at 0 °C. [N·m/(deg/s)^0.5]
    delta : float
        Rate of that fall. [1/K]
    name, node : str
        What the zone is, and the thermal node whose temperature acts here.

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
        """Return the friction torque from N·m, deg/s and °C [N·m]."""
        viscous = self.beta + self.gamma * np.exp(-self.delta * np.asarray(temperature))
        square = np.square(np.asarray(load, dtype=float))
        return np.asarray(self.tau_c + self.alpha * square + viscous * np.sqrt(speed))


def plain_joint(*, arm: Arm, servo: Servo, motor_heat_share: float) -> SimulatedJoint:
    """Return the plain joint.

    Parameters
    ----------
    arm : Arm
        What it carries.
    servo : Servo
        How it follows commands.
    motor_heat_share : float
        Share of the dissipated heat that enters at the motor. [-]
    """
    elsewhere = 1.0 - motor_heat_share
    return SimulatedJoint(
        arm=arm,
        servo=servo,
        zones=(WholeFriction(),),
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
