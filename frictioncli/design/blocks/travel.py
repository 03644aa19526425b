"""Way without much heat: moves at a middling speed, then a series."""

from frictioncli.design.block import Block, short_series
from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep

_ROUNDS = 12
_SHARE = 0.35


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one stretch of recorded moves at a third of the highest speed."""
    speed = limits.speed(_SHARE * limits.fastest)
    return (
        Block(
            name="way without heat",
            reason="much way in a short time with little heat: parts way from time and temperature",
            steps=(
                SeriesStep(speeds=(speed,) * _ROUNDS, low=limits.low, high=limits.high),
                short_series(limits),
            ),
        ),
    )
