"""One step of the search: null distributions, and the test of each hypothesis."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import EffectFit, hypothesis_of
from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.wave_effects import A, B, C, effect, wave

DRIFTS = ({"drift": 0.2}, {"drift": 0.6, "drift_time": 120.0}, {"drift": 1.0, "drift_time": 9000.0})
TESTED = (
    "linear_viscous",
    "coulomb_temperature",
    "load_linear",
    "drift",
    "thermal_lag",
    "dress_pack",
)


def run_tests(data, names, draws=0, seed=0):
    precomputed = Precomputed.of(data)
    step = Step.of(precomputed, [])
    catalogue = Catalogue.of(precomputed, [hypothesis_of(BY_NAME[name], data) for name in names])
    return step, step.tested(catalogue, seed, draws)


def test_noise_passes_no_more_often_than_its_p_values_say():
    """30 problems with three kinds of drift, six effects each."""
    least, single = [], []
    for seed in range(30):
        _, found = run_tests(problem(seed, **DRIFTS[seed % 3]), TESTED, draws=200, seed=seed)
        least.append(min(one.p_value for one in found.values()))
        single += [one.null.p_value(one.statistic) for one in found.values()]
    # of 30 at 5 % and 20 %: more than 5 and 12 have chances of 0.3 and 0.3 %
    assert np.sum(np.array(least) < 0.05) <= 5
    assert np.sum(np.array(least) < 0.2) <= 12
    # 180 that are not independent: twice the standard deviation is about 5 %
    assert np.mean(np.array(single) < 0.05) < 0.1
    assert 0.25 < np.mean(np.array(single) < 0.5) < 0.65


BOTH_WAYS = ("linear_viscous", "load_linear", "direction_asymmetry", "dress_pack")


@pytest.mark.slow
def test_draws_give_what_fresh_noise_gives():
    """Mean of 100 statistics beside that of the draws; more than a quarter above is an error.

    Friction goes with the square of the load, so what a spring does to gravity shows in friction
    too, and shapes that are alike in the load channel alone are several tries.
    """
    data = problem(20)
    pair, count = data.layout.row_pair, len(data.layout.time)
    gravity = data.load_base @ data.gravity
    generator = np.random.default_rng(21)

    def noisy():
        means, rows = generator.normal(size=(2, count)), 0.3 * generator.normal(size=(2, len(pair)))
        return replace(
            data,
            friction=data.table.friction + 0.3 * means[0][pair] + rows[0],
            load=gravity + 0.1 * means[1][pair] + rows[1],
        )

    _, tests = run_tests(noisy(), BOTH_WAYS, draws=1000)
    fresh = [run_tests(noisy(), BOTH_WAYS)[1] for _ in range(100)]
    for name, one in tests.items():
        drawn = one.null.shape * one.null.scale
        assert np.mean([found[name].statistic for found in fresh]) < 1.25 * drawn, name


def test_noise_has_no_structure_beyond_chance():
    """The least of fifteen p-values, in 4 problems."""
    least = []
    for seed in range(4):
        data = problem(seed, **DRIFTS[seed % 3])
        step = Step.of(Precomputed.of(data), [])
        found = structures(step, seed)
        assert found == sorted(found, key=lambda one: one.p_value)
        least.append(found[0].p_value)
    assert np.sum(np.array(least) < 0.05) <= 1


def test_without_draws_all_p_values_are_one():
    _, found = run_tests(problem(0, friction=lambda rows: 3.0 * A(rows)), ["position_ripple"])
    assert found["position_ripple"].p_value == 1.0
    assert found["position_ripple"].statistic > 1000


def test_an_effect_s_test_does_not_depend_on_the_other_hypotheses():
    data = problem(2, friction=lambda rows: 0.05 * A(rows))
    _, alone = run_tests(data, ["load_linear"], draws=50)
    _, many = run_tests(data, ["inertia", "load_linear", "drift"], draws=50)
    assert many["load_linear"].statistic == pytest.approx(alone["load_linear"].statistic, abs=1e-9)
    assert many["load_linear"].log_bayes_factor == pytest.approx(
        alone["load_linear"].log_bayes_factor, abs=1e-9
    )
    one = many["load_linear"]
    assert one.p_value == min(1.0, 3 * one.null.p_value(one.statistic))


def test_the_same_seed_gives_the_same_null_distribution():
    data = problem(3)
    first, again, other = (
        run_tests(data, ["drift", "inertia"], draws=40, seed=seed)[1]["inertia"].null
        for seed in (5, 5, 6)
    )
    assert first == again != other


@pytest.mark.parametrize(("name", "channel"), [("load_linear", "friction"), ("dress_pack", "load")])
def test_a_size_is_the_torque_of_its_white_length(name, channel):
    """Planted with an RMS of ten white lengths the statistic is 100, and 1 by chance."""
    effect = BY_NAME[name]
    statistics = []
    for seed in range(12):
        step, found = run_tests(problem(seed), [name])
        one = found[name]
        shape = {axis.name: axis.at(0.5) for axis in effect.shape}
        alone = Catalogue.of(step.precomputed, [hypothesis_of(effect, step.problem, [shape])])
        scale = step.tested(alone, 0, 0)[name].size_scale
        column = getattr(step.problem.basis(effect, shape), channel)[:, 0]
        planted = 10 * scale * column / np.sqrt(np.mean(np.square(column)))
        data = replace(step.problem, **{channel: getattr(step.problem, channel) + planted})
        precomputed = Precomputed.of(data)
        alone = Catalogue.of(precomputed, [hypothesis_of(effect, data, [shape])])
        statistics.append(Step.of(precomputed, []).tested(alone, 0, 0)[name].statistic)
        assert one.size_scale > 0
    # one has a standard deviation of 20, their mean of 6
    assert np.mean(statistics) == pytest.approx(101, abs=24)


@pytest.mark.parametrize("name", ["load_linear", "linear_viscous", "run_in"])
def test_what_physics_forbids_explains_nothing(name):
    """Friction that falls where the effect can only add some."""
    effect = BY_NAME[name]
    shape = {axis.name: axis.at(0.5) for axis in effect.shape}
    clean = problem(4)
    column = clean.basis(effect, shape).friction[:, 0]
    size = 1.5 / np.std(column)
    forbidden, allowed = (
        run_tests(replace(clean, friction=clean.friction + sign * size * column), [name], draws=50)[
            1
        ][name]
        for sign in (-1.0, 1.0)
    )
    assert allowed.statistic > 25
    assert allowed.p_value < 1e-3
    assert allowed.coefficients[0] > 0
    assert forbidden.statistic < 0.2 * allowed.statistic
    if not effect.shape:
        assert (forbidden.statistic, forbidden.p_value) == (0.0, 1.0)
        assert forbidden.log_bayes_factor < 0


def test_the_noise_of_a_step_is_that_of_the_data():
    """Rows 0.3, pair means of 0.25 and 0.2 in friction, 0.1 in load: medians of 9 problems."""
    noise = [Step.of(Precomputed.of(problem(seed)), []).noise() for seed in range(9)]
    for number, between in ((0, np.hypot(0.25, 0.2)), (1, 0.1)):
        point = np.median([one[number].point for one in noise])
        pair = np.median([np.hypot(one[number].pair, one[number].drift) for one in noise])
        assert point == pytest.approx(0.3, rel=0.03)
        assert pair == pytest.approx(between, rel=0.25)


def test_a_shape_is_refined_off_its_grid():
    """An order of 9.3 lies between 9 and 9.5 of the grid; amplitude 1 with a phase of 0.4."""
    data = problem(5, friction=wave(9.3, 0.4))
    step, found = run_tests(data, ["position_ripple"])
    effect = BY_NAME["position_ripple"]
    coarse = found["position_ripple"]
    assert coarse.shape["order"] in (9.0, 9.5)
    fine = step.refined(coarse.effect_fit(effect))
    assert fine.shape["order"] == pytest.approx(9.3, abs=0.03)
    assert fine.statistic > coarse.statistic
    sine, cosine, *second = fine.coefficients
    assert np.hypot(sine, cosine) == pytest.approx(1.0, rel=0.05)
    assert np.abs(second).max() < 0.1
    assert step.size(fine) == pytest.approx(1 / np.sqrt(2), rel=0.05)


def test_a_size_is_visible_as_far_as_the_base_cannot_take_it():
    """A constant torque with a wave on it: the base takes the constant."""
    only = effect("any", [(1.0, C), (3.0, lambda rows: np.ones_like(rows.position))])
    data = problem(6, friction=lambda rows: 2.0 * C(rows))
    step = Step.of(Precomputed.of(data), [])
    fit = EffectFit(only, {}, np.array([2.0]), np.eye(1), 1.0)
    assert step.size(fit) == pytest.approx(np.sqrt(2.0 + 36.0), rel=0.02)
    assert step.visible(fit) == pytest.approx(np.sqrt(2.0), rel=0.1)


def test_accepted_effects_are_part_of_the_base():
    data = problem(7, friction=lambda rows: 1.0 * A(rows) + 1.0 * B(rows))
    first, second = effect("a", [(1.0, A)]), effect("b", [(1.0, B)])
    precomputed = Precomputed.of(data)
    accepted = EffectFit(first, {}, np.array([1.0]), np.eye(1), 1.0)
    step = Step.of(precomputed, [accepted])
    assert step.base_count == Step.of(precomputed, []).base_count + 1
    both = Catalogue.of(precomputed, [hypothesis_of(one, data) for one in (first, second)])
    found = step.tested(both, 0, 0)
    assert found["a"].freedom == 0
    assert found["a"].statistic == 0.0
    assert found["b"].coefficients[0] == pytest.approx(1.0, rel=0.05)
    assert step.channels[0].point < Step.of(precomputed, []).channels[0].point
