"""A joint that follows equation (16) exactly, but at the temperature of a gear without a sensor."""

from frictioncli.simulator.arm import Arm
from frictioncli.simulator.joint import SimulatedJoint, SplitHeatEntry
from frictioncli.simulator.motion_profile import Servo
from frictioncli.simulator.plain_joint import JointFriction
from frictioncli.simulator.thermal_history import HOUSING, MOTOR
from frictioncli.simulator.thermal_network import ThermalLink, ThermalNetwork, ThermalNode

NETWORK = ThermalNetwork(
    nodes=(
        ThermalNode(name=MOTOR, capacity=9500.0, to_ambient=1.3),
        ThermalNode(name="gear", capacity=5500.0, to_ambient=0.3),
        ThermalNode(name=HOUSING, capacity=4000.0, to_ambient=2.8),
    ),
    links=(
        ThermalLink(first=MOTOR, second="gear", conductance=1.2),
        ThermalLink(first="gear", second=HOUSING, conductance=0.3),
        ThermalLink(first=MOTOR, second=HOUSING, conductance=0.8),
    ),
)
"""Thermal network; sensors are at the motor and at the housing, none at the gear between them."""

COPPER_LOSS = 0.006
"""Copper loss per square of the control torque, all of which enters at the motor [W/(N·m)²]."""

HOUSING_HEAT_SHARE = 0.2
"""Share of the friction heat not entering at the motor that enters at the housing [-]."""


def network_joint(*, arm: Arm, servo: Servo, motor_heat_share: float) -> SimulatedJoint:
    """Return a joint whose friction depends on the temperature of its gear.

    The hidden gear is all that a model of the motor temperature lacks.

    Parameters
    ----------
    arm : Arm
        Arm that it moves.
    servo : Servo
        Servo of the joint.
    motor_heat_share : float
        Share of the friction heat that enters at the motor, from its bearings and seals. [-]
    """
    elsewhere = 1.0 - motor_heat_share
    return SimulatedJoint(
        arm=arm,
        servo=servo,
        zones=(JointFriction(node="gear"),),
        network=NETWORK,
        heat=SplitHeatEntry(
            copper_loss=COPPER_LOSS,
            copper_shares={MOTOR: 1.0},
            shares={
                MOTOR: motor_heat_share,
                "gear": elsewhere * (1.0 - HOUSING_HEAT_SHARE),
                HOUSING: elsewhere * HOUSING_HEAT_SHARE,
            },
        ),
    )
