"""Channels of a log that a mapping file names."""

import difflib
from collections.abc import Sequence
from dataclasses import replace

from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.channel_names import JOINT_SIDE, POSITION, TIME, TORQUE, Meaning
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels
from frictioncli.logs.log_source import Refusal
from frictioncli.plain_text import whole_number

_COMPARED = 100
"""Length up to which names are compared; the time grows with its square. [characters]"""


def mapped_channels(
    channel_map: ChannelMap, columns: Sequence[str], joint: int
) -> tuple[LogChannel, ...] | Refusal:
    """Return the channels that the map names, and those recognised where it names none.

    Where the map names position or torque, only the time is still recognised by its name, and the
    positions of other joints that have the name of the mapped one but for the number.

    Parameters
    ----------
    channel_map : ChannelMap
        The map.
    columns : sequence of str
        All column names of the log.
    joint : int
        The joint of the mapped columns.

    Returns
    -------
    tuple of LogChannel or Refusal
        Refused as ``mapped_column_missing`` where the log lacks a mapped column.
    """
    recognised = recognise_channels(columns)
    if TORQUE not in channel_map.channels and POSITION not in channel_map.channels:
        kept = [
            with_side(c, channel_map) for c in recognised if c.quantity not in channel_map.channels
        ]
    else:
        kept = [c for c in recognised if c.quantity == TIME and TIME not in channel_map.channels]
    for quantity, wanted in channel_map.channels.items():
        index = _find(columns, wanted)
        if index is None:
            names = [column[:_COMPARED] for column in columns if column]
            close = difflib.get_close_matches(wanted[:_COMPARED], names, n=3, cutoff=0.4)
            hint = f"; close: {', '.join(close)}" if close else ""
            return Refusal(
                "mapped_column_missing",
                f"no column {wanted!r}, which the map names as {quantity}{hint}; columns found:"
                f" {', '.join(names[:20])}",
            )
        if any(c.column == index and c.quantity == TIME for c in kept):
            return Refusal(
                "mapped_column_missing",
                f"the map names column {wanted!r} as {quantity}, but that is the time,"
                f" {columns[index][:_COMPARED]!r}; expected another column",
            )
        known = next((c.meaning for c in recognised if c.column == index), None)
        if known is not None and known.quantity != quantity:
            known = None
        side = known.side if known is not None and quantity != TORQUE else JOINT_SIDE
        side = channel_map.sides.get(quantity, side)
        unit = split_unit(columns[index])[1]
        if not unit and known is not None:
            unit = known.unit
        mapped = LogChannel(
            index, columns[index], Meaning(quantity, side, unit=unit), joint, unit, wanted
        )
        if quantity == POSITION:
            others = _other_positions(recognised, index, joint)
            kept += others
            mapped = replace(mapped, family=others[0].family) if others else mapped
        kept.append(mapped)
    return tuple(kept)


def _other_positions(recognised: Sequence[LogChannel], index: int, joint: int) -> list[LogChannel]:
    """Return the positions of other joints, of the same family as the mapped one.

    Their numbers count from that of the mapped joint, which may differ from the number in its name.
    """
    own = next((c for c in recognised if c.column == index and c.quantity == POSITION), None)
    if own is None or own.joint is None:
        return []
    others = [
        replace(c, joint=c.joint + joint - own.joint)
        for c in recognised
        if c.joint is not None
        and (c.meaning, c.family) == (own.meaning, own.family)
        and c.column != index
    ]
    # a number below 1 shows that the joint's number counts otherwise
    return others if all(c.joint is not None and c.joint >= 1 for c in others) else []


def with_side(channel: LogChannel, channel_map: ChannelMap) -> LogChannel:
    """Return a channel with the side of the gear that the map gives its quantity.

    Parameters
    ----------
    channel : LogChannel
        A recognised channel.
    channel_map : ChannelMap
        The map.
    """
    side = channel_map.sides.get(channel.quantity)
    if side is None:
        return channel
    return replace(channel, meaning=replace(channel.meaning, side=side))


def _find(columns: Sequence[str], wanted: str) -> int | None:
    """Return the index of a column by its name, or by its number from 1.

    The name may lack blanks around it or its unit.
    """
    for normal in (str, str.strip, lambda name: split_unit(name)[0]):
        matches = [i for i, column in enumerate(columns) if normal(column) == normal(wanted)]
        if matches:
            return matches[0]
    number = whole_number(wanted)
    return number - 1 if number is not None and 1 <= number <= len(columns) else None
