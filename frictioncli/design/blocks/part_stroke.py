"""Turning points elsewhere: what belongs to an angle is parted from what follows a reversal."""

from frictioncli.design.block import Block
from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep

_SHORTEST = 30.0
"""Strokes shorter than this leave too few angle bins. [deg]"""


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return series over the middle, the upper half and the lower half of the stroke."""
    low, high, stroke = limits.low, limits.high, limits.stroke
    parts = (
        (low + stroke / 4, high - stroke / 4),
        (high - stroke / 2, high),
        (low, low + stroke / 2),
    )
    # a shorter way to gain speed: constant over a third of it still
    fastest = limits.highest_useful / 2**0.5
    speeds = tuple(one for one in limits.speeds(4, slowest=stroke / 20) if one <= fastest)
    if stroke / 2 < _SHORTEST or not speeds:
        return ()
    return (
        Block(
            name="turning points elsewhere",
            reason="the moves turn at other angles: parts angle from the way since the reversal",
            steps=tuple(SeriesStep(speeds=speeds, low=start, high=stop) for start, stop in parts),
        ),
    )
