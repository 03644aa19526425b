"""The motion of axes in the first rows of logs, from which units are inferred."""

from dataclasses import replace

import numpy as np

from frictioncli.logs.channels import position_units
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.survey import Survey
from frictioncli.logs.channels.unit_evidence import RawMotion

_FARTHEST_TOOL = 10.0
"""Largest coordinate of the tool of an arm; that of one in mm is larger. [m]"""


def with_moving_position(channels: JointChannels, survey: Survey) -> JointChannels:
    """Return a joint's channels with a position that changes, where the preferred one never does.

    Parameters
    ----------
    channels : JointChannels
        The joint's columns.
    survey : Survey
        Raw samples.
    """
    chosen = channels.position
    if not survey.n_rows or _changes(survey, chosen):
        return channels
    others = (
        one
        for one in survey.channels
        if (one.quantity, one.joint) == (chosen.quantity, chosen.joint)
        and one.meaning.side == chosen.meaning.side
        and _changes(survey, one)
    )
    moving = next(others, None)
    if moving is None:
        return channels
    note = f"position of joint {channels.joint} is {moving.name}: {chosen.name} never changes"
    return replace(channels, position=moving, notes=(*channels.notes, note))


def _changes(survey: Survey, channel: LogChannel) -> bool:
    values = survey.pooled(channel)
    return len(values) > 0 and float(np.ptp(values)) > 0


def position_range(
    survey: Survey, time: LogChannel, family: list[LogChannel]
) -> tuple[float, float]:
    """Return the largest absolute position and the largest range of positions that share a unit.

    Parameters
    ----------
    survey : Survey
        Raw samples.
    time : LogChannel
        The time.
    family : list of LogChannel
        The positions.

    Returns
    -------
    largest, span : float
        As of :func:`frictioncli.logs.channels.position_units.position_range`. [raw]
    """
    columns = (time.column, *(member.column for member in family))
    if columns not in survey.position_ranges:
        survey.position_ranges[columns] = position_units.position_range(
            motions_of(survey, time, family)
        )
    return survey.position_ranges[columns]


def motions_of(survey: Survey, time: LogChannel, family: list[LogChannel]) -> list[RawMotion]:
    """Return the surveyed positions of some axes in each log.

    Parameters
    ----------
    survey : Survey
        Raw samples.
    time : LogChannel
        The time.
    family : list of LogChannel
        The positions.
    """
    return [motion for member in family for motion in motions(survey, time, member, None)]


def motions(
    survey: Survey, time: LogChannel, position: LogChannel, velocity: LogChannel | None
) -> list[RawMotion]:
    """Return the surveyed motion of an axis in each log, without rows that lack a value.

    Parameters
    ----------
    survey : Survey
        Raw samples.
    time, position : LogChannel
        The time, and the position of the axis.
    velocity : LogChannel or None
        Its velocity; none is returned where it is None.
    """
    found = []
    for head in survey.heads:
        good = np.isfinite(head[position.column])
        rate = np.empty(0)
        if velocity is not None:
            good = good & np.isfinite(head[velocity.column])
            rate = head[velocity.column][good]
        found.append(RawMotion(head[time.column][good], head[position.column][good], rate))
    return found


def tool_paths_per_angle(survey: Survey, family: list[LogChannel]) -> tuple[float, ...]:
    """Return the tool's path per angle of the moving axis, median over the logs.

    Where no unit is written, coordinates that an arm may have in m are taken as m or mm, larger
    ones as mm.

    Parameters
    ----------
    survey : Survey
        Raw samples.
    family : list of LogChannel
        The positions of all axes.

    Returns
    -------
    tuple of float
        In each unit that the tool may be logged in; empty where its position is not logged, or
        nothing moves. [mm/raw]
    """
    tool = survey.tool()
    if not tool:
        return ()
    found = []
    for head in survey.heads:
        points = np.stack([head[c.column] for c in tool], axis=1)
        axes = np.stack([head[c.column] for c in family], axis=1)
        good = np.isfinite(points).all(axis=1) & np.isfinite(axes).all(axis=1)
        ratio = position_units.tool_path_per_angle(points[good], axes[good])
        if ratio is not None:
            found.append(ratio)
    if not found:
        return ()
    path, written = float(np.median(found)), {channel.unit.strip() for channel in tool}
    if written == {"m"}:
        return (1000.0 * path,)
    usual = max(float(np.quantile(np.abs(survey.pooled(c)), 0.95)) for c in tool)
    return (path, 1000.0 * path) if written == {""} and usual <= _FARTHEST_TOOL else (path,)


def period(survey: Survey, time: LogChannel) -> float | None:
    """Return the median step of a time from row to row; None where there is none.

    Parameters
    ----------
    survey : Survey
        Raw samples.
    time : LogChannel
        The time. [raw]
    """
    steps = np.concatenate([np.empty(0), *(np.diff(head[time.column]) for head in survey.heads)])
    ahead = steps[steps > 0]
    return float(np.median(ahead)) if len(ahead) else None
