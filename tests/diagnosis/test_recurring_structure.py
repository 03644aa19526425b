"""Structure that one day may owe to chance, and that another day has again."""

import numpy as np
import pytest

from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.recurring_structure import recurring_structure
from frictioncli.diagnosis.search.step import Step
from tests.diagnosis.dense_noise import problem


def peak(rows):
    """Friction that is a little higher about 40 deg/s."""
    return 1.5 * np.exp(-np.square(np.log(rows.speed / 40.0) / 0.3) / 2)


def nothing(rows):
    return np.zeros(len(rows))


@pytest.mark.parametrize(("before", "day", "recurs"), [(peak, peak, True), (peak, nothing, False)])
def test_what_is_there_on_both_days_is_told_although_one_alone_is_doubtful(before, day, recurs):
    seen, new = (
        Step.of(Precomputed.of(problem(seed, friction=friction)), [])
        for seed, friction in ((3, before), (4, day))
    )
    found = recurring_structure(seen, structures(new), 0.1)
    assert (found is not None) is recurs
    if found is not None:
        alone = structures(seen)[0]
        assert alone.p_value > 1e-3
        assert (found.axes, found.channel, found.size) == (("speed",), "friction", alone.size)
        assert found.p_value < 1e-4
