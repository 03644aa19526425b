"""Many speeds in equal steps up to the highest: laws of speed differ in how they bow."""

import random

import numpy as np

from frictioncli.design.block import Block
from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep

_SPEEDS = 10


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one series of evenly spaced speeds, in random order."""
    highest = min(limits.fastest, limits.highest_useful)
    lowest = min(max(limits.slowest, highest / _SPEEDS), highest)
    speeds = sorted({limits.speed(float(one)) for one in np.linspace(lowest, highest, _SPEEDS)})
    random.Random(seed).shuffle(speeds)
    return (
        Block(
            name="even speeds",
            reason="ten speeds in equal steps, half of them fast: how friction bows over speed",
            steps=(SeriesStep(speeds=tuple(speeds), low=limits.low, high=limits.high),),
        ),
    )
