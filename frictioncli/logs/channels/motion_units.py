"""Units of time, position and velocity: the header's, checked against the surveyed values."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import position_units, surveyed_motion, unit_evidence, units
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.position_scale import warnings_of_scale
from frictioncli.logs.channels.position_units import wraps_as_of_mit_protocol
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.survey import Survey
from frictioncli.logs.channels.unit_evidence import MotionUnits

_TWO_TURNS = 720.0  # [deg]


@dataclass(slots=True)
class Remarks:
    """Notes on a joint's channels, and warnings of what may be wrong."""

    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Units of a joint's motion channels.

    Attributes
    ----------
    units : MotionUnits
        Of time, position and velocity.
    largest_position : float
        Largest absolute position. [raw]
    other_position_unit : str or None
        Unit of the position on the other side of the gear; None where there is none.
    doubt : str
        Why the unit of the position has to be asked for; "" where it is known.
    """

    units: MotionUnits
    largest_position: float
    other_position_unit: str | None
    doubt: str = ""


@dataclass(frozen=True, slots=True)
class _Axis:
    """A joint's channels with position and velocity on one side of the gear.

    ``hint`` is the end of a note that tells the user how to force the position's unit.
    """

    channels: JointChannels
    hint: str

    @property
    def time(self) -> LogChannel:
        return self.channels.time

    @property
    def position(self) -> LogChannel:
        return self.channels.position

    @property
    def velocity(self) -> LogChannel | None:
        return self.channels.velocity


def joint_motion(
    channels: JointChannels, survey: Survey, forced: Mapping[str, str], remarks: Remarks
) -> JointMotion:
    """Find the units of time, of the positions on both sides of the gear, and of the velocity.

    Parameters
    ----------
    channels : JointChannels
        The joint's columns.
    survey : Survey
        Raw samples of logs with this layout.
    forced : mapping of str to str
        Unit by quantity, given by the user.
    remarks : Remarks
        Notes and warnings are added here.
    """
    time, velocity, other_position = channels.time, channels.velocity, channels.other_position
    same_side = velocity is None or velocity.meaning.side == channels.position.meaning.side
    own = replace(channels, velocity=velocity if same_side else None)
    axis = _Axis(own, "; force with --position-unit {}")
    found, largest_position, doubt = _axis_units(axis, survey, forced, remarks)
    other_unit = None
    if other_position is not None:
        # a forced position unit applies to the other channel
        other_forced = {name: unit for name, unit in forced.items() if name != names.POSITION}
        other = replace(channels, position=other_position, velocity=None if same_side else velocity)
        axis = _Axis(other, "")
        of_motor = other_position.meaning.side == names.MOTOR_SIDE and not other_position.unit
        like = found.position if of_motor else None
        other_units, _, _ = _axis_units(axis, survey, other_forced, remarks, like)
        other_unit = other_units.position
        if not same_side:
            found = replace(other_units, position=found.position)
    if velocity is None:
        remarks.notes.append("no velocity channel: differentiated from position")
    if found.time != (units.canonical(time.unit, names.TIME) or "s") and names.TIME not in forced:
        remarks.notes.append(f"{time.name} is read as {found.time}")
    return JointMotion(found, largest_position, other_unit, doubt)


def _axis_units(
    axis: _Axis,
    survey: Survey,
    forced: Mapping[str, str],
    remarks: Remarks,
    like: str | None = None,
) -> tuple[MotionUnits, float, str]:
    """Return units, the largest absolute raw position, and why the position's unit is open.

    The reason is "" where the unit is known. ``like`` is the position's unit where nothing tells.
    """
    position = axis.position
    family = survey.family(position)
    largest, span = surveyed_motion.position_range(survey, axis.time, family)
    on_motor = position.meaning.side == names.MOTOR_SIDE
    usual = like or position_units.usual_position_unit(
        largest=largest, span=span, on_motor=on_motor
    )
    possible, why = position_units.possible_position_units(
        largest=largest,
        span=span,
        on_motor=on_motor,
        paths_per_angle=surveyed_motion.tool_paths_per_angle(survey, family),
    )
    if like is not None:
        why = why or "taken like the joint's position"
    if position.name == names.INTEGRATED:  # in deg by construction, however far it goes
        possible, why = frozenset({"deg"}), ""
    allowed = possible
    declared_position = forced.get(names.POSITION) or _written_unit(position, names.POSITION)
    if declared_position in units.ONLY_WRITTEN:
        allowed, why = frozenset({declared_position}), ""
    elif names.POSITION in forced:
        allowed = frozenset({forced[names.POSITION]})
        if not allowed <= possible:
            remarks.warnings.append(
                f"{position.name} is read as {forced[names.POSITION]} as specified, but {why}"
            )
    times = [head[axis.time.column] for head in survey.heads]
    written_time = units.canonical(axis.time.unit or axis.time.meaning.unit, names.TIME)
    declared_time = forced.get(names.TIME) or units.infer_time_unit(times, written_time)
    declared_velocity = forced.get(names.VELOCITY)
    ratio = None
    if axis.velocity is not None:
        written = _written_unit(axis.velocity, names.VELOCITY)
        declared_velocity = declared_velocity or written
        ratio = unit_evidence.motion_ratio(
            surveyed_motion.motions(survey, axis.time, position, axis.velocity)
        )
    headers = {declared_position, declared_velocity}
    says_radians = headers != {None} and headers <= {None, "rad", "rad/s"}
    if says_radians and ratio is not None and possible == {"deg"} and names.POSITION not in forced:
        # a motor or an endless axis may turn further than a joint: velocity decides
        allowed = frozenset({"deg", "rad"})
    time_is_known = written_time is not None or names.TIME in forced or declared_time != "s"
    found = unit_evidence.motion_units(
        declared=(
            declared_time if time_is_known else None,
            declared_position,
            declared_velocity,
        ),
        possible=allowed,
        ratio=ratio,
        usual=usual,
        period=surveyed_motion.period(survey, axis.time),
    )
    if (declared_position, declared_velocity) == (None, None) and wraps_as_of_mit_protocol(
        [motion.position for motion in surveyed_motion.motions_of(survey, axis.time, family)]
    ):
        found = _mit_units(axis, found, remarks)
        why = "it wraps at ±12.5, as positions of the MIT motor protocol do"
    velocity_tells = bool(found.evidence) and found.velocity is not None
    is_open = len(allowed) > 1 and usual == "rad" and not velocity_tells
    doubt = _doubt(axis.position, why) if is_open and declared_position == "deg" else ""
    if names.POSITION not in forced:
        motions = surveyed_motion.motions_of(survey, axis.time, [position])
        if units.is_count(position.unit):
            doubt = _COUNTED.format(name=f"{position.name} counts pulses")
        elif _may_count(position, [motion.position for motion in motions], largest):
            text = f"{position.name} has no unit and holds whole numbers up to {largest:.4g}"
            if axis.velocity is not None and found.velocity is None:
                text += f", and {found.evidence}"
                doubt = _COUNTED.format(name=f"{text}: counts?") + "; or --position-unit deg"
            elif found.position == "deg":
                remarks.warnings.append(
                    f"{text}: read as deg; if it counts, give the size of a count with [scale]"
                    " position in --map"
                )
    found = _with_forced_units(found, forced, remarks)
    _remark_position(axis, found, why, survey, forced, remarks)
    if axis.velocity is not None:
        _remark_velocity(axis.velocity, found, forced, remarks)
    return found, largest, doubt


def _mit_units(axis: _Axis, found: MotionUnits, remarks: Remarks) -> MotionUnits:
    """Return the units of the MIT motor protocol, with a warning where they do not agree."""
    if axis.velocity is not None and found.velocity is None:
        remarks.warnings.append(
            f"{axis.velocity.name} is read as rad/s, although {found.evidence}:"
            f" compare {axis.position.name} with a known angle"
        )
    return replace(found, position="rad", velocity="rad/s", evidence="")


_COUNTED = "{name}; give the angle of one pulse in deg with --map, as [scale] position = 0.0879"


def _may_count(position: LogChannel, values: list[Array], largest: float) -> bool:
    """Return whether a position without unit may be counts: whole numbers beyond two turns."""
    return not position.unit and largest > _TWO_TURNS and position_units.are_whole(values)


def _doubt(position: LogChannel, why: str) -> str:
    """Return why the user has to be asked for the unit of a position."""
    return (
        f"{position.name} says {position.unit}, but {why}, as angles in rad do, and neither a"
        " velocity nor the tool's path shows which it is; give it with --position-unit deg or rad,"
        " or with [units] position in --map"
    )


def _with_forced_units(
    found: MotionUnits, forced: Mapping[str, str], remarks: Remarks
) -> MotionUnits:
    """Return the units with the forced ones in place; warn where the values contradict them."""
    time = forced.get(names.TIME, found.time)
    velocity = forced.get(names.VELOCITY, found.velocity)
    if time != found.time or (velocity != found.velocity and found.evidence):
        would_fit = (
            "" if found.velocity is None else f": {found.time} and {found.velocity} would fit"
        )
        remarks.warnings.append(
            f"time and velocity are read as {time} and {velocity} as specified, but"
            f" {found.evidence}{would_fit}"
        )
    return MotionUnits(time, found.position, velocity, found.reversed_velocity, found.evidence)


def _remark_position(
    axis: _Axis,
    found: MotionUnits,
    why: str,
    survey: Survey,
    forced: Mapping[str, str],
    remarks: Remarks,
) -> None:
    position = axis.position
    written = _written_unit(position, names.POSITION)
    if written and not position.unit and names.POSITION not in forced:
        remarks.notes.append(
            f"{position.name} has no unit: read as {found.position}, as usual with this name"
            f"{axis.hint.format('deg')}"
        )
    if names.POSITION in forced or written == found.position:
        return
    if position.unit and written is None and (found.position == "deg" or not found.evidence):
        remarks.warnings.append(
            f"{position.name}: unit {position.unit!r} is not known, taken as {found.position};"
            " give another with --position-unit, or its size with [scale] position in --map"
        )
        return
    tells = axis.velocity is not None and (
        _written_unit(axis.velocity, names.VELOCITY) or found.velocity not in (None, "deg/s")
    )
    if written is None and not tells and position.name != names.INTEGRATED:
        remarks.warnings += warnings_of_scale(axis.channels, survey, found.position)
    if written is None and found.position == "deg":
        return
    says = f"says {position.unit}" if position.unit else "has no unit"
    other = "rad" if found.position == "deg" else "deg"
    reason = "; ".join(text for text in (why, found.evidence) if text)
    remarks.notes.append(
        f"{position.name} {says}, {reason}: read as {found.position}{axis.hint.format(other)}"
    )


def _written_unit(channel: LogChannel, quantity: str) -> str | None:
    """Return the unit of the header, or the one that always goes with the name."""
    return units.canonical(channel.unit or channel.meaning.unit, quantity)


def _remark_velocity(
    velocity: LogChannel, found: MotionUnits, forced: Mapping[str, str], remarks: Remarks
) -> None:
    written = _written_unit(velocity, names.VELOCITY)
    if velocity.unit and written is None and names.VELOCITY not in forced and not found.evidence:
        remarks.warnings.append(
            f"{velocity.name}: unit {velocity.unit!r} is not known, taken as {found.velocity};"
            " give another with --velocity-unit, or its size with [scale] velocity in --map"
        )
    if found.velocity is None:
        remarks.warnings.append(
            f"{velocity.name} is not used, {found.evidence}; velocity is differentiated from"
            " position"
        )
    elif found.velocity != (written or "deg/s") and found.evidence and names.VELOCITY not in forced:
        says = f"says {velocity.unit}" if velocity.unit else "has no unit"
        remarks.notes.append(f"{velocity.name} {says}, {found.evidence}: read as {found.velocity}")
    if found.reversed_velocity:
        remarks.warnings.append(
            f"{velocity.name} has the sign opposite to the change of position: sign reversed"
        )
