"""The gear between motor and joint: its ratio and offset, from the positions on both sides."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.motion_units import JointMotion, Remarks
from frictioncli.logs.channels.survey import Survey

_GEAR_RATIO_SPREAD = 0.02
"""Largest relative spread of the ratio between two positions that one gear connects."""


@dataclass(frozen=True, slots=True)
class Transmission:
    """Relation between the motor and the joint side of a gear.

    Attributes
    ----------
    ratio : float
        Motor turns per joint turn, negative where they turn in opposite directions. [-]
    offset : float
        Joint position where the motor's is 0; 0 where it is unknown. [deg]
    converts_torque : bool
        Whether motor torque is converted to the joint side too.
    """

    ratio: float
    offset: float
    converts_torque: bool


def find_transmission(
    channels: JointChannels,
    survey: Survey,
    motion: JointMotion,
    given_ratio: float | None,
    remarks: Remarks,
) -> Transmission | None:
    """Return the transmission by the ratio given, else by the positions on both sides.

    Parameters
    ----------
    channels : JointChannels
        The joint's columns.
    survey : Survey
        Raw samples of logs with this layout.
    motion : JointMotion
        Units of both positions.
    given_ratio : float or None
        Motor turns per joint turn, given by the user. [-]
    remarks : Remarks
        A note is added here where the ratio was found from the positions.

    Returns
    -------
    Transmission or None
        None where the ratio is neither given nor found.
    """
    position, other_position = channels.position, channels.other_position
    at_motor = [c.meaning.side for c in (position, channels.velocity, channels.torque) if c]
    if given_ratio is not None and other_position is None and names.MOTOR_SIDE not in at_motor:
        remarks.warnings.append(
            f"gear ratio {given_ratio:g} of joint {channels.joint} is not used: no channel is known"
            " to be at the motor; name those that are in --map, for example [side] position ="
            ' "motor"'
        )
    if other_position is None or motion.other_position_unit is None:
        return None if given_ratio is None else Transmission(given_ratio, 0.0, True)
    joint = (position, units.FACTORS[names.POSITION][motion.units.position])
    motor = (other_position, units.FACTORS[names.POSITION][motion.other_position_unit])
    if position.meaning.side == names.MOTOR_SIDE:
        joint, motor = motor, joint
    pairs = [
        (head[motor[0].column] * motor[1], head[joint[0].column] * joint[1])
        for head in survey.heads
    ]
    ratio = given_ratio
    if ratio is None:
        found = [r for pair in pairs if (r := gear_ratio(*pair)) is not None]
        if not found:
            return None
        ratio = float(np.median(found))
        remarks.notes.append(
            f"gear ratio of joint {channels.joint} found from {motor[0].name} and"
            f" {joint[0].name}: {ratio:.4g}"
        )
    offset = gear_offset(pairs, ratio)
    # a ratio from a merged file converts no torque: another trace may lack that file, and its
    # torque would stay on the motor side
    converts_torque = given_ratio is not None or not other_position.is_merged
    return Transmission(ratio, offset, converts_torque)


def gear_ratio(motor: Array, joint: Array) -> float | None:
    """Return the gear ratio from the positions on both sides of the gear.

    Parameters
    ----------
    motor, joint : ndarray, shape (n,)
        Positions; rows where one is NaN are left out. [deg]

    Returns
    -------
    float or None
        Motor turns per joint turn; None where the joint moves less than 1 deg, or where the two
        do not move together. [-]

    Examples
    --------
    >>> joint = np.linspace(-30, 30, 100)
    >>> round(gear_ratio(-120 * joint + 5, joint), 6)
    -120.0
    """
    good = np.isfinite(motor) & np.isfinite(joint)
    motor, joint = motor[good], joint[good]
    if len(joint) < 20 or np.ptp(joint) < 1.0:
        return None
    width = max(1, len(joint) // 200)
    by_motor, by_joint = motor[width:] - motor[:-width], joint[width:] - joint[:-width]
    moving = np.abs(by_joint) > 0.3 * np.max(np.abs(by_joint))
    ratios = by_motor[moving] / by_joint[moving]
    ratio = float(np.median(ratios))
    spread = float(np.median(np.abs(ratios - ratio)))
    return ratio if spread < _GEAR_RATIO_SPREAD * abs(ratio) else None


def gear_offset(pairs: Sequence[tuple[Array, Array]], ratio: float) -> float:
    """Return the joint's position where the motor's is 0, median over all samples [deg].

    Parameters
    ----------
    pairs : sequence of (ndarray, ndarray), shapes (n,)
        Positions of the motor and of the joint, one pair per log. [deg]
    ratio : float
        Motor turns per joint turn. [-]

    Examples
    --------
    >>> joint = np.linspace(-30, 30, 5)
    >>> gear_offset([(100 * (joint - 2), joint)], 100)
    2.0
    """
    offsets = np.concatenate([joint - motor / ratio for motor, joint in pairs])
    offsets = offsets[np.isfinite(offsets)]
    return float(np.median(offsets)) if len(offsets) else 0.0
