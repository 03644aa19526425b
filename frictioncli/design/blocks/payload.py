"""Series with another payload, where the user has one at hand."""

from frictioncli.design.block import Block, short_series
from frictioncli.design.limits import Limits


def variants(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return one series for each payload that may be mounted."""
    return tuple(
        Block(
            name=f"payload {mass:g} kg",
            reason="another load at the same angles: parts load from angle, and load from friction",
            steps=(short_series(limits, payload=mass),),
        )
        for mass in limits.payloads
    )
