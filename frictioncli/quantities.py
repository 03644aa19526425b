"""Glossary: name, symbol, unit and meaning of each measured or computed quantity.

The package uses deg, deg/s, s, N·m and °C throughout; only :mod:`frictioncli.logs` converts units.

Sign of friction: with ``sign = +1`` the logged torque is ``load + friction`` while the joint moves
forward (position increases) and ``load - friction`` in reverse; with ``sign = -1`` (equation (7) of
the source paper) it is the opposite. Friction torque itself is positive where it opposes motion.
"""

from dataclasses import dataclass

TORQUE = "torque"
"""Placeholder for the torque unit of a log: N·m, or A where it holds motor current."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity: name, symbol in formulas, unit and meaning."""

    name: str
    symbol: str
    unit: str
    description: str


TIME = Quantity("time", "t", "s", "time since the run's first sample")
POSITION = Quantity("position", "φ", "deg", "joint angle")
VELOCITY = Quantity("velocity", "φ'", "deg/s", "joint velocity")
SPEED = Quantity("speed", "|φ'|", "deg/s", "speed of a pair of counter-directed moves, > 0")
MOTOR_TORQUE = Quantity("torque", "u", TORQUE, "control torque as logged")
MOTOR_TEMPERATURE = Quantity(
    "motor_temperature", "Tm", "°C", "motor temperature, rebuilt between its steps where possible"
)
MOTOR_TEMPERATURE_READING = Quantity(
    "motor_temperature_reading", "Tm", "°C", "motor temperature as the controller registered it"
)
HOUSING_TEMPERATURE = Quantity("housing_temperature", "Tc", "°C", "temperature of the housing")
OTHER_SPEED = Quantity(
    "other_speed",
    "",
    "deg/s",
    "mean speed of the fastest other joint of the recording over half a second; 0 below 0.5 deg/s",
)
OTHER_JOINTS = Quantity(
    "other_joints",
    "",
    "",
    "other joints of the recording that move, as the sum of 2^(joint - 1)",
)
POSE = Quantity(
    "pose", "", "", "number of the pose of the other joints; none while one of them moves"
)
LOAD = Quantity("load", "L", "N·m", "load torque from a channel of its own")
PAYLOAD = Quantity("payload", "m", "kg", "payload given by manifest, log or the program that ran")
FRICTION_TORQUE = Quantity("friction_torque", "τ", TORQUE, "friction torque, opposes the motion")
LOAD_TORQUE = Quantity("load_torque", "L", TORQUE, "load torque: gravity and external load")
TEMPERATURE_PARAMETER = Quantity(
    "temperature_parameter", "T", "°C", "temperature that the friction function is given"
)
TEMPERATURE_CORRECTION = Quantity(
    "temperature_correction", "ΔT", "°C", "correction added to the motor temperature"
)
