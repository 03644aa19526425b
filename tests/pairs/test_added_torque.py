"""What the motion of another joint adds, from bins before and after it."""

import numpy as np
import pytest

from frictioncli.pairs.added_torque import LEAST_MOVES, AddedByOthers

BINS, MOVES, EVERY = 12, 80, 60.0


def added(size, *, shared, noise=0.2, offset=0.3, seed=1, first=None):
    """Moves over the same bins, a minute apart, while friction falls; every third with others."""
    generator = np.random.default_rng(seed)
    move, angle = np.divmod(np.arange(MOVES * BINS), BINS)
    time = EVERY * move + 0.5 * angle
    friction = 60.0 * np.exp(-time / 3000.0) + 9.0 * np.cos(angle)
    noisy = noise * generator.normal(size=len(move)) + offset * generator.normal(size=MOVES)[move]
    moving = np.isin(move, shared) & (angle < 5)
    torque = friction + noisy + size * moving
    found = AddedByOthers()
    chosen = slice(first, None)
    found.add((angle[chosen],), time[chosen], torque[chosen], move[chosen], moving[chosen])
    return found


def test_what_others_add_is_found_though_friction_falls():
    found = added(1.5, shared=range(3, MOVES, 6)).size()
    assert found.low < 1.5 < found.high
    assert found.high - found.low < 0.8
    assert found.p_value < 1e-4
    assert found.moves == len(range(3, MOVES, 6))


def test_intervals_hold_the_truth_and_nothing_is_found_where_nothing_is_added():
    held = nothing = 0
    for seed in range(100):
        one = added(0.8, shared=range(3, MOVES, 6), seed=seed).size()
        held += one.low <= 0.8 <= one.high
        none = added(0.0, shared=range(3, MOVES, 6), seed=seed).size()
        nothing += none.p_value < 0.05
        assert none.low < 0.3
    assert held >= 88
    assert nothing <= 10


def test_few_moves_say_nothing():
    few = range(10, 10 + 5 * (LEAST_MOVES - 1), 5)
    assert added(5.0, shared=few).size() is None
    assert added(5.0, shared=[*few, 60]).size() is not None


def test_moves_without_equal_ones_before_and_after_are_not_compared():
    # the first ten moves have none before, and the gap of the last ten has no equal
    assert added(5.0, shared=range(10)).size() is None
    assert added(5.0, shared=range(40, 60)).size() is None


@pytest.mark.parametrize("key", [0, 1])
def test_only_equal_bins_are_compared(key):
    """Another direction has another torque: with it in the key nothing seems added."""
    move = np.repeat(np.arange(40), 2)
    direction = np.where(move % 4 < 2, 1, -1)
    time, moving = EVERY * move, move % 8 == 4
    found = AddedByOthers()
    found.add((direction * key,), time.astype(float), 10.0 * direction, move, moving)
    assert (found.size().value > 5.0) is (key == 0)
