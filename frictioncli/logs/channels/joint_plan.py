"""From a survey to a plan per joint: which columns, times which factor, and what must be said."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import unit_evidence, units
from frictioncli.logs.channels.motion_units import JointMotion, Remarks, joint_motion
from frictioncli.logs.channels.recognition import JointChannels, LogChannel
from frictioncli.logs.channels.survey import Survey
from frictioncli.logs.channels.units import UnitConversion
from frictioncli.logs.log_source import Refusal


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPlan:
    """How one joint's samples are made from a log's columns.

    Attributes
    ----------
    channels : JointChannels
        The columns.
    conversions : dict of str to UnitConversion
        Canonical name to factor and offset; a name that is missing is not read.
    position_limit : float or None
        Raw positions beyond this contradict radians as the unit. [rad]
    torque_unit : str
        ``N·m`` or ``A``.
    torque_side : str
        ``joint`` or ``motor``.
    notes, warnings : tuple of str
        What was believed against or beyond the header.
    """

    channels: JointChannels
    conversions: Mapping[str, UnitConversion]
    position_limit: float | None
    torque_unit: str
    torque_side: str
    notes: tuple[str, ...]
    warnings: tuple[str, ...]


def plan_joint(
    channels: JointChannels,
    survey: Survey,
    *,
    forced: Mapping[str, str],
    gear_ratio: float | None,
) -> JointPlan | Refusal:
    """Decide units, side and use of each channel of a joint.

    Parameters
    ----------
    channels : JointChannels
        The columns chosen.
    survey : Survey
        Raw samples of logs of this layout.
    forced : mapping of str to str
        Canonical name to unit, given by the user.
    gear_ratio : float or None
        Motor turns per joint turn.

    Returns
    -------
    JointPlan or Refusal
        ``no_torque_channel`` (an empty or all-zero column), ``torque_in_percent`` or
        ``no_gear_ratio``.
    """
    remarks = Remarks(notes=list(channels.notes))
    torque_values = survey.pooled(channels.torque)
    if survey.n_rows and not np.any(torque_values):
        state = "holds only zeros" if len(torque_values) else "is empty"
        return Refusal(
            "no_torque_channel",
            f"torque of joint {channels.joint}: {channels.torque.name} {state}; name another"
            " column with --map",
        )
    torque_unit = _torque_unit(channels.torque, forced, remarks)
    if isinstance(torque_unit, Refusal):
        return torque_unit
    channels = _with_moving_velocity(channels, survey, remarks)
    motion = joint_motion(channels, survey, forced, remarks)
    gear = _gear(channels, survey, motion, gear_ratio, remarks)
    if gear is None:
        seen = _without_gear(channels, motion, remarks)
        if seen is None:
            return Refusal(
                "no_gear_ratio",
                f"{channels.position.name} is the motor's position and nothing tells the gear"
                " ratio; give it with --gear-ratio or [joint] gear_ratio in --map",
            )
        channels, motion = seen
    found = motion.units
    conversions = {
        names.TIME: units.conversion_from(found.time, names.TIME),
        names.POSITION: _at_joint(found.position, channels.position, gear),
    }
    if channels.velocity is not None and found.velocity is not None:
        velocity = _at_joint(found.velocity, channels.velocity, gear)
        conversions[names.VELOCITY] = _scaled(velocity, -1.0 if found.reversed_velocity else 1.0)
    side, factor = _torque_side(channels, torque_unit, gear, remarks)
    conversions[names.TORQUE] = _scaled(units.conversion_from(torque_unit, names.TORQUE), factor)
    _add_temperatures(channels, survey, forced, conversions, remarks)
    if channels.load is not None:
        written = units.canonical(channels.load.unit, names.LOAD)
        conversions[names.LOAD] = units.conversion_from(
            forced.get(names.LOAD) or written or "N·m", names.LOAD
        )
    at_joint = channels.position.meaning.side != names.MOTOR_SIDE
    limited = found.position == "rad" and at_joint and motion.furthest <= unit_evidence.RADIAN_LIMIT
    return JointPlan(
        channels=channels,
        conversions=conversions,
        position_limit=unit_evidence.RADIAN_LIMIT if limited else None,
        torque_unit="A" if torque_unit in ("A", "mA") else "N·m",
        torque_side=side,
        notes=tuple(remarks.notes),
        warnings=tuple(remarks.warnings),
    )


def _with_moving_velocity(
    channels: JointChannels, survey: Survey, remarks: Remarks
) -> JointChannels:
    """Return the channels without a velocity that is empty or zero throughout."""
    velocity = channels.velocity
    if velocity is None or not survey.n_rows or np.any(survey.pooled(velocity)):
        return channels
    remarks.notes.append(f"{velocity.name} is empty or zero throughout: not used")
    return replace(channels, velocity=None)


def _scaled(conversion: UnitConversion, factor: float) -> UnitConversion:
    return UnitConversion(
        conversion.unit, conversion.factor * factor, conversion.offset, conversion.note
    )


def _torque_unit(channel: LogChannel, forced: Mapping[str, str], remarks: Remarks) -> str | Refusal:
    if names.TORQUE in forced:
        return forced[names.TORQUE]
    written = channel.unit or channel.meaning.unit
    unit = units.canonical(written, names.TORQUE) if written else None
    if unit == "%":
        return Refusal(
            "torque_in_percent",
            f"{channel.name} is in percent of something; expected N·m or A: give the unit it"
            " holds with [units] torque in --map or --torque-unit",
        )
    if unit is None:
        unit = "N·m"
        why = f"unit {written!r} is not known" if written else "no unit in the header"
        remarks.notes.append(f"{channel.name}: {why}, taken as N·m; force with --torque-unit")
    return unit


@dataclass(frozen=True, slots=True)
class _Gear:
    """What is known of a joint's gear.

    Attributes
    ----------
    ratio : float
        Motor turn per joint turn, negative where they turn against each other. [-]
    offset : float
        The joint's position where the motor's is 0; 0 where nothing tells it. [deg]
    of_torque : bool
        Whether torque at the motor is brought to the joint too.
    """

    ratio: float
    offset: float
    of_torque: bool


def _gear(
    channels: JointChannels,
    survey: Survey,
    motion: JointMotion,
    told: float | None,
    remarks: Remarks,
) -> _Gear | None:
    """Return the gear by what the user says, else by the positions on both sides."""
    position, other_position = channels.position, channels.other_position
    if other_position is None or motion.other_position is None:
        return None if told is None else _Gear(told, 0.0, True)
    joint = (position, units.FACTORS[names.POSITION][motion.units.position])
    motor = (other_position, units.FACTORS[names.POSITION][motion.other_position])
    if position.meaning.side == names.MOTOR_SIDE:
        joint, motor = motor, joint
    pairs = [
        (head[motor[0].column] * motor[1], head[joint[0].column] * joint[1])
        for head in survey.heads
    ]
    ratio = told
    if ratio is None:
        found = [r for one in pairs if (r := unit_evidence.gear_ratio(*one)) is not None]
        if not found:
            return None
        ratio = float(np.median(found))
        remarks.notes.append(
            f"gear ratio of joint {channels.joint} found from {motor[0].name} and"
            f" {joint[0].name}: {ratio:.4g}"
        )
    offset = unit_evidence.gear_offset(pairs, ratio)
    # another trace may lack the drive's file, and its torque would stay at the motor
    return _Gear(ratio, offset, told is not None or not other_position.is_merged)


def _without_gear(
    channels: JointChannels, motion: JointMotion, remarks: Remarks
) -> tuple[JointChannels, JointMotion] | None:
    """Return the channels that do without a gear ratio; None where the position needs it."""
    position, velocity, other_position = (
        channels.position,
        channels.velocity,
        channels.other_position,
    )
    if position.meaning.side == names.MOTOR_SIDE:
        if other_position is None or motion.other_position is None:
            return None
        remarks.notes.append(
            f"joint {channels.joint} does not move, which would tell the gear ratio: its position"
            f" is {other_position.name}"
        )
        channels = replace(channels, position=other_position, other_position=position)
        own = replace(motion.units, position=motion.other_position)
        motion = JointMotion(own, np.inf, motion.units.position)
    if velocity is not None and velocity.meaning.side == names.MOTOR_SIDE:
        remarks.notes.append(
            f"{velocity.name} is not used, as nothing tells the gear ratio: velocity is"
            " differentiated from position"
        )
        channels = replace(channels, velocity=None)
    return channels, motion


def _at_joint(unit: str, channel: LogChannel, gear: _Gear | None) -> UnitConversion:
    """Return the conversion of a position or velocity, through the gear if it is the motor's."""
    conversion = units.conversion_from(unit, channel.quantity)
    if gear is None or channel.meaning.side != names.MOTOR_SIDE:
        return conversion
    offset = gear.offset if channel.quantity == names.POSITION else 0.0
    return replace(_scaled(conversion, 1 / gear.ratio), offset=offset)


def _torque_side(
    channels: JointChannels, unit: str, gear: _Gear | None, remarks: Remarks
) -> tuple[str, float]:
    """Return the side on which the torque then is, and the factor that brings it there."""
    name, side = channels.torque.name, channels.torque.meaning.side
    if unit in ("A", "mA"):
        return names.MOTOR_SIDE, 1.0
    if not side:
        of_drive = channels.other_position is not None
        at_motor = channels.position.meaning.side == names.MOTOR_SIDE or of_drive
        side = names.MOTOR_SIDE if at_motor else names.JOINT_SIDE
        remarks.notes.append(f"{name} does not say its side of the gear: taken as {side} side")
    if side == names.JOINT_SIDE:
        return names.JOINT_SIDE, 1.0
    if gear is None or not gear.of_torque:
        remarks.notes.append(
            f"{name} is torque at the motor and stays so; with --gear-ratio it is brought to the"
            " joint"
        )
        return names.MOTOR_SIDE, 1.0
    remarks.notes.append(f"{name} is brought to the joint by the gear ratio {gear.ratio:.4g}")
    return names.JOINT_SIDE, gear.ratio


def _add_temperatures(
    channels: JointChannels,
    survey: Survey,
    forced: Mapping[str, str],
    conversions: dict[str, UnitConversion],
    remarks: Remarks,
) -> None:
    for quantity, channel in (
        (names.MOTOR_TEMPERATURE, channels.motor_temperature),
        (names.HOUSING_TEMPERATURE, channels.housing_temperature),
    ):
        if channel is None:
            continue
        conversion = units.infer_temperature_unit(
            survey.pooled(channel),
            units.canonical(channel.unit, quantity),
            forced.get(quantity),
            quantity,
        )
        if conversion is None:
            remarks.notes.append(
                f"{channel.name} holds no temperature (empty, zero, or outside -30..150 °C):"
                " left out"
            )
            continue
        conversions[quantity] = conversion
        if conversion.note:
            remarks.notes.append(f"{channel.name}: {conversion.note}")
