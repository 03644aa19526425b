"""Units of the channels of a joint's state: its temperatures, a measured load, the payload."""

from collections.abc import Mapping

import numpy as np

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.motion_units import Remarks
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.survey import Survey
from frictioncli.logs.channels.units import UnitConversion

_MOST_PAYLOADS = 24
"""Different values up to which a channel holds payloads that a controller was told."""


def state_conversions(
    channels: JointChannels, survey: Survey, forced: Mapping[str, str], remarks: Remarks
) -> dict[str, UnitConversion]:
    """Return the conversions of temperatures, load and payload, of those that the log has.

    Parameters
    ----------
    channels : JointChannels
        The columns of the joint.
    survey : Survey
        Raw samples of logs with this layout.
    forced : mapping of str to str
        Unit by quantity, given by the user.
    remarks : Remarks
        Takes notes on channels that are left out.
    """
    found = {}
    for quantity, channel in (
        (names.MOTOR_TEMPERATURE, channels.motor_temperature),
        (names.HOUSING_TEMPERATURE, channels.housing_temperature),
    ):
        if channel is None:
            continue
        conversion = _of_temperature(channel, quantity, survey, forced, remarks)
        if conversion is not None:
            found[quantity] = conversion
    for quantity, channel, usual in (
        (names.LOAD, channels.load, "N·m"),
        (names.PAYLOAD, channels.payload, "kg"),
    ):
        if channel is None or (quantity == names.PAYLOAD and not _is_told(channel, survey)):
            continue
        written = units.canonical(channel.unit, quantity)
        found[quantity] = units.conversion_from(forced.get(quantity) or written or usual, quantity)
    if channels.payload is not None and names.PAYLOAD not in found:
        remarks.notes.append(
            f"{channels.payload.name} holds no payloads (at most {_MOST_PAYLOADS} masses, none"
            " below 0): left out"
        )
    return found


def _of_temperature(
    channel: LogChannel,
    quantity: str,
    survey: Survey,
    forced: Mapping[str, str],
    remarks: Remarks,
) -> UnitConversion | None:
    conversion = units.infer_temperature_unit(
        survey.pooled(channel),
        units.canonical(channel.unit, quantity),
        forced.get(quantity),
        quantity,
    )
    if conversion is None:
        remarks.notes.append(
            f"{channel.name} has no temperature (empty, zero, or outside -30..150 °C): left out"
        )
    elif conversion.note:
        remarks.notes.append(f"{channel.name}: {conversion.note}")
    return conversion


def _is_told(channel: LogChannel, survey: Survey) -> bool:
    """Return whether a payload is one that a controller was told.

    A measured one differs from sample to sample, and no two moves would carry the same.
    """
    values = survey.pooled(channel)
    return 0 < len(np.unique(values)) <= _MOST_PAYLOADS and bool(np.all(values >= 0))
