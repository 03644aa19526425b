"""Structure along time: drift that is, or surely was, more than any joint has."""

import numpy as np
import pytest

from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from tests.diagnosis.dense_noise import problem

FRICTION = 53.0
"""Mean friction of the joint. [N·m]"""


def along_time(amplitude, period):
    """Return the structure of friction along time, of a joint whose friction oscillates."""

    def oscillating(rows):
        return amplitude * np.sin(2 * np.pi * rows.time / period)

    step = Step.of(Precomputed.of(problem(5, friction=oscillating)), [])
    (found,) = (
        one for one in structures(step) if (one.axes, one.channel) == (("time",), "friction")
    )
    return found


@pytest.mark.parametrize("period", [900.0, 1800.0])
def test_friction_that_oscillates_by_more_than_any_joint_drifts_is_structure(period):
    found = along_time(0.031 * FRICTION, period)
    # a sine's RMS, of which the base takes a part
    assert 0.015 * FRICTION < found.interval[0] < found.size < 0.031 / np.sqrt(2) * FRICTION
    assert found.p_value < 1e-3


@pytest.mark.parametrize("period", [900.0, 1800.0])
def test_friction_that_oscillates_by_less_is_drift(period):
    found = along_time(0.02 * FRICTION, period)
    assert found.interval[0] < 0.015 * FRICTION
    assert found.p_value == 1.0


@pytest.mark.parametrize("seed", range(4))
def test_pairs_that_scatter_more_than_any_joint_drifts_have_no_structure_along_time(seed):
    def scattered(rows):
        moment, pair = np.unique(rows.time, return_inverse=True)
        return np.random.default_rng(seed).normal(0.0, 0.06 * FRICTION, len(moment))[pair]

    found = structures(Step.of(Precomputed.of(problem(5, friction=scattered)), []))
    assert all(one.p_value > 5e-3 for one in found if one.axes == ("time",))
