"""Selection of blocks and their order: random starts, then exchanges, within a time budget.

Each block changes the temperature, travel and rest that the next one starts from. Therefore whole
programmes are compared, not single blocks.
"""

import random
from collections.abc import Callable, Sequence

from frictioncli.design.blocks import Block
from frictioncli.design.steps import PAYLOAD_CHANGE, Step, duration, payload_changes

Criterion = Callable[[Sequence[Step]], float]
"""Value of the design criterion for the steps of a programme; greater is better."""

_STARTS = 30
"""Number of random programmes, of which the best is improved."""

_EXCHANGES = 100
"""Number of exchanges that are usually tried."""

_EXCHANGE_SHARE = 3
"""An exchange replaces at most one in so many blocks, plus one."""

_MOST_REPEATS = 12
"""Greatest number of times that one block may occur; more repetition only averages noise."""


def steps_of(blocks: Sequence[Block]) -> tuple[Step, ...]:
    """Return the steps of blocks in sequence."""
    return tuple(step for block in blocks for step in block.steps)


def seconds_of(blocks: Sequence[Block], payload: float | None) -> float:
    """Return the duration of blocks with the changes of payload that they need.

    Parameters
    ----------
    blocks : sequence of Block
        The blocks.
    payload : float or None
        Payload that is mounted before the first. [kg]

    Returns
    -------
    float
        Duration. [s]
    """
    steps = steps_of(blocks)
    return duration(steps) + PAYLOAD_CHANGE * sum(payload_changes(steps, payload))


def choose_blocks(
    candidates: Sequence[Block],
    criterion: Criterion,
    budget: float,
    payload: float | None,
    seed: int,
    exchanges: int | None = None,
) -> tuple[Block, ...]:
    """Return the sequence of blocks with the greatest criterion that was found.

    Parameters
    ----------
    candidates : sequence of Block
        Blocks to choose from; each may occur up to twelve times.
    criterion : callable
        Value of a programme from its steps.
    budget : float
        Time for all blocks. [s]
    payload : float or None
        Payload that is mounted before the first. [kg]
    seed : int
        Seed of the random starts and exchanges.
    exchanges : int, optional
        Number of exchanges that are tried; usually 100.

    Returns
    -------
    tuple of Block
        Empty where no programme is better than none.
    """
    generator = random.Random(seed)

    def fill(blocks: tuple[Block, ...], place: int) -> tuple[Block, ...]:
        """Return blocks with random ones inserted from a place on until the time is used."""
        fitting = list(candidates)
        while fitting:
            block = generator.choice(fitting)
            longer = (*blocks[:place], block, *blocks[place:])
            if longer.count(block) > _MOST_REPEATS or seconds_of(longer, payload) > budget:
                fitting.remove(block)
            else:
                blocks, place = longer, place + 1
        return blocks

    starts = [fill((), 0) for _ in range(_STARTS)]
    values = [criterion(steps_of(blocks)) for blocks in starts]
    best = max(values)
    chosen = starts[values.index(best)]
    for _ in range(_EXCHANGES if exchanges is None else exchanges):
        first = generator.randrange(len(chosen) + 1)
        count = generator.randint(1, 1 + len(chosen) // _EXCHANGE_SHARE)
        other = fill(chosen[:first] + chosen[first + count :], first)
        value = criterion(steps_of(other))
        if value > best:
            chosen, best = other, value
    return chosen if best > criterion(()) else ()
