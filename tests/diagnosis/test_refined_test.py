"""The p-value of an effect whose shape lies between those of the grid."""

from dataclasses import replace
from math import comb

import numpy as np
import pytest
from scipy import stats

from frictioncli.diagnosis.fit.hypotheses import hypothesis_of
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.refined_test import refined_test
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.effects.pair_series import measured_share
from tests.diagnosis.dense_noise import problem

STEP = BY_NAME["step_change"]
COARSE = [{"moment": moment, "end": 1.0} for moment in (0.2, 0.4, 0.6, 0.8)]


def both_tests(data, effect=STEP, shapes=COARSE):
    """Return the test of an effect over a grid, and the same after its shape is refined."""
    step = Step.of(Precomputed.of(data), [])
    catalogue = Catalogue.of(step.precomputed, [hypothesis_of(effect, data, shapes)])
    grid = step.tested(catalogue)[effect.name]
    fit = step.refined(grid.effect_fit(effect))
    return grid, fit, refined_test(data, grid, fit, 1)


def stepped(size, seed=0):
    """Return noise with a step half-way between two moments of the grid."""
    data = problem(seed)
    later = measured_share(data.all_runs)[data.rows] >= 0.3
    return replace(data, friction=data.friction + size * later)


def test_step_between_two_moments_counts_by_its_own_evidence():
    data = stepped(4.0)
    grid, fit, refined = both_tests(data)
    pairs = len(np.unique(measured_share(data.all_runs)[data.rows]))
    assert fit.shape["moment"] == pytest.approx(0.3, abs=1.5 / pairs)
    ratio = grid.null.freedom * np.expm1(fit.statistic / grid.null.freedom)
    alone = stats.f.sf(ratio, 1, grid.null.freedom)
    assert refined.p_value == pytest.approx(10 * 2 * comb(pairs - 1, 1) * alone, rel=1e-6)
    assert refined.p_value < 1e-3 * grid.p_value
    assert refined.log_bayes_factor > grid.log_bayes_factor


def test_where_the_grid_has_the_shape_its_p_value_stays():
    data = stepped(4.0)
    grid, _, refined = both_tests(data, shapes=[{"moment": 0.3, "end": 1.0}])
    assert refined.p_value == grid.p_value


def test_step_before_a_pair_that_the_grid_leaves_out_is_found():
    """320 pairs of a run, each a series by itself: about every third is tried."""
    data = problem(0, every=1)
    alone = replace(data.all_runs, order=np.zeros_like(data.all_runs.order))
    data = replace(data, all_runs=alone)
    share = measured_share(data.all_runs)[data.rows]
    moments = {shape["moment"] for shape in hypothesis_of(STEP, data).shapes}
    between = [one for one in np.unique(share) if one not in moments]
    begins = between[len(between) // 10]
    data = replace(data, friction=data.friction + 1.0 * (share >= begins))
    found = find_causes(data, [STEP, BY_NAME["drift"]], DiagnosisSettings(), 0.1).causes
    assert [one.fit.effect.name for one in found] == ["step_change"]
    assert found[0].fit.shape["moment"] == pytest.approx(begins)
    assert found[0].test.p_value < 1e-6


@pytest.mark.long
def test_noise_passes_no_more_often_than_the_p_value_says():
    least = np.array([both_tests(problem(seed, drift=0.2))[2].p_value for seed in range(40)])
    # of 40 at 20 %: more than 14 has a chance of 1 %
    assert np.sum(least < 0.2) <= 14
    assert np.sum(least < 0.02) <= 4
