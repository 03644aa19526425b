"""Runs whose friction is many times that of the others are told when torques are separated."""

import pytest

from frictioncli.pairs.separation import HalfDifferences
from frictioncli.stages.separate import _of_other_scale


@pytest.mark.parametrize(
    ("means", "told"),
    [
        ({"day1": 5.0, "day2": 52.0, "day3": 5.2}, [("day2", "10 times higher")]),
        ({"day1": -5.0, "day2": 0.5, "day3": -5.2}, [("day2", "10 times lower")]),
        # of two the first is the usual one
        ({"day1": 5.0, "day2": 50.0}, [("day2", "10 times higher")]),
        # warm and cold, slow and fast
        ({"day1": 5.0, "day2": 15.0, "day3": 6.0}, []),
        ({"day1": 5.0}, []),
    ],
)
def test_friction_of_a_run_of_another_unit(means, told):
    runs = {name: HalfDifferences(40, mean, 1.0) for name, mean in means.items()}
    texts = list(_of_other_scale({2: runs}))
    assert len(texts) == len(told)
    for text, (run, times) in zip(texts, told, strict=True):
        assert text.startswith(f"joint 2: warning: friction of run {run} is {times}")


def test_a_few_pairs_are_not_compared():
    runs = {name: HalfDifferences(5, mean, 1.0) for name, mean in (("a", 1.0), ("b", 20.0))}
    assert not list(_of_other_scale({1: runs}))
