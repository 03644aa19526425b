"""Causes that are one fall of friction are told as one."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.search.decays import with_one_decay, without_slow_recovery
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


def test_what_stands_out_and_is_too_small_for_a_name_may_be_the_cause_of_the_fall(runs):
    _, one_run = runs
    falling = of("drift", -1.0, 1.0)
    for visible, effects in ((0.5, {"drift", "run_in"}), (0.3, {"drift"})):
        ran_in = replace(of("run_in", 2.0, visible), standing="visible", reason="small")
        first, second = with_one_decay([falling, ran_in], one_run)
        assert (first.standing, set(first.effects)) == ("named", effects)
        assert second is ran_in
    # nothing has a name: nothing is told
    nameless = replace(falling, standing="visible", reason="small")
    assert with_one_decay([nameless, ran_in], one_run) == (nameless, ran_in)


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


@pytest.mark.parametrize(
    ("duration", "time_constant", "is_named"),
    [
        # 20 pairs a minute apart, as grease takes; twice as many; a gear that is slower by far
        (1200.0, 600.0, True),
        (2400.0, 600.0, False),
        (2400.0, 7200.0, True),
        (4800.0, 7200.0, False),
    ],
)
def test_friction_after_rests_that_decays_as_the_gear_warms_may_be_its_lag(
    runs, duration, time_constant, is_named
):
    hidden = HiddenTemperature.of(time_constant, (1.0, 5.0, 0.0, 0.0), 1000.0)
    joint = replace(runs[0], hidden=hidden)
    clock, run, pair = (np.asarray(getattr(joint.table, one)) for one in ("clock", "run", "pair"))
    spans = [np.ptp(clock[run == one]) / np.ptp(pair[run == one]) for one in np.unique(run)]
    lag = of("thermal_lag", 1.0, 2.0)
    slow = of("rest_recovery", 2.0, 1.0, pairs=duration / np.mean(spans), rest_time=3600.0)
    lag = replace(lag, fit=replace(lag.fit, coefficients=np.zeros(4)))
    judged = without_slow_recovery([lag, slow], joint)
    assert judged[0] is lag
    assert judged[1].standing == (slow.standing if is_named else "undetermined")
    # without a lag, or about the measured temperature, nothing else decays so
    assert without_slow_recovery([slow], joint) == (slow,)
    assert without_slow_recovery([lag, slow], runs[0]) == (lag, slow)
