"""Programmes that nobody chose: blocks of the plan's own list at random, and motions at random."""

import random

from frictioncli.design.blocks import Block
from frictioncli.design.selection import seconds_of as block_seconds
from frictioncli.design.selection import steps_of
from frictioncli.design.steps import SeriesStep
from tests.simulation.motion_programme import MeasuredMoves, Motion, Standstill, UnrecordedMoves
from tests.studies.planning_worlds import HIGH, LOW, acts_of, seconds_of

SLOWEST = 3.0
"""[deg/s]"""

LEAST_STROKE = 60.0
"""[deg]"""

MOST_SPEEDS = 6
LONGEST = 480.0
"""Of one time of moving unrecorded, or of standing. [s]"""


def blocks_at_random(
    generator: random.Random, blocks: tuple[Block, ...], budget: float
) -> list[Motion]:
    """Return blocks drawn one by one as long as any fits into a time [s].

    The first measures something: without any series there is nothing to diagnose.
    """
    taken: tuple[Block, ...] = ()
    while fitting := [
        one
        for one in blocks
        if block_seconds((*taken, one), 0.0) <= budget
        and (taken or any(isinstance(step, SeriesStep) for step in one.steps))
    ]:
        taken = (*taken, generator.choice(fitting))
    return acts_of(steps_of(taken))


def motions_at_random(generator: random.Random, fastest: float, budget: float) -> list[Motion]:
    """Return measured series, unrecorded moves and rests at random, until a time [s] is filled.

    The first is a series.
    """
    taken: list[Motion] = []
    left = budget
    while True:
        low = generator.uniform(LOW, HIGH - LEAST_STROKE)
        high = generator.uniform(low + LEAST_STROKE, HIGH)
        speeds = [
            generator.uniform(SLOWEST, fastest) for _ in range(generator.randint(1, MOST_SPEEDS))
        ]
        seconds = generator.uniform(60.0, LONGEST)
        kinds: list[Motion] = [
            MeasuredMoves(speeds=tuple(speeds), low=low, high=high),
            UnrecordedMoves(speed=speeds[0], low=low, high=high, seconds=seconds),
            Standstill(seconds),
        ]
        act = generator.choice(kinds) if taken else kinds[0]
        if seconds_of(act) <= left:
            taken.append(act)
            left -= seconds_of(act)
        elif taken:
            return taken
