"""Why a unit is believed, in a sentence; and the gear ratio that a plan uses."""

import math
from collections.abc import Collection

from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel

_TURN = 6.9


def evidence(plan: JointPlan, quantity: str, told: Collection[str], furthest: float) -> str:
    """Return why a channel is read in its unit.

    Parameters
    ----------
    plan : JointPlan
        How the joint is read.
    quantity : str
        Which channel.
    told : collection of str
        Quantities whose unit the user gives.
    furthest : float
        Greatest distance of its values from zero, in the unit used inside.
    """
    channel: LogChannel = getattr(plan.channels, quantity)
    said = remarks_on(plan, channel)
    if quantity in told:
        return "; ".join(("as told", *said))
    if any("read as" in text or "taken as" in text for text in said):
        return "; ".join(said)
    if channel.unit:
        return "; ".join(("as the header says", *said))
    if quantity == names.POSITION and furthest > _TURN:
        return "; ".join((f"no unit, but values reach {furthest:.4g}, too far for rad", *said))
    return "; ".join(("no unit in the header, taken as usual", *said))


def remarks_on(plan: JointPlan, channel: LogChannel) -> tuple[str, ...]:
    """Return what reading notes and warns of a channel, without the channel's name in front."""
    return tuple(
        text.removeprefix(channel.name).lstrip(": ")
        for text in (*plan.notes, *plan.warnings)
        if text.startswith(channel.name)
    )


def other_remarks(plan: JointPlan) -> tuple[str, ...]:
    """Return what reading notes and warns beyond single channels that are read."""
    read = tuple(getattr(plan.channels, name).name for name in plan.conversions)
    return tuple(text for text in (*plan.notes, *plan.warnings) if not text.startswith(read))


def gear_ratio(plan: JointPlan) -> float | None:
    """Return the motor turns per joint turn by which channels are brought to the joint.

    Without its sign; None where no channel is brought there.
    """
    for name in (names.POSITION, names.VELOCITY, names.TORQUE):
        conversion = plan.conversions.get(name)
        if conversion is None:
            continue
        scale = abs(conversion.factor) / units.conversion_from(conversion.unit, name).factor
        if not math.isclose(scale, 1.0):
            return scale if name == names.TORQUE else 1 / scale
    return None
