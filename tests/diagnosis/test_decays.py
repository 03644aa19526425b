"""Causes that are one fall of friction are told as one."""

from dataclasses import replace

import pytest

from frictioncli.diagnosis.search.decays import with_one_decay
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_standing import cause


@pytest.fixture(scope="module")
def runs():
    """Two runs, and the first alone."""
    both = problem(1)
    return both, both.part(both.layout.run[both.layout.row_pair] == 0)


def of(name, coefficient, visible, **shape):
    shape = shape or {axis.name: axis.at(0.5) for axis in BY_NAME[name].shape}
    return replace(cause(BY_NAME[name], (coefficient,), (0.01,), shape=shape), visible=visible)


@pytest.mark.parametrize(
    ("smaller", "visible", "names"),
    [
        (("drift", -1.0), 0.5, ["run_in", "drift"]),
        (("drift", -1.0), 0.3, ["run_in"]),
        (("step_change", -1.0), 0.5, ["run_in", "step_change"]),
    ],
)
def test_what_falls_beside_running_in_is_a_part_of_it_or_the_cause(runs, smaller, visible, names):
    _, one_run = runs
    shape = {"moment": 0.2, "end": 1.0} if smaller[0] == "step_change" else {}
    ran_in, other = of("run_in", 2.0, 1.0), of(*smaller, visible, **shape)
    first, second = with_one_decay([ran_in, other], one_run)
    assert list(first.effects) == names
    assert sum(first.probabilities.values()) == pytest.approx(1.0)
    assert first.probabilities["run_in"] == pytest.approx(1 / (1 + visible * (visible > 1 / 3)))
    assert (first.standing, second.standing) == (ran_in.standing, "undetermined")
    # the larger one keeps its name, whichever it is
    first, second = with_one_decay([of("run_in", 2.0, 1.0), replace(other, visible=1.5)], one_run)
    assert (first.standing, set(second.effects)) == ("undetermined", {"run_in", smaller[0]})


def test_what_does_not_only_fall_is_another_cause(runs):
    two_runs, one_run = runs
    ran_in = of("run_in", 2.0, 1.0)
    for other in (
        of("drift", 1.0, 0.5),
        of("step_change", 1.0, 0.5, moment=0.2, end=1.0),
        of("step_change", -1.0, 0.5, moment=0.1, end=0.2, moment_2=0.3, end_2=1.0),
        of("coulomb_temperature", -1.0, 0.5),
    ):
        assert with_one_decay([ran_in, other], one_run) == (ran_in, other)
    falling = of("drift", -1.0, 0.5)
    # a second run tells way from time; and nothing says that a drift is a decay by itself
    assert with_one_decay([ran_in, falling], two_runs) == (ran_in, falling)
    assert with_one_decay([falling], one_run) == (falling,)
