"""Moves at the highest speed heat the joint; then a series, as in Algorithm 2 of the paper."""

from frictioncli.design.block import Block, short_series
from frictioncli.design.limits import Limits
from frictioncli.design.steps import HeatStep

_MINUTES = (3, 8, 15)


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return heating for short and long times."""
    return tuple(
        Block(
            name=f"heat {minutes} min",
            reason="a warmer joint, and a motor that is ahead of the gear: a second thermal cycle",
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
