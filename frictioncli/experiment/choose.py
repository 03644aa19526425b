"""Which blocks, in which order: greedy and from random starts, then exchanges, within a budget.

Every block changes what the next one finds: temperature, way, rest. So whole programmes are
compared, not blocks.
"""

import random
from collections.abc import Callable, Sequence

from frictioncli.experiment.block import Block
from frictioncli.experiment.steps import MOUNTING, Step, duration, mountings

Worth = Callable[[Sequence[Step]], float]

_LEAST = 1e-4
"""What a block must add to be taken."""

_ROUNDS = 1
"""Rounds of exchanges."""

_STARTS = 40
"""Programmes at random that compete with the greedy one: it never heats for long before it sees
what that is good for."""

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
    candidates: Sequence[Block], worth: Worth, budget: float, payload: float | None, seed: int
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
        Source of the random starts.
    """
    greedy = _greedy(candidates, worth, budget, payload)
    generator = random.Random(seed)
    starts = [_at_random(generator, candidates, budget, payload) for _ in range(_STARTS)]
    rated = [(worth(steps_of(one)), -place, one) for place, one in enumerate([greedy, *starts])]
    value, _, taken = max(rated, key=lambda one: one[:2])
    for _ in range(_ROUNDS):
        better, gain = _exchanged(taken, candidates, worth, value, budget, payload)
        if not gain > _LEAST:
            break
        taken, value = better, value + gain
    return taken


def _greedy(
    candidates: Sequence[Block], worth: Worth, budget: float, payload: float | None
) -> tuple[Block, ...]:
    """Return a programme to which each block adds most for its time."""
    taken: tuple[Block, ...] = ()
    value = worth(())
    while True:
        fitting = [
            (*taken, one)
            for one in candidates
            if taken.count(one) < _REPEATS and seconds_of((*taken, one), payload) <= budget
        ]
        # what counts is worth per time: many short blocks may do more than a long one
        rated = [
            ((worth(steps_of(one)) - value) / (one[-1].seconds + 30.0), place)
            for place, one in enumerate(fitting)
        ]
        gaining = [pair for pair in rated if pair[0] > _LEAST / 600.0]
        if not gaining:
            return taken
        best = max(gaining, key=lambda pair: (pair[0], -pair[1]))[1]
        taken = fitting[best]
        value = worth(steps_of(taken))


def _at_random(
    generator: random.Random, candidates: Sequence[Block], budget: float, payload: float | None
) -> tuple[Block, ...]:
    """Return blocks at random that fill a time [s]."""
    taken: tuple[Block, ...] = ()
    while True:
        fitting = [
            one
            for one in candidates
            if taken.count(one) < _REPEATS and seconds_of((*taken, one), payload) <= budget
        ]
        if not fitting:
            return taken
        taken = (*taken, generator.choice(fitting))


def _exchanged(
    taken: tuple[Block, ...],
    candidates: Sequence[Block],
    worth: Worth,
    value: float,
    budget: float,
    payload: float | None,
) -> tuple[tuple[Block, ...], float]:
    """Return a programme with blocks exchanged one place after the other, and what it gains."""
    current, reached = taken, value
    for place in range(len(taken)):
        for one in candidates:
            other = (*current[:place], one, *current[place + 1 :])
            if other.count(one) > _REPEATS or seconds_of(other, payload) > budget:
                continue
            found = worth(steps_of(other))
            if found > reached + _LEAST:
                current, reached = other, found
    return current, reached - value
