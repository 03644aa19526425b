"""The selection of blocks, against all sequences."""

import pytest

from frictioncli.design.blocks import Block
from frictioncli.design.selection import choose_blocks, seconds_of, steps_of
from frictioncli.design.steps import (
    PAYLOAD_CHANGE,
    RestStep,
    SeriesStep,
)


def _rest_block(name, seconds):
    return Block(name=name, reason="", steps=(RestStep(seconds),))


def test_the_choice_finds_the_best_programme_of_all():
    """Against all sequences: what counts is the number of distinct rests, and their total."""
    candidates = [
        _rest_block("a", 100.0),
        _rest_block("b", 170.0),
        _rest_block("c", 230.0),
        _rest_block("d", 60.0),
    ]

    def criterion(steps):
        return 100.0 * len({step.seconds for step in steps}) + sum(s.seconds for s in steps)

    budget = 500.0
    best, sequences = 0.0, [()]
    while sequences:
        grown = []
        for one in sequences:
            best = max(best, criterion(steps_of(one)))
            grown += [
                (*one, block)
                for block in candidates
                if one.count(block) < 4 and seconds_of((*one, block), None) <= budget
            ]
        sequences = grown
    found = choose_blocks(candidates, criterion, budget, None, 0)
    assert seconds_of(found, None) <= budget
    assert criterion(steps_of(found)) == pytest.approx(best)


def test_a_payload_costs_the_time_to_mount_it():
    block = Block(
        name="p",
        reason="",
        steps=(SeriesStep(speeds=(50.0,), low=0.0, high=100.0, payload=5.0),),
    )
    assert seconds_of([block, block], 0.0) == pytest.approx(2 * block.seconds + PAYLOAD_CHANGE)
    assert seconds_of([block], 5.0) == pytest.approx(block.seconds)
