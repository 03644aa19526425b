"""The smallest size of an effect that is named: expected statistics against planted effects."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import hypothesis_of
from frictioncli.diagnosis.search import detectable_size as module
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.detectable_size import Needed, detectable_size, noncentrality
from frictioncli.diagnosis.search.effect_size import left_share
from frictioncli.diagnosis.search.planted_fit import PlantedFit
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.standing import with_standing
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, EFFECTS
from tests.diagnosis.dense_noise import problem

MARGIN = 0.1
LEVEL = 0.05 / 26


def step_of(data, discrepancy=0.0075):
    return Step.of(Precomputed.of(data, discrepancy=discrepancy), [])


def the_test(step, name):
    effect = BY_NAME[name]
    catalogue = Catalogue.of(step.precomputed, [hypothesis_of(effect, step.problem)])
    return step.tested(catalogue)[name]


def planted(data: Problem, name, shape, size, missed=0.0, seed=0):
    """Return a problem with an effect in its data, and noise of its form from pair to pair."""
    basis = data.basis(BY_NAME[name], shape)
    columns = getattr(basis, BY_NAME[name].channel)[:, 0]
    scale = size / np.sqrt(np.mean(np.square(columns)))
    factor = 1 + missed * np.random.default_rng(seed).standard_normal(len(data.layout.time))
    factor = factor[data.layout.row_pair]
    return replace(
        data,
        friction=data.friction + scale * factor * basis.friction[:, 0],
        load=data.load + scale * factor * basis.load[:, 0],
    )


def middle(name):
    return {axis.name: axis.at(0.5) for axis in BY_NAME[name].shape}


@pytest.mark.parametrize("name", ["load_linear", "dress_pack"])
def test_a_small_size_has_its_squared_white_length_as_statistic(name):
    """By noncentral chi squared, as long as neither noise nor discrepancy takes a part of it."""
    step = step_of(problem(0), discrepancy=0)
    shape = middle(name)
    alone = Catalogue.of(step.precomputed, [hypothesis_of(BY_NAME[name], step.problem, [shape])])
    scale = step.tested(alone, refitted=0)[name].size_scale
    one = PlantedFit.of(step, BY_NAME[name], shape)
    assert one.expected(0.0).statistic == pytest.approx(0.0, abs=0.5)
    assert one.expected(6 * scale).statistic == pytest.approx(36, rel=0.15)


@pytest.mark.parametrize(
    ("name", "size"), [("load_linear", 3.0), ("step_change", 0.6), ("dress_pack", 2.0)]
)
def test_the_expected_statistic_is_that_of_the_effect_in_the_data(name, size):
    """The effect is added to the torques, and everything is fitted again."""
    shape = {"moment": 0.4, "end": 1.0} if name == "step_change" else middle(name)
    expected, found = [], []
    for seed in range(4):
        data = problem(seed, drift=0.2)
        expected.append(PlantedFit.of(step_of(data), BY_NAME[name], shape).expected(size).statistic)
        step = step_of(planted(data, name, shape, size, missed=0.05, seed=seed))
        found.append(step.fitted(BY_NAME[name], shape).statistic)
    assert np.mean(found) == pytest.approx(np.mean(expected), rel=0.25)


def test_drift_takes_a_slow_effect_the_more_the_larger_it_is():
    """Four times the statistic at twice the size is what fixed variances would give."""
    data = problem(1, drift=0.6, drift_time=9000.0)
    one = PlantedFit.of(step_of(data), BY_NAME["drift"], middle("drift"))
    small, large = (one.expected(size).statistic for size in (4.0, 8.0))
    assert 0 < large < 3 * small


def test_needed_statistic_and_margin():
    """By the definition of the power, and nothing below the margin."""
    for freedom in (1, 3):
        value = noncentrality(20.0, freedom)
        assert stats.ncx2.sf(20.0, freedom, value) == pytest.approx(0.8, abs=1e-6)
    step = step_of(problem(0))
    effect = BY_NAME["position_ripple"]
    test = the_test(step, effect.name)
    change = BY_NAME["step_change"]
    sizes = [detectable_size(step, effect, test, LEVEL, margin) for margin in (MARGIN, 10 * MARGIN)]
    assert MARGIN < sizes[0] < 2 * MARGIN
    assert 10 * MARGIN < sizes[1] < 20 * MARGIN
    # a change needs a p-value fifty times smaller
    single = replace(test, freedom=1, null=replace(test.null, coefficients=1, shapes=1.0))
    asked = [Needed.of(step, one, single, LEVEL, MARGIN) for one in (effect, change)]
    assert asked[1].statistic > asked[0].statistic + 5
    assert detectable_size(step, effect, replace(test, freedom=0), LEVEL, MARGIN) is None


def test_what_would_be_impossible_has_no_size():
    """Ripple bounded to a tenth of the margin."""
    effect = BY_NAME["position_ripple"]
    bounded = tuple(
        replace(one, lower=-MARGIN / 10, upper=MARGIN / 10) for one in effect.coefficients
    )
    step = step_of(problem(0))
    test = the_test(step, effect.name)
    little = replace(effect, coefficients=bounded)
    assert detectable_size(step, little, test, LEVEL, MARGIN) is None


def test_no_size_is_claimed_where_the_base_leaves_no_more_than_a_form_misses(monkeypatch):
    """The base leaves a tenth of a load's amount; a form misses a twentieth, give or take two."""
    step = step_of(problem(0))
    effect = BY_NAME["load_linear"]
    test = the_test(step, effect.name)
    assert left_share(step.precomputed, effect, {}) == pytest.approx(0.1, abs=0.02)
    assert detectable_size(step, effect, test, LEVEL, MARGIN) is None
    monkeypatch.setattr(module, "FORM", 0.0)
    assert detectable_size(step, effect, test, LEVEL, MARGIN) > 10 * MARGIN


@pytest.mark.long
@pytest.mark.parametrize("name", ["load_temperature", "step_change", "position_ripple"])
def test_the_claimed_size_is_named_and_half_of_it_is_not(name):
    """The whole search on ten joints each, whose noise the claim has not seen."""
    settings = DiagnosisSettings()
    found = find_causes(problem(0, drift=0.2), EFFECTS, settings, MARGIN)
    claimed = found.detectable_sizes([BY_NAME[name]], settings.alpha, MARGIN)[name]
    shape = {"moment": 0.4, "end": 1.0} if name == "step_change" else middle(name)
    named = {}
    for factor in (0.4, 1.5):
        named[factor] = 0
        for seed in range(1, 7):
            data = planted(
                problem(seed, drift=0.2), name, shape, factor * claimed, missed=0.05, seed=seed
            )
            causes = find_causes(data, EFFECTS, settings, MARGIN).causes
            judged = with_standing(causes, data, MARGIN, settings.alpha)
            named[factor] += any(one.standing == "named" and name in one.effects for one in judged)
    assert named[1.5] >= 5
    assert named[0.4] <= 1
