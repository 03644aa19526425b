"""The plan of reading a joint: its columns, their unit conversions, and notes on both."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import position_units, units
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.motion_units import JointMotion, Remarks, joint_motion
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.state_channels import state_conversions
from frictioncli.logs.channels.survey import LARGEST, Survey
from frictioncli.logs.channels.torque_constant import TorqueConstant
from frictioncli.logs.channels.transmission import Transmission, find_transmission
from frictioncli.logs.channels.units import UnitConversion
from frictioncli.logs.log_source import Refusal

_MOST_AMPERES = 200.0
"""Currents of a robot's motors stay below. [A]"""
_LARGE_COUNT = 100
"""Torques in N·m that are larger are seldom logged as whole numbers. [raw]"""
_ALL_BUT_OUTLIERS = 0.99
_OF_RATED = ("%", "‰")
"""Units of torque relative to the rated torque."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPlan:
    """How one joint's samples are made from a log's columns.

    Attributes
    ----------
    channels : JointChannels
        The columns.
    conversions : mapping of str to UnitConversion
        Conversion by quantity; a quantity that is missing is not read.
    position_limit : float or None
        Largest absolute position that is plausible in radians; None where no limit applies. [rad]
    torque_unit : str
        ``N·m``, ``A`` or ``%``.
    torque_side : str
        Side of the gear, ``joint`` or ``motor``.
    constant : TorqueConstant or None
        By which a motor current was brought to N·m.
    shows_time : bool
        Whether the unit of time follows from the joint's motion and velocity.
    notes, warnings : tuple of str
        Where the reading departs from the header or adds to it.
    """

    channels: JointChannels
    conversions: Mapping[str, UnitConversion]
    position_limit: float | None
    torque_unit: str
    torque_side: str
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    constant: TorqueConstant | None = None
    shows_time: bool = False


def plan_joint(
    channels: JointChannels,
    survey: Survey,
    *,
    forced: Mapping[str, str],
    gear_ratio: float | None,
    rated_torque: float | None = None,
    constant: TorqueConstant | Refusal | None = None,
) -> JointPlan | Refusal:
    """Decide which channels of a joint are used, in which unit, and on which side of the gear.

    Parameters
    ----------
    channels : JointChannels
        The columns chosen.
    survey : Survey
        Raw samples of logs with this layout.
    forced : mapping of str to str
        Unit by quantity, given by the user.
    gear_ratio : float or None
        Motor turns per joint turn, given by the user. [-]
    rated_torque : float, optional
        Torque that 100 % stands for. [N·m]
    constant : TorqueConstant or Refusal, optional
        Torque per motor current, or why it is not known.

    Returns
    -------
    JointPlan or Refusal
        Refused as ``no_torque_channel`` (an empty or all-zero column),
        ``unclear_position_unit``, ``no_gear_ratio`` or as the torque constant was.
    """
    remarks = Remarks(list(channels.notes), list(channels.warnings))
    torque_values = survey.pooled(channels.torque)
    if survey.n_rows and not np.any(np.abs(torque_values) > 1 / LARGEST):
        state = "holds only zeros" if len(torque_values) else "holds no number"
        return Refusal(
            "no_torque_channel",
            f"torque of joint {channels.joint}: {channels.torque.name} {state}; name another"
            " column with --map",
        )
    torque_unit = _torque_unit(channels.torque, torque_values, forced, remarks)
    if channels.position.name == names.INTEGRATED:
        remarks.notes.append(
            "no position: it is the integral of velocity, from 0 in each log; moves are paired by"
            " speed alone, and terms of angle and gravity are off"
        )
        _warn_of_speed_without_unit(channels.velocity, forced, remarks)
    channels = _without_zero_velocity(channels, survey, remarks)
    motion = joint_motion(channels, survey, forced, remarks)
    if motion.doubt:
        return Refusal("unclear_position_unit", motion.doubt)
    gear = find_transmission(channels, survey, motion, gear_ratio, remarks)
    if gear is None:
        without_gear = _without_gear(channels, motion, remarks)
        if without_gear is None:
            return Refusal(
                "no_gear_ratio",
                f"{channels.position.name} is the motor's position and nothing determines the"
                " gear ratio; give it with --gear-ratio or [joint] gear_ratio in --map",
            )
        channels, motion = without_gear
    found = motion.units
    conversions = {
        names.TIME: units.conversion_from(found.time, names.TIME),
        names.POSITION: _joint_conversion(found.position, channels.position, gear),
    }
    if channels.velocity is not None and found.velocity is not None:
        velocity = _joint_conversion(found.velocity, channels.velocity, gear)
        conversions[names.VELOCITY] = _scaled(velocity, -1.0 if found.reversed_velocity else 1.0)
    if torque_unit in _OF_RATED and rated_torque is not None:
        rated = rated_torque / 100 * units.FACTORS[names.TORQUE][torque_unit]
        torque_unit = "N·m"
        remarks.notes[:] = [note for note in remarks.notes if "--rated-torque" not in note]
    else:
        rated = 1.0
    side, factor = _torque_side(channels, torque_unit, gear, remarks)
    factor *= rated
    torque = units.conversion_from(torque_unit, names.TORQUE)
    is_current = torque_unit in ("A", "mA")
    if is_current and isinstance(constant, Refusal):
        return constant
    if is_current and isinstance(constant, TorqueConstant):
        side, factor, torque_unit = names.JOINT_SIDE, constant.value, "N·m"
        remarks.notes.append(constant.text(channels.joint, channels.torque.name))
    elif is_current and (channels.load or channels.other_torques):
        remarks.notes.append(
            "results are in A; with --torque-constant auto they are in N·m, from the torque"
            " logged beside the current"
        )
    elif constant is not None:
        remarks.warnings.append(
            f"the torque constant of joint {channels.joint} is not used: {channels.torque.name} is"
            f" read in {torque_unit}"
        )
    conversions[names.TORQUE] = _scaled(torque, factor)
    conversions |= state_conversions(channels, survey, forced, remarks)
    at_joint = channels.position.meaning.side != names.MOTOR_SIDE
    limited = (
        found.position == "rad"
        and at_joint
        and motion.largest_position <= position_units.RADIAN_LIMIT
    )
    return JointPlan(
        channels=channels,
        conversions=conversions,
        position_limit=position_units.RADIAN_LIMIT if limited else None,
        torque_unit={"A": "A", "mA": "A", "%": "%", "‰": "%"}.get(torque_unit, "N·m"),
        torque_side=side,
        notes=tuple(remarks.notes),
        warnings=tuple(remarks.warnings),
        constant=constant if is_current and isinstance(constant, TorqueConstant) else None,
        shows_time=bool(found.evidence) and found.velocity is not None,
    )


def _warn_of_speed_without_unit(
    velocity: LogChannel | None, forced: Mapping[str, str], remarks: Remarks
) -> None:
    """Warn of a velocity whose unit nothing shows, as the position is made from it."""
    if velocity is None or names.VELOCITY in forced or velocity.unit or velocity.meaning.unit:
        return
    remarks.warnings.append(
        f"{velocity.name} has no unit and there is no position that shows it: taken as deg/s; if it"
        " is in rad/s or rpm, say so with --velocity-unit"
    )


def _without_zero_velocity(
    channels: JointChannels, survey: Survey, remarks: Remarks
) -> JointChannels:
    """Return the channels without a velocity that is empty or zero in the survey."""
    velocity = channels.velocity
    if velocity is None or not survey.n_rows or np.any(survey.pooled(velocity)):
        return channels
    remarks.notes.append(f"{velocity.name} is empty or zero in the rows looked at first: not used")
    return replace(channels, velocity=None)


def _scaled(conversion: UnitConversion, factor: float) -> UnitConversion:
    return UnitConversion(
        conversion.unit, conversion.factor * factor, conversion.offset, conversion.note
    )


def _torque_unit(
    channel: LogChannel, values: Array, forced: Mapping[str, str], remarks: Remarks
) -> str:
    if names.TORQUE in forced:
        return forced[names.TORQUE]
    written = channel.unit or channel.meaning.unit
    unit = units.canonical(written, names.TORQUE) if written else None
    if unit in _OF_RATED:
        remarks.notes.append(
            f"{channel.name} is in percent, and so is every torque-like result; with"
            " --rated-torque they are in N·m"
        )
    if unit == "A" and not channel.unit and len(values):
        largest = float(np.quantile(np.abs(values), _ALL_BUT_OUTLIERS))
        if largest > _MOST_AMPERES:
            remarks.warnings.append(
                f"{channel.name} has no unit and reaches {largest:.4g}, much for a motor's current"
                " in A: if it is in mA, say so with --torque-unit mA; if it counts, give the size"
                " of a count with [scale] torque in --map"
            )
    if unit is None:
        unit = "N·m"
        if written:
            remarks.warnings.append(
                f"{channel.name}: unit {written!r} is not known, taken as N·m; give another with"
                " --torque-unit, or its size with [scale] torque in --map"
            )
        elif _counts(values):
            remarks.warnings.append(
                f"{channel.name} has no unit and holds whole numbers up to"
                f" {float(np.max(np.abs(values))):g}: taken as N·m; if it is in mN·m or ‰, say so"
                " with --torque-unit; if it counts, give the size of a count with [scale] torque in"
                " --map"
            )
        else:
            remarks.notes.append(
                f"{channel.name}: no unit in the header, taken as N·m; force with --torque-unit"
            )
    return unit


def _counts(values: Array) -> bool:
    """Return whether torques are large whole numbers, as drives count them."""
    largest = float(np.max(np.abs(values), initial=0.0))
    return largest > _LARGE_COUNT and position_units.are_whole([values])


def _without_gear(
    channels: JointChannels, motion: JointMotion, remarks: Remarks
) -> tuple[JointChannels, JointMotion] | None:
    """Return the channels that need no gear ratio; None where the position needs it."""
    position, velocity, other_position = (
        channels.position,
        channels.velocity,
        channels.other_position,
    )
    if position.meaning.side == names.MOTOR_SIDE:
        if other_position is None or motion.other_position_unit is None:
            return None
        remarks.notes.append(
            f"joint {channels.joint} does not move, so the gear ratio cannot be found: its position"
            f" is {other_position.name}"
        )
        channels = replace(channels, position=other_position, other_position=position)
        swapped = replace(motion.units, position=motion.other_position_unit)
        motion = JointMotion(swapped, np.inf, motion.units.position)
    if velocity is not None and velocity.meaning.side == names.MOTOR_SIDE:
        remarks.notes.append(
            f"{velocity.name} is not used, as nothing determines the gear ratio: velocity is"
            " differentiated from position"
        )
        channels = replace(channels, velocity=None)
    return channels, motion


def _joint_conversion(unit: str, channel: LogChannel, gear: Transmission | None) -> UnitConversion:
    """Return the conversion of a position or velocity to the joint's side of the gear."""
    conversion = units.conversion_from(unit, channel.quantity)
    if gear is None or channel.meaning.side != names.MOTOR_SIDE:
        return conversion
    offset = gear.offset if channel.quantity == names.POSITION else 0.0
    return replace(_scaled(conversion, 1 / gear.ratio), offset=offset)


def _torque_side(
    channels: JointChannels, unit: str, gear: Transmission | None, remarks: Remarks
) -> tuple[str, float]:
    """Return the side of the gear on which the torque is used, and the factor to that side."""
    name, side = channels.torque.name, channels.torque.meaning.side
    if unit in ("A", "mA", "%"):
        return names.MOTOR_SIDE, 1.0
    if not side:
        of_drive = channels.other_position is not None
        at_motor = channels.position.meaning.side == names.MOTOR_SIDE or of_drive
        side = names.MOTOR_SIDE if at_motor else names.JOINT_SIDE
        remarks.notes.append(f"{name} does not say its side of the gear: taken as {side} side")
    if side == names.JOINT_SIDE:
        return names.JOINT_SIDE, 1.0
    if gear is None or not gear.converts_torque:
        remarks.notes.append(
            f"{name} is torque at the motor and stays so; with --gear-ratio it is converted to"
            " the joint side"
        )
        return names.MOTOR_SIDE, 1.0
    remarks.notes.append(
        f"{name} is converted to the joint side by the gear ratio {gear.ratio:.4g}"
    )
    return names.JOINT_SIDE, gear.ratio
