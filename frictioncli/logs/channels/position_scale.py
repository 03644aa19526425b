"""Positions without unit that nothing else shows to be angles in deg or rad."""

import re

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.position_units import RADIAN_LIMIT
from frictioncli.logs.channels.survey import Survey
from frictioncli.logs.channels.torque_choice import direction_differences
from frictioncli.plain_text import printable

_OF_DATA_SET = re.compile(r"observation[._ ]?(?:state|qpos)", re.I)
"""Names of LeRobot and the like, whose positions are in deg, in rad or relative to the range."""
_ENDS = (1.0, 100.0)
"""Where positions relative to a joint's range end."""
_LEAST_AT_END = 3
_COARSE = 0.1
_WHOLE, _NEAR = 15.0, 0.15
"""Programs turn at multiples of so many degrees, and measured positions come so near. [deg]"""
_LEFT = 0.1
"""Greatest share of a load's variance that gravity over the angle in deg leaves."""
_LEFT_IN_RADIANS = 3.0
"""Least ratio of what gravity over the same numbers in rad leaves."""


def warnings_of_scale(channels: JointChannels, survey: Survey, unit: str) -> list[str]:
    """Return warnings of a position without unit that may not be in the unit it is read in.

    Parameters
    ----------
    channels : JointChannels
        The joint's columns.
    survey : Survey
        Raw samples.
    unit : str
        The unit in which the position is read.
    """
    name, values = printable(channels.position.name), np.abs(survey.pooled(channels.position))
    largest = float(np.max(values, initial=0.0))
    all_of_them = [np.abs(survey.pooled(one)) for one in survey.family(channels.position)]
    farthest = max(float(np.max(one, initial=0.0)) for one in all_of_them)
    ends = largest in _ENDS and int(np.sum(values == largest)) >= _LEAST_AT_END
    is_relative = RADIAN_LIMIT < farthest <= _ENDS[1] or farthest <= _ENDS[0]
    if (ends and _is_fine(values)) or (_OF_DATA_SET.search(name) and is_relative):
        what = "ends exactly at" if ends else "stays within"
        bound = _ENDS[0] if farthest <= _ENDS[0] else _ENDS[1]
        return [
            f"{name} has no unit and {what} ±{bound:g}, as positions relative to the joint's range"
            f" do: read as {unit}; if they are, give the angle of one unit in deg with --map, as"
            " [scale] position = 1.35"
        ]
    if unit != "deg" or largest <= RADIAN_LIMIT or _shows_degrees(channels, survey):
        return []
    return [
        f"{name} has no unit and reaches {largest:.4g}: read as deg; if it is the angle in rad of"
        " a motor that turns on, say so with --position-unit rad"
    ]


def _is_fine(values: Array) -> bool:
    """Return whether most values have more digits than a rounded angle."""
    steps = values / _COARSE
    return bool(np.mean(np.abs(steps - np.round(steps)) > 1e-6) > 0.5)


def _shows_degrees(channels: JointChannels, survey: Survey) -> bool:
    """Return whether the axis is one of many, turns at round angles, or carries its gravity.

    An arm with joints that turn further than a turn in rad is logged in deg.
    """
    if len({c.joint for c in survey.channels if c.quantity == names.POSITION}) > 1:
        return True
    return _turns_at_round_angles(channels, survey) or _gravity_shows_degrees(channels, survey)


def _turns_at_round_angles(channels: JointChannels, survey: Survey) -> bool:
    positions = (head[channels.position.column] for head in survey.heads)
    ends = [(float(np.nanmin(one)), float(np.nanmax(one))) for one in positions if len(one)]
    away = [abs(end - _WHOLE * round(end / _WHOLE)) for pair in ends for end in pair]
    spans = (high - low for low, high in ends)
    return bool(away) and max(away) < _NEAR and min(spans) > _WHOLE


def _gravity_shows_degrees(channels: JointChannels, survey: Survey) -> bool:
    """Return whether half the sum of both directions is a sine of the angle in deg."""
    wanted = [channels.torque, channels.position]
    found = direction_differences(survey, channels, wanted)
    if found is None:
        return False
    load, angle = (one.half_sum for one in found)
    total = float(np.sum((load - np.mean(load)) ** 2))
    left = _unexplained(load, np.radians(angle))
    return left < _LEFT * total and _unexplained(load, angle) > _LEFT_IN_RADIANS * left


def _unexplained(load: Array, angle: Array) -> float:
    """Return the sum of squares of a load that a gravity over an angle leaves."""
    design = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    fitted, *_ = np.linalg.lstsq(design, load, rcond=None)
    return float(np.sum((load - design @ fitted) ** 2))
