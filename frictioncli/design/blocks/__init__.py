"""The kinds of blocks that a programme is put together from, one file each."""

from frictioncli.design.block import Block, Variants
from frictioncli.design.blocks import (
    both_ends,
    even_speeds,
    heat,
    part_stroke,
    pause,
    payload,
    repeat,
    shuffled,
    sweep,
    travel,
)
from frictioncli.design.limits import Limits

KINDS: tuple[Variants, ...] = (
    repeat.variants,
    sweep.variants,
    shuffled.variants,
    even_speeds.variants,
    both_ends.variants,
    heat.variants,
    travel.variants,
    pause.variants,
    part_stroke.variants,
    payload.variants,
)
"""All kinds, in order."""


def all_blocks(limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return every block that may be chosen within limits."""
    return tuple(block for kind in KINDS for block in kind(limits, seed))
