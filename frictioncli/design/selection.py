"""Which blocks, in which order: the best of many at random, then exchanges, within a budget.

Every block changes what the next one finds: temperature, way, rest. So whole programmes are
compared, not blocks.
"""

import random
from collections.abc import Callable, Sequence

from frictioncli.design.blocks import Block
from frictioncli.design.steps import MOUNTING, Step, duration, mountings

Worth = Callable[[Sequence[Step]], float]

_STARTS = 30
"""Programmes at random, of which the best is changed further."""

_TRIALS = 100
"""Exchanges of a stretch of it that are tried."""

_STRETCH = 3
"""A stretch is at most one in so many of its blocks."""

_REPEATS = 12
"""Times that one block may come, at most: more of the same guards against noise only."""


def steps_of(blocks: Sequence[Block]) -> tuple[Step, ...]:
    """Return the steps of blocks, one after the other."""
    return tuple(step for block in blocks for step in block.steps)


def seconds_of(blocks: Sequence[Block], payload: float | None) -> float:
    """Return how long blocks take, with the changes of payload that they need [s]."""
    steps = steps_of(blocks)
    return duration(steps) + MOUNTING * sum(mountings(steps, payload))


def chosen(
    candidates: Sequence[Block],
    worth: Worth,
    budget: float,
    payload: float | None,
    seed: int,
    trials: int = _TRIALS,
) -> tuple[Block, ...]:
    """Return the blocks that are worth most together, in order.

    Parameters
    ----------
    candidates : sequence of Block
        Blocks; each may come up to twelve times.
    worth : callable
        What a programme is worth, from its steps.
    budget : float
        Time for all. [s]
    payload : float or None
        What is on before. [kg]
    seed : int
        Source of the random starts and exchanges.
    trials : int
        Exchanges that are tried.
    """
    generator = random.Random(seed)

    def filled(taken: tuple[Block, ...], place: int) -> tuple[Block, ...]:
        """Return a programme with blocks at random from a place on, until its time is filled."""
        fitting = list(candidates)
        while fitting:
            one = generator.choice(fitting)
            longer = (*taken[:place], one, *taken[place:])
            if longer.count(one) > _REPEATS or seconds_of(longer, payload) > budget:
                fitting.remove(one)
            else:
                taken, place = longer, place + 1
        return taken

    starts = [filled((), 0) for _ in range(_STARTS)]
    rated = [worth(steps_of(one)) for one in starts]
    value = max(rated)
    taken = starts[rated.index(value)]
    for _ in range(trials):
        first = generator.randrange(len(taken) + 1)
        count = generator.randint(1, 1 + len(taken) // _STRETCH)
        other = filled(taken[:first] + taken[first + count :], first)
        found = worth(steps_of(other))
        if found > value:
            taken, value = other, found
    return taken if value > worth(()) else ()
