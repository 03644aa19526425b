"""The joint is held still, cools, and is then measured: time and cooling without way."""

from frictioncli.design.block import Block, short_series
from frictioncli.design.limits import Limits
from frictioncli.design.steps import RestStep

_MINUTES = (3, 8, 15)


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return short and long static holds, each with a series after it."""
    return tuple(
        Block(
            name=f"hold still {minutes} min",
            reason="time and cooling without way; what a rest brings back, and how fast it goes",
            steps=(RestStep(60.0 * minutes), short_series(limits)),
        )
        for minutes in _MINUTES
    )
