"""Algorithm 1 of the paper: one pair per speed, from slow to fast."""

from frictioncli.design.block import Block
from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep

_SPEEDS = 9
_LONGEST = 60.0
"""Longest time for one move of the sweep. [s]"""


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one slow sweep."""
    speeds = limits.speeds(_SPEEDS, slowest=limits.stroke / _LONGEST)
    return (
        Block(
            name="slow sweep",
            reason="many speeds at nearly one temperature: the law of speed, and its slow end",
            steps=(SeriesStep(speeds=speeds, low=limits.low, high=limits.high),),
        ),
    )
