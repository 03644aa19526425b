"""The glossary: what each measured or computed quantity is called, and in which unit.

One unit system inside: deg, deg/s, s, N·m, °C. Only :mod:`frictioncli.logs` converts.

Sign of friction: with ``sign = +1`` the logged torque is ``load + friction`` while the joint moves
forward (position grows) and ``load - friction`` in reverse; with ``sign = -1`` (the source paper's
equation (7)) it is the other way round. Friction torque itself is positive where it opposes motion.
"""

from dataclasses import dataclass

TORQUE = "torque"
"""Stands for the unit of everything torque-like: N·m, or A where the log has motor current."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A named quantity with its symbol in formulas, its unit and what it means."""

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
LOAD = Quantity("load", "L", "N·m", "load torque from a channel of its own")
PAYLOAD = Quantity("payload", "m", "kg", "payload given by the manifest")
FRICTION_TORQUE = Quantity("friction_torque", "τ", TORQUE, "friction torque, opposes the motion")
LOAD_TORQUE = Quantity("load_torque", "L", TORQUE, "load torque: gravity and external load")
TEMPERATURE_PARAMETER = Quantity(
    "temperature_parameter", "T", "°C", "temperature that the friction function is given"
)
TEMPERATURE_CORRECTION = Quantity(
    "temperature_correction", "ΔT", "°C", "correction added to the motor temperature"
)
