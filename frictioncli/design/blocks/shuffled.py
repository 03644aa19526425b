"""Speeds in random order: what goes with speed is parted from what goes with time."""

import random

from frictioncli.design.block import Block
from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep

_SPEEDS = 7


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one series in random order."""
    speeds = list(limits.speeds(_SPEEDS, slowest=limits.stroke / 20))
    random.Random(seed).shuffle(speeds)
    return (
        Block(
            name="random order of speeds",
            reason="speeds out of order: parts what goes with speed from what goes with time",
            steps=(SeriesStep(speeds=tuple(speeds), low=limits.low, high=limits.high),),
        ),
    )
