"""The slowest speeds over a part of the stroke, and the highest: laws of speed part at the ends."""

from frictioncli.design.block import Block
from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep

_PART = 60.0
"""Angle of the slow moves, at most. [deg]"""

_BETWEEN = 7.0
"""The next speed is so many times the slowest."""

_BELOW = 0.62
"""And the one below the highest this share of it."""


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one block of two slow and two fast speeds."""
    low, high, part = limits.low, limits.high, min(limits.stroke, _PART)
    middle, highest = (low + high) / 2, min(limits.fastest, limits.highest_useful)
    slow = {limits.speed(limits.slowest * times) for times in (1.0, _BETWEEN)}
    fast = {limits.speed(highest * share) for share in (_BELOW, 1.0)}
    return (
        Block(
            name="both ends of speed",
            reason="slowest and highest speeds in turn: laws of speed part most at the ends",
            steps=(
                SeriesStep(
                    speeds=tuple(sorted(slow)), low=middle - part / 2, high=middle + part / 2
                ),
                SeriesStep(speeds=tuple(sorted(fast)), low=low, high=high),
            ),
        ),
    )
