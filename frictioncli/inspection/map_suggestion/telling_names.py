"""What the words of a column's name say where the name as a whole is not known."""

import re

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import split_unit

OTHER = "other"
"""A quantity that no mapping file names."""

MOTION = "motion"
"""Position or velocity."""

_WORD = re.compile(r"[A-Z]?[a-zäöü]+|[A-Z]+(?![a-z])")
_COUNT = re.compile(r"counts?|cnts?|ticks?|puls\w*|incr?|increments?", re.I)
_SAID = (
    (
        OTHER,
        r"volt\w*|spannung|pwm|duty|power|watts?|battery|fault|status|state|mode|index|idx|seq",
    ),
    (OTHER, r"imu|gyro|quat|acc|accel\w*|beschl\w*|ddq|qdd|kp|kd|kpp|kvp|bus"),
    (names.MOTOR_TEMPERATURE, r"temps?|temperatur\w*|thermistor|celsius|kelvin"),
    (names.TORQUE, r"torq\w*|tau|effort|moment|drehmoment|trq|curr|current\w*|strom|iq|amps?"),
    (names.VELOCITY, r"vel|velo|velocit\w*|speed|e?rpm|omega|geschwindigkeit|dq|qd|qdot"),
    (names.POSITION, r"pos|position\w*|angles?|winkel"),
    (MOTION, r"enc|encoder|tacho\w*"),
    (names.TIME, r"time|timestamp|zeit|millis|micros"),
)
_WORDS = tuple((quantity, re.compile(pattern, re.I)) for quantity, pattern in _SAID)


def said_quantity(name: str) -> str | None:
    """Return the quantity that words of a name tell; None where they tell none.

    Of several, the first one of a list counts: ``motor_torque_voltage`` is a voltage.

    Examples
    --------
    >>> said_quantity("temp_mos_1"), said_quantity("TorqueRef"), said_quantity("c2")
    ('motor_temperature', 'torque', None)
    """
    words = _WORD.findall(split_unit(name)[0])
    for quantity, pattern in _WORDS:
        if any(pattern.fullmatch(word) for word in words):
            return quantity
    return None


def may_mean(name: str, quantity: str) -> bool:
    """Return whether the words of a name allow it to be a quantity.

    Examples
    --------
    >>> may_mean("enc_b", "velocity"), may_mean("rpm", "torque"), may_mean("c2", "torque")
    (True, False, True)
    """
    said = said_quantity(name)
    if said == MOTION:
        return quantity in (names.POSITION, names.VELOCITY)
    return said in (None, quantity)


def is_counted(name: str) -> bool:
    """Return whether a column's unit or a word of its name says that it counts pulses.

    Examples
    --------
    >>> is_counted("enc_count"), is_counted("pos [inc]"), is_counted("position")
    (True, True, False)
    """
    bare, unit = split_unit(name)
    return units.is_count(unit) or any(_COUNT.fullmatch(word) for word in _WORD.findall(bare))
