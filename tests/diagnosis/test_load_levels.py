"""Pairs that carry another load are two groups, whenever they come."""

import numpy as np
import pytest

from frictioncli.diagnosis.data.load_levels import two_level_history
from frictioncli.diagnosis.fit.hypotheses import informative_shapes
from frictioncli.effects import BY_NAME
from frictioncli.effects.history import stretches
from tests.diagnosis.dense_noise import problem

PAIRS = 80
"""Of two days."""


def number(rows):
    """Return the number of each row's pair on both days."""
    return rows.groupby(["run", "pair"], sort=False).ngroup().to_numpy()


def with_load(amount):
    """Return the problem of two days with a mass of so much torque in each pair [N·m]."""

    def load(rows):
        return amount[number(rows)] * np.cos(np.radians(rows["position"] + 20.0))

    return problem(2, load=load)


def test_recordings_that_carry_a_load_in_turns_are_told():
    there = np.arange(PAIRS) // 10 % 2 == 1
    found = two_level_history(with_load(5.0 * there))
    expected = [(begin / PAIRS, (begin + 10) / PAIRS) for begin in range(10, PAIRS, 20)]
    assert stretches(found) == expected
    # a load that is there at first is one that is taken off
    assert two_level_history(with_load(5.0 * ~there)) == found
    # both are tried first, where the load is in question
    data = with_load(5.0 * there)
    assert informative_shapes(BY_NAME["payload_change"], data)[0] == found
    assert found not in informative_shapes(BY_NAME["step_change"], data)


def test_a_load_in_every_other_pair_is_told_however_many_pairs_there_are():
    def load(rows):
        return 5.0 * (number(rows) % 2) * np.cos(np.radians(rows["position"] + 20.0))

    data = problem(2, load=load, every=4)
    pairs = len(data.layout.time)
    assert pairs > 2 * PAIRS - 2
    expected = [(begin / pairs, (begin + 1) / pairs) for begin in range(1, pairs, 2)]
    np.testing.assert_allclose(stretches(two_level_history(data)), expected)


@pytest.mark.parametrize(
    "amount",
    [
        np.zeros(PAIRS),
        # gradual, up and down, as what goes with temperature
        10.0 * np.sin(np.arange(PAIRS) / 6.0),
        np.linspace(0.0, 20.0, PAIRS),
        # a single stretch has its own histories
        5.0 * (np.arange(PAIRS) >= 30),
        # two odd pairs are no group
        20.0 * np.isin(np.arange(PAIRS), [20, 50]),
    ],
)
def test_what_changes_gradually_or_once_is_no_load_in_turns(amount):
    assert two_level_history(with_load(amount)) is None
