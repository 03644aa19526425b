"""How often noise alone is significant, effect by effect, on joints with nothing hidden."""

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import hypothesis_of
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem

EFFECTS = (
    "load_linear",
    "coulomb_temperature",
    "position_ripple",
    "drift",
    "stribeck",
    "step_change",
    "dress_pack",
)
"""Without a shape, and with searches over orders, velocities, times and histories."""


def p_values(every, discrepancy, worlds):
    """Return the p-value of each effect for itself, corrected for its shapes.

    Parameters
    ----------
    every : int
        Every how many degrees there are four pairs: 8 and 40 give 80 and 16 pairs.
    discrepancy : float
        Expected discrepancy, as a share of the friction; there is none.
    worlds : int
        Number of joints.
    """
    found = []
    for seed in range(worlds):
        data = problem(1000 + seed, every=every)
        step = Step.of(Precomputed.of(data, discrepancy=discrepancy), [])
        catalogue = Catalogue.of(
            step.precomputed, [hypothesis_of(BY_NAME[name], data) for name in EFFECTS]
        )
        tests = step.tested(catalogue, refitted=2 * len(EFFECTS))
        found.append([tests[name].null.p_value(tests[name].statistic) for name in EFFECTS])
    return np.array(found)


@pytest.mark.long
@pytest.mark.parametrize("every", [8, 40])
def test_five_per_cent_are_five_per_cent(every):
    """100 joints without a discrepancy expected; drift of 20 min is estimated with each rival."""
    shares = np.mean(p_values(every, 0.0, 100) < 0.05, axis=0)
    assert 0.01 < np.mean(shares) < 0.07
    # of 100 at 7 % more than 15 have a chance of 0.2 %
    steps = EFFECTS.index("step_change")
    assert np.delete(shares, steps).max() <= 0.15
    # a step at any of many moments resembles the drift that is estimated beside it
    assert shares[steps] <= 0.25


@pytest.mark.long
@pytest.mark.parametrize("every", [8, 40])
def test_a_discrepancy_that_is_not_there_makes_tests_stricter(every):
    found = p_values(every, 0.01, 60)
    assert np.mean(found < 0.05) < 0.05
    # smooth effects are what a discrepancy would do
    for name in ("load_linear", "coulomb_temperature", "stribeck"):
        assert np.mean(found[:, EFFECTS.index(name)] < 0.05) <= 0.02


@pytest.mark.long
def test_sixteen_pairs_of_noise_give_no_finding_often():
    """12 joints of 16 pairs: the least p-value of seven effects, corrected for their number."""
    least = len(EFFECTS) * p_values(40, 0.01, 12).min(axis=1)
    assert np.sum(least < 0.05) <= 2
