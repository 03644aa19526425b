"""The blocks that a measuring programme is composed of: one function per kind of block."""

import random
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frictioncli.design.limits import Limits
from frictioncli.design.steps import HeatStep, RestStep, SeriesStep, Step, duration

_SERIES_MOVE_TIME = 20.0
"""Longest time for one move of a short series. [s]"""

_SWEEP_MOVE_TIME = 60.0
"""Longest time for one move of the slow sweep. [s]"""

_MINUTES = (3, 8, 15)
"""Durations of heating and of static holds that are offered. [min]"""

_SLOW_STROKE = 60.0
"""Longest stroke of the slowest moves. [deg]"""

_SHORTEST_STROKE = 30.0
"""Shorter strokes leave too few angle bins. [deg]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Steps that are carried out together.

    Attributes
    ----------
    name : str
        Name of the block.
    reason : str
        One sentence on what this block shows that others do not.
    steps : tuple of Step
        The steps, in order.
    """

    name: str
    reason: str
    steps: tuple[Step, ...]

    @property
    def seconds(self) -> float:
        """Duration without changes of payload [s]."""
        return duration(self.steps)


BlockKind = Callable[[Limits, int], tuple[Block, ...]]
"""Function that returns the blocks of one kind within limits; the integer seeds random orders."""


def short_series(limits: Limits, payload: float | None = None) -> SeriesStep:
    """Return a series at four speeds over the whole stroke.

    Parameters
    ----------
    limits : Limits
        Limits of the joint.
    payload : float or None
        Payload to mount before it; None: the mounted one stays. [kg]
    """
    return SeriesStep(
        speeds=limits.speeds(4, slowest=limits.stroke / _SERIES_MOVE_TIME),
        low=limits.low,
        high=limits.high,
        payload=payload,
    )


def reference_series(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return a short series from slow to fast, to be repeated for reference."""
    return (
        Block(
            name="reference series",
            reason="the same speeds again: what has changed since, and how much they scatter",
            steps=(short_series(limits),),
        ),
    )


def slow_sweep(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return Algorithm 1 of the paper: one pair per speed, from slow to fast."""
    speeds = limits.speeds(9, slowest=limits.stroke / _SWEEP_MOVE_TIME)
    return (
        Block(
            name="slow sweep",
            reason="many speeds at nearly constant temperature: how friction depends on speed",
            steps=(SeriesStep(speeds=speeds, low=limits.low, high=limits.high),),
        ),
    )


def shuffled_speeds(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return a series in random order, which decorrelates speed and time."""
    speeds = list(limits.speeds(7, slowest=limits.stroke / _SERIES_MOVE_TIME))
    random.Random(seed).shuffle(speeds)
    return (
        Block(
            name="random order of speeds",
            reason="speeds out of order: separates effects of speed from effects of time",
            steps=(SeriesStep(speeds=tuple(speeds), low=limits.low, high=limits.high),),
        ),
    )


def even_speeds(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return a series of ten evenly spaced speeds in random order: it shows curvature in speed."""
    count = 10
    highest = min(limits.fastest, limits.highest_useful)
    lowest = min(max(limits.slowest, highest / count), highest)
    speeds = sorted({limits.speed(float(one)) for one in np.linspace(lowest, highest, count)})
    random.Random(seed).shuffle(speeds)
    return (
        Block(
            name="even speeds",
            reason="ten speeds in equal steps, half of them fast: the curvature of friction"
            " over speed",
            steps=(SeriesStep(speeds=tuple(speeds), low=limits.low, high=limits.high),),
        ),
    )


def extreme_speeds(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return two slow speeds over part of the stroke and two fast ones over all of it.

    Velocity laws differ most at the ends of the speed range.
    """
    low, high, part = limits.low, limits.high, min(limits.stroke, _SLOW_STROKE)
    middle, highest = (low + high) / 2, min(limits.fastest, limits.highest_useful)
    slow = {limits.speed(limits.slowest * factor) for factor in (1.0, 7.0)}
    fast = {limits.speed(highest * factor) for factor in (0.62, 1.0)}
    return (
        Block(
            name="slowest and fastest speeds",
            reason="slowest and fastest speeds alternately, where speed laws differ most",
            steps=(
                SeriesStep(
                    speeds=tuple(sorted(slow)), low=middle - part / 2, high=middle + part / 2
                ),
                SeriesStep(speeds=tuple(sorted(fast)), low=low, high=high),
            ),
        ),
    )


def heating(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return heating moves at the highest speed, each followed by a series (Algorithm 2)."""
    return tuple(
        Block(
            name=f"heat {minutes} min",
            reason="a second thermal cycle: a warmer joint, with the motor hotter than the gear",
            steps=(
                HeatStep(
                    speed=limits.speed(min(limits.fastest, limits.highest_useful)),
                    low=limits.low,
                    high=limits.high,
                    seconds=60.0 * minutes,
                    until=limits.hottest,
                ),
                short_series(limits),
            ),
        )
        for minutes in _MINUTES
    )


def travel_without_heat(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return twelve recorded round trips at about a third of the highest speed, then a series."""
    speed = limits.speed(0.35 * limits.fastest)
    return (
        Block(
            name="travel with little heat",
            reason="much travel in a short time with little heat: separates travel from time and"
            " temperature",
            steps=(
                SeriesStep(speeds=(speed,) * 12, low=limits.low, high=limits.high),
                short_series(limits),
            ),
        ),
    )


def static_hold(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return static holds, each followed by a series: time and cooling without travel."""
    return tuple(
        Block(
            name=f"hold still {minutes} min",
            reason="time and cooling without motion: recovery at rest, and how fast it fades",
            steps=(RestStep(60.0 * minutes), short_series(limits)),
        )
        for minutes in _MINUTES
    )


def other_turning_points(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return series over the middle, the upper half and the lower half of the stroke.

    They decorrelate the angle and the travel since the last reversal.
    """
    low, high, stroke = limits.low, limits.high, limits.stroke
    parts = (
        (low + stroke / 4, high - stroke / 4),
        (high - stroke / 2, high),
        (low, low + stroke / 2),
    )
    # half the stroke: speeds that still hold constant over a third of it
    fastest = limits.highest_useful / 2**0.5
    slowest = stroke / _SERIES_MOVE_TIME
    speeds = tuple(one for one in limits.speeds(4, slowest=slowest) if one <= fastest)
    if stroke / 2 < _SHORTEST_STROKE or not speeds:
        return ()
    return (
        Block(
            name="other reversal points",
            reason="the moves reverse at other angles: separates angle from distance since the"
            " reversal",
            steps=tuple(SeriesStep(speeds=speeds, low=start, high=stop) for start, stop in parts),
        ),
    )


def other_payloads(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one series for each payload that may be mounted."""
    return tuple(
        Block(
            name=f"payload {mass:g} kg",
            reason="another load at the same angles: separates load from angle, and load from"
            " friction",
            steps=(short_series(limits, payload=mass),),
        )
        for mass in limits.payloads
    )


BLOCK_KINDS: tuple[BlockKind, ...] = (
    reference_series,
    slow_sweep,
    shuffled_speeds,
    even_speeds,
    extreme_speeds,
    heating,
    travel_without_heat,
    static_hold,
    other_turning_points,
    other_payloads,
)
"""All kinds of blocks; their order decides ties and random draws."""


def all_blocks(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return all candidate blocks within limits.

    Parameters
    ----------
    limits : Limits
        Limits of the joint.
    seed : int
        Seed of the random orders of speeds.

    Examples
    --------
    >>> limits = Limits(low=0.0, high=90.0, slowest=2.0, fastest=100.0, hottest=65.0)
    >>> [block.name for block in all_blocks(limits, seed=0)][:3]
    ['reference series', 'slow sweep', 'random order of speeds']
    """
    return tuple(block for kind in BLOCK_KINDS for block in kind(limits, seed))
