"""What comes back after a rest is seen to come back, or has only decayed."""

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.possible import is_seen_once
from frictioncli.effects import BY_NAME
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.torque_table import simulate_torques

NIGHT = 8 * 3600.0


@pytest.fixture(scope="module")
def torques():
    """Two days of a joint."""
    table = simulate_torques(SynthesisSettings(seed=3, runs=2, joint_kind="plain", highest=40))
    return table[table["position"] // 5 % 2 == 0]


def decay(name, **shape):
    values = np.ones(len(BY_NAME[name].coefficients))
    return EffectFit(BY_NAME[name], shape, values, np.eye(len(values)), 100.0)


def asleep(table):
    """Return the table with a night in the middle of each run."""
    later = table["time"] > table["time"].median()
    return table.assign(time=table["time"] + NIGHT * later)


def test_a_decay_without_a_rest_is_seen_once(torques):
    settled = decay("rest_recovery", pairs=20.0, rest_time=86_400.0, at_start=1.0)
    one_day = torques[torques["run"] == "day1"]
    assert is_seen_once(settled, build_problems(one_day, "motor")[0])


def test_what_is_back_after_a_rest_is_not(torques):
    back = decay("rest_recovery", pairs=20.0, rest_time=1_800.0, at_start=1.0)
    one_day = torques[torques["run"] == "day1"]
    assert not is_seen_once(back, build_problems(asleep(one_day), "motor")[0])
    # a second run begins with a rest
    assert not is_seen_once(back, build_problems(torques, "motor")[0])


def test_running_in_is_over_once(torques):
    one_day = torques[torques["run"] == "day1"]
    ran_in = decay("run_in", distance=20_000.0)
    assert not is_seen_once(ran_in, build_problems(one_day, "motor")[0])
