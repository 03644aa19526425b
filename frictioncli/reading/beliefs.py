"""From a survey to a plan per joint: which columns, times which factor, and what must be said."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.reading import aliases as names
from frictioncli.reading import evidence, units
from frictioncli.reading.channels import Channel, JointChannels
from frictioncli.reading.evidence import MotionUnits
from frictioncli.reading.formats.base import Refusal
from frictioncli.reading.motion import Remarks, motion_units, motions_of
from frictioncli.reading.survey import Survey
from frictioncli.reading.units import Belief


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPlan:
    """How one joint's samples are made from a log's columns.

    Attributes
    ----------
    channels : JointChannels
        The columns.
    beliefs : dict of str to Belief
        Canonical name to factor and offset; a name that is missing is not read.
    position_limit : float or None
        Raw positions beyond this contradict the belief in radians. [rad]
    torque_unit : str
        ``N·m`` or ``A``.
    torque_side : str
        ``joint`` or ``motor``.
    notes, warnings : tuple of str
        What was believed against or beyond the header.
    """

    channels: JointChannels
    beliefs: Mapping[str, Belief]
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
    found, furthest = motion_units(channels, survey, forced, remarks)
    on_motor = channels.position.meaning.side == names.MOTOR_SIDE
    ratio = gear_ratio
    if ratio is None and channels.motor_position is not None:
        ratio = _ratio_from_positions(channels, survey, found, remarks)
    if on_motor and ratio is None:
        return Refusal(
            "no_gear_ratio",
            f"{channels.position.name} is the motor's position and nothing tells the gear ratio;"
            " give it with --gear-ratio or [joint] gear_ratio in --map",
        )
    through_gear = ratio if on_motor and ratio is not None else 1.0
    beliefs = {
        names.TIME: units.plain(found.time, names.TIME),
        names.POSITION: _scaled(units.plain(found.position, names.POSITION), 1 / through_gear),
    }
    if channels.velocity is not None and found.velocity is not None:
        sign = -1.0 if found.reversed_velocity else 1.0
        velocity = units.plain(found.velocity, names.VELOCITY)
        beliefs[names.VELOCITY] = _scaled(velocity, sign / through_gear)
    side, factor = _torque_side(channels, torque_unit, on_motor, ratio, remarks)
    beliefs[names.TORQUE] = _scaled(units.plain(torque_unit, names.TORQUE), factor)
    _add_temperatures(channels, survey, forced, beliefs, remarks)
    if channels.load is not None:
        written = units.canonical(channels.load.unit, names.LOAD)
        beliefs[names.LOAD] = units.plain(forced.get(names.LOAD) or written or "N·m", names.LOAD)
    limited = found.position == "rad" and not on_motor and furthest <= evidence.RADIAN_LIMIT
    return JointPlan(
        channels=channels,
        beliefs=beliefs,
        position_limit=evidence.RADIAN_LIMIT if limited else None,
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


def _scaled(belief: Belief, factor: float) -> Belief:
    return Belief(belief.unit, belief.factor * factor, belief.offset, belief.note)


def _torque_unit(channel: Channel, forced: Mapping[str, str], remarks: Remarks) -> str | Refusal:
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


def _ratio_from_positions(
    channels: JointChannels, survey: Survey, found: MotionUnits, remarks: Remarks
) -> float | None:
    motor = channels.motor_position
    if motor is None:
        return None
    motions = motions_of(survey, channels.time, motor, None)
    furthest, span = evidence.position_range(motions)
    possible, _ = evidence.possible_position_units(
        furthest=furthest, span=span, on_motor=True, way_per_turn=None
    )
    unit = units.canonical(motor.unit, names.POSITION)
    unit = unit if unit in possible else sorted(possible)[0]
    factor = units.FACTORS[names.POSITION]
    ratios = []
    for head in survey.heads:
        at_motor, at_joint = head[motor.column], head[channels.position.column]
        good = np.isfinite(at_motor) & np.isfinite(at_joint)
        ratio = evidence.gear_ratio(
            at_motor[good] * factor[unit], at_joint[good] * factor[found.position]
        )
        if ratio is not None:
            ratios.append(ratio)
    if not ratios:
        return None
    ratio = float(np.median(ratios))
    remarks.notes.append(
        f"gear ratio of joint {channels.joint} found from {motor.name} and"
        f" {channels.position.name}: {ratio:.4g}"
    )
    return ratio


def _torque_side(
    channels: JointChannels,
    unit: str,
    on_motor: bool,
    ratio: float | None,
    remarks: Remarks,
) -> tuple[str, float]:
    """Return the side on which the torque then is, and the factor that brings it there."""
    name, side = channels.torque.name, channels.torque.meaning.side
    if unit in ("A", "mA"):
        return names.MOTOR_SIDE, 1.0
    if not side:
        side = names.MOTOR_SIDE if on_motor else names.JOINT_SIDE
        remarks.notes.append(f"{name} does not say its side of the gear: taken as {side} side")
    if side == names.JOINT_SIDE:
        return names.JOINT_SIDE, 1.0
    if ratio is None:
        remarks.notes.append(
            f"{name} is torque at the motor and stays so; with --gear-ratio it is brought to the"
            " joint"
        )
        return names.MOTOR_SIDE, 1.0
    remarks.notes.append(f"{name} is brought to the joint by the gear ratio {ratio:.4g}")
    return names.JOINT_SIDE, ratio


def _add_temperatures(
    channels: JointChannels,
    survey: Survey,
    forced: Mapping[str, str],
    beliefs: dict[str, Belief],
    remarks: Remarks,
) -> None:
    for quantity, channel in (
        (names.MOTOR_TEMPERATURE, channels.motor_temperature),
        (names.HOUSING_TEMPERATURE, channels.housing_temperature),
    ):
        if channel is None:
            continue
        belief = units.temperature(
            survey.pooled(channel),
            units.canonical(channel.unit, quantity),
            forced.get(quantity),
            quantity,
        )
        if belief is None:
            remarks.notes.append(
                f"{channel.name} holds no temperature (empty, zero, or outside -30..150 °C):"
                " left out"
            )
            continue
        beliefs[quantity] = belief
        if belief.note:
            remarks.notes.append(f"{channel.name}: {belief.note}")
