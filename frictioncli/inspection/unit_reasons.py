"""Reasons for the unit in which a channel is read, and the gear ratio that is used."""

import math
from collections.abc import Collection

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel

_LARGEST_RADIANS = 6.9
"""Positions in radians end at about one turn. [rad]"""


def evidence(plan: JointPlan, quantity: str, given: Collection[str], largest: float) -> str:
    """Return why a channel is read in its unit.

    Parameters
    ----------
    plan : JointPlan
        Columns and units of the joint.
    quantity : str
        Canonical name of the channel.
    given : collection of str
        Quantities whose unit the user gives.
    largest : float
        Largest magnitude of its values, in the unit used inside.
    """
    channel: LogChannel = getattr(plan.channels, quantity)
    notes = _remarks_on(plan, channel)
    if quantity in given:
        return "; ".join(("as given", *notes))
    if any("read as" in text or "taken as" in text for text in notes):
        return "; ".join(notes)
    if channel.unit and units.canonical(channel.unit, quantity):
        return "; ".join(("as the header says", *notes))
    if quantity == names.POSITION and largest > _LARGEST_RADIANS:
        return "; ".join((f"no unit, but values reach {largest:.4g}, too far for rad", *notes))
    return "; ".join(("no unit in the header, taken as usual", *notes))


def _remarks_on(plan: JointPlan, channel: LogChannel) -> tuple[str, ...]:
    """Return notes and warnings on a channel, without its name in front."""
    return tuple(
        text.removeprefix(channel.name).lstrip(": ")
        for text in (*plan.notes, *plan.warnings)
        if _is_on(channel.name, text)
    )


def other_remarks(plan: JointPlan) -> tuple[str, ...]:
    """Return notes and warnings that concern no single channel."""
    read = [getattr(plan.channels, name).name for name in plan.conversions]
    return tuple(
        text
        for text in (*plan.notes, *plan.warnings)
        if not any(_is_on(name, text) for name in read)
    )


def _is_on(name: str, text: str) -> bool:
    """Return whether a note is on a channel: it begins with the whole name."""
    return text.startswith((f"{name}:", f"{name} "))


def gear_ratio(plan: JointPlan) -> float | None:
    """Return the magnitude of the gear ratio by which channels are referred to the joint [-].

    None where no channel is converted from the motor side.
    """
    for name in (names.POSITION, names.VELOCITY, names.TORQUE):
        conversion = plan.conversions.get(name)
        if conversion is None:
            continue
        scale = abs(conversion.factor) / units.conversion_from(conversion.unit, name).factor
        if not math.isclose(scale, 1.0):
            return scale if name == names.TORQUE else 1 / scale
    return None
