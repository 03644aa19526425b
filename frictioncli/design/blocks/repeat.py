"""A few speeds from slow to fast, as a reference that comes back."""

from frictioncli.design.block import Block, short_series
from frictioncli.design.limits import Limits


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one short series."""
    return (
        Block(
            name="reference series",
            reason="the same speeds again: what has changed since, and how much they scatter",
            steps=(short_series(limits),),
        ),
    )
