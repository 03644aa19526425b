"""One step of the search: the test of each hypothesis, and its p-value on fresh noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.fit.columns import base_rows, residual_of_base
from frictioncli.diagnosis.fit.hypotheses import EffectFit, hypothesis_of
from frictioncli.diagnosis.search.axis_columns import axis_columns, friction_tells_load
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.effect_size import left_size, rms_size
from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.model.friction import FrictionParameters, friction_torque
from tests.diagnosis.dense_noise import days, problem
from tests.diagnosis.wave_effects import A, B, C, effect, wave
from tests.equation_16 import TRUTH

DRIFTS = ({"drift": 0.2}, {"drift": 0.6, "drift_time": 120.0}, {"drift": 1.0, "drift_time": 9000.0})
TESTED = (
    "linear_viscous",
    "coulomb_temperature",
    "load_linear",
    "drift",
    "thermal_lag",
    "dress_pack",
)


def run_tests(data, names, discrepancy=0.01):
    precomputed = Precomputed.of(data, discrepancy=discrepancy)
    step = Step.of(precomputed, [])
    catalogue = Catalogue.of(precomputed, [hypothesis_of(BY_NAME[name], data) for name in names])
    return step, step.tested(catalogue)


def alone(step, *effects, shapes=None):
    """Return the catalogue of these effects, over their grids or at given shapes."""
    return Catalogue.of(
        step.precomputed, [hypothesis_of(one, step.problem, shapes) for one in effects]
    )


@pytest.mark.long
def test_noise_passes_no_more_often_than_its_p_values_say():
    """30 problems with three kinds of drift, six effects each."""
    least, single = [], []
    for seed in range(30):
        _, found = run_tests(problem(seed, **DRIFTS[seed % 3]), TESTED)
        least.append(min(one.p_value for one in found.values()))
        single += [one.null.p_value(one.statistic) for one in found.values()]
    # of 30 at 5 % and 20 %: more than 5 and 12 have chances of 0.3 and 0.3 %
    assert np.sum(np.array(least) < 0.05) <= 5
    assert np.sum(np.array(least) < 0.2) <= 12
    # 180 that are not independent: twice the standard deviation is about 5 %
    assert np.mean(np.array(single) < 0.05) < 0.1


@pytest.mark.long
def test_noise_has_no_structure_beyond_chance():
    """The least of fifteen p-values, in 4 problems."""
    least = []
    for seed in range(4):
        data = problem(seed, **DRIFTS[seed % 3])
        found = structures(Step.of(Precomputed.of(data), []))
        likely = [one.statistic for one in found if one.axes[0] != "load"]
        assert likely == sorted(likely, reverse=True)
        assert {len(one.axes) for one in found} == {1, 2}
        assert all(one.interval[0] <= one.size <= one.interval[1] for one in found)
        least.append(min(one.p_value for one in found))
    assert np.sum(np.array(least) < 0.05) <= 1


def one_value(column, value):
    """Return two days of a joint with 1.5 N·m of ripple, at one speed or temperature."""
    parameters = FrictionParameters(**TRUTH)

    def friction(of):
        load = 95.0 * np.cos(np.radians(of["position"]))
        return friction_torque(
            parameters, load=load, speed=of["speed"], temperature=of["motor_temperature"]
        )

    rows = days(1)
    same = rows.assign(**{column: value})
    ripple = 1.5 * np.sin(2 * np.radians(rows["position"]))
    same["friction_torque"] += friction(same) - friction(rows) + ripple
    return simulated(same, "motor", parameters, np.array([95.0, 0.0, 0.0]))[1]


@pytest.mark.parametrize(
    ("column", "value", "axis"),
    [("speed", 24.955, "speed"), ("motor_temperature", 31.0, "temperature")],
)
def test_structure_is_never_along_an_axis_of_one_value(column, value, axis):
    """At one speed angle and speed are one axis, the angle."""
    found = structures(Step.of(Precomputed.of(one_value(column, value)), []))
    assert found[0].axes == ("position",)
    assert found[0].p_value < 1e-6
    assert all(axis not in one.axes for one in found)
    assert any("position" in one.axes and len(one.axes) == 2 for one in found)


def test_noise_of_a_measured_load_is_no_structure_along_it():
    """The misfit of a load that is measured is as noisy as the axis it would be drawn against."""
    rows = days(2)
    noise = np.random.default_rng(5).normal(0, 3.0, len(rows))
    rows["load_torque"] += noise
    gravity = np.array([95.0, 0.0, 0.0])
    data = simulated(
        rows.assign(load=rows["load_torque"]), "motor", FrictionParameters(**TRUTH), gravity
    )[1]
    assert data.has_load_channel
    in_load = [
        one for one in structures(Step.of(Precomputed.of(data), [])) if one.channel == "load"
    ]
    assert in_load
    assert min(one.p_value for one in in_load) > 1e-3


@pytest.mark.long
@pytest.mark.parametrize("every", [20, 32, 40])
def test_few_pairs_of_noise_have_no_structure(every):
    """16 to 32 pairs: indicators of speed and temperature are as many, and would fit them all."""
    for seed in range(6):
        data = problem(seed, every=every)
        found = structures(Step.of(Precomputed.of(data), []))
        assert min((one.p_value for one in found), default=1.0) > 1e-3


def test_structure_is_found_along_its_axes_with_its_size():
    """A ripple that grows with temperature is none of speed, and its mean over all is nothing."""
    data = problem(3)
    warm = (data.table.temperature - data.table.temperature.mean()) / 10.0
    torque = 0.8 * warm * np.sin(3 * np.radians(data.table.position))
    data = replace(data, friction=data.friction + torque)
    found = structures(Step.of(Precomputed.of(data), []))[0]
    assert (found.axes, found.channel) == (("position", "temperature"), "friction")
    assert found.axis == "angle and temperature"
    assert found.p_value < 1e-6
    rms = np.sqrt(np.mean(torque**2))
    # what the discrepancy may contribute is taken off
    assert 0.8 * rms < found.size < 1.1 * rms
    assert found.interval[0] < rms < found.interval[1]


@pytest.mark.parametrize(("drift", "found"), [(0.1, False), (3.0, True)])
def test_drift_beyond_what_any_joint_has_is_structure_along_the_time(drift, found):
    data = problem(5, drift=drift)
    structure = structures(Step.of(Precomputed.of(data), []))[0]
    named = structure.p_value < 1e-3 and structure.axes == ("time",)
    assert named is found
    if found:
        assert structure.channel == "friction"
        # of drift that is long compared with the run a part looks like a constant
        assert 0.3 * drift < structure.size < 1.5 * drift
        assert structure.interval[0] < structure.size < structure.interval[1]


@pytest.mark.parametrize("constant", [0.0, 2.5])
def test_a_peak_at_one_load_is_structure_along_the_load(constant):
    """Friction is the same for loads to either side, which no bump at an angle is.

    A constant of the load channel that does not load the gear shifts one side from the other.
    """
    data = problem(4)
    peak = 1.5 * np.exp(-np.square((np.abs(data.table.load) - 40.0) / 8.0))
    table = replace(data.table, load=data.table.load + constant)
    data = replace(data, friction=data.friction + peak, table=table)
    first = structures(Step.of(Precomputed.of(data), []))[0]
    assert (first.axes, first.channel) == (("load",), "friction")
    assert first.p_value < 1e-6


@pytest.mark.parametrize("angles", [(78.0,), (40.0, 56.0, 72.0, 88.0)])
def test_narrow_bumps_at_angles_are_structure_along_the_angle(angles):
    """One bump stands at a load to one side; those of a tooth that comes round, at any loads."""
    data = problem(4)
    away = np.subtract.outer(data.table.position, angles)
    bumps = 1.5 * np.sum(1 / (1 + (away / 3.0) ** 4), axis=1)
    first = structures(Step.of(Precomputed.of(replace(data, friction=data.friction + bumps)), []))[
        0
    ]
    assert (first.axes, first.channel) == (("position",), "friction")
    assert first.p_value < 1e-6


def test_where_each_load_is_at_one_angle_the_angle_is_stated():
    """An arm that is lifted over less than a quarter turn: no data tell one from the other."""
    data = problem(4)
    table = data.table
    angle = np.radians(table.position / 2.0)
    lifted = replace(data, table=replace(table, load=95.0 * np.cos(angle)))
    assert friction_tells_load(data)
    assert not friction_tells_load(lifted)
    assert (("load",), "friction") not in axis_columns(lifted)


def test_a_p_value_is_that_of_the_statistic_times_the_hypotheses():
    data = problem(2, friction=lambda rows: 0.1 * A(rows))
    _, many = run_tests(data, ["inertia", "load_linear", "drift"])
    for one in many.values():
        assert one.p_value == min(1.0, 3 * one.null.p_value(one.statistic))
    one = many["load_linear"]
    assert one.null.coefficients == one.freedom == 1
    # without a shape there is one try, and thousands of angle bins know the noise
    assert one.null.shapes == 1.0
    assert one.null.p_value(one.statistic) == pytest.approx(
        float(stats.chi2.sf(one.statistic, 1)), rel=0.2, abs=1e-3
    )
    assert many["drift"].null.shapes > 1.0


def test_an_effect_s_test_does_not_depend_on_the_other_hypotheses():
    data = problem(2, friction=lambda rows: 0.2 * A(rows))
    _, one = run_tests(data, ["load_linear"])
    _, many = run_tests(data, ["inertia", "load_linear", "drift"])
    assert many["load_linear"].statistic == pytest.approx(one["load_linear"].statistic, rel=1e-8)
    assert many["load_linear"].log_bayes_factor == pytest.approx(
        one["load_linear"].log_bayes_factor, abs=1e-9
    )


def test_a_test_can_do_without_some_hypotheses():
    data = problem(2)
    step = Step.of(Precomputed.of(data), [])
    catalogue = alone(step, *(BY_NAME[name] for name in ("inertia", "load_linear")))
    assert set(step.tested(catalogue, skip={"inertia"})) == {"load_linear"}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "channel"), [("load_linear", "friction"), ("dress_pack", "load")])
def test_a_size_is_the_torque_of_its_white_length(name, channel):
    """Planted with an RMS of ten white lengths the statistic is 100, and 1 by chance.

    Without a discrepancy: it would take what is planted for a part of its own.
    """
    one = BY_NAME[name]
    statistics = []
    for seed in range(12):
        step, _ = run_tests(problem(seed), [], discrepancy=0)
        shape = {axis.name: axis.at(0.5) for axis in one.shape}
        scale = step.tested(alone(step, one, shapes=[shape]), refitted=0)[name].size_scale
        column = getattr(step.problem.basis(one, shape), channel)[:, 0]
        planted = 10 * scale * column / np.sqrt(np.mean(np.square(column)))
        data = replace(step.problem, **{channel: getattr(step.problem, channel) + planted})
        step, _ = run_tests(data, [], discrepancy=0)
        statistics.append(step.tested(alone(step, one, shapes=[shape]))[name].statistic)
        assert scale > 0
    # one has a standard deviation of 20, their mean of 6
    assert np.mean(statistics) == pytest.approx(101, abs=24)


@pytest.mark.parametrize("name", ["load_linear", "linear_viscous", "run_in"])
def test_what_physics_forbids_explains_nothing(name):
    """Friction that falls where the effect can only add some; the base leaves 1.5 N·m of it."""
    one = BY_NAME[name]
    shape = {axis.name: axis.at(0.5) for axis in one.shape}
    clean = problem(4)
    column = clean.basis(one, shape).friction[:, 0]
    size = 1.5 / np.std(residual_of_base(clean, column, "friction"))
    forbidden, allowed = (
        run_tests(replace(clean, friction=clean.friction + sign * size * column), [name])[1][name]
        for sign in (-1.0, 1.0)
    )
    # the discrepancy of speed can take it too, at a price
    assert allowed.statistic > 10
    assert allowed.p_value < 1e-3
    assert allowed.coefficients[0] > 0
    assert forbidden.statistic < 0.2 * allowed.statistic
    assert forbidden.coefficients[0] >= 0
    if not one.shape:
        assert forbidden.coefficients[0] == 0.0
        assert forbidden.statistic < 1e-6
        assert forbidden.p_value == pytest.approx(1.0)
        assert forbidden.log_bayes_factor <= 0


@pytest.mark.slow
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
    ripple = BY_NAME["position_ripple"]
    coarse = found["position_ripple"]
    assert coarse.shape["order"] in (9.0, 9.5)
    fine = step.refined(coarse.effect_fit(ripple))
    assert fine.shape["order"] == pytest.approx(9.3, abs=0.03)
    assert fine.statistic > coarse.statistic
    sine, cosine, *second = fine.coefficients
    assert np.hypot(sine, cosine) == pytest.approx(1.0, rel=0.05)
    assert np.abs(second).max() < 0.1
    assert rms_size(step.precomputed, fine) == pytest.approx(1 / np.sqrt(2), rel=0.05)


def test_a_size_is_visible_as_far_as_the_base_cannot_take_it():
    """A constant torque with a wave on it: the base takes the constant."""
    only = effect("any", [(1.0, C), (3.0, lambda rows: np.ones_like(rows.position))])
    data = problem(6, friction=lambda rows: 2.0 * C(rows))
    precomputed = Precomputed.of(data)
    fit = EffectFit(only, {}, np.array([2.0]), np.array([[0.01]]), 1.0)
    assert rms_size(precomputed, fit) == pytest.approx(np.sqrt(2.0 + 36.0), rel=0.02)
    size, low, high = left_size(precomputed, fit)
    assert size == pytest.approx(np.sqrt(2.0), rel=0.1)
    # an error of 0.1 in a coefficient of 2, next to nothing of a discrepancy so rough, and a form
    # that is known to a twentieth
    away = 1.96 * np.hypot(0.05, 0.05)
    assert (low, high) == pytest.approx((size * (1 - away), size * (1 + away)), rel=0.02)


@pytest.mark.parametrize("seed", [11, 12, 13, 14])
def test_the_size_of_an_effect_of_another_form_is_in_its_interval(seed):
    """A ripple that is higher on one side by a fifth, and has three times the order, too."""
    generator = np.random.default_rng(seed)
    order, phase, more, bent = generator.uniform([7, 0, 0.1, 0.02], [12, 6.28, 0.3, 0.05])

    def real(rows):
        angle = np.radians(rows.position)
        pure = np.sin(order * angle + phase)
        return (1 + more * np.cos(angle)) * (pure + bent * np.sin(3 * order * angle + 1.0))

    data = problem(seed, friction=real)
    step, found = run_tests(data, ["position_ripple"])
    fit = step.refined(found["position_ripple"].effect_fit(BY_NAME["position_ripple"]))
    _, low, high = left_size(step.precomputed, fit)
    torque = real(data.table)
    both, base = np.concatenate([torque, 0 * torque]), np.vstack(base_rows(data))
    both = both - base @ np.linalg.lstsq(base, both, rcond=1e-12)[0]
    assert low < np.sqrt(np.mean(np.square(both)) * 2) < high
    assert high - low < 0.5 * high


def test_half_of_what_discrepancy_has_of_an_effect_s_form_is_in_its_interval():
    """By 2,000 draws of the discrepancy, as far as they are along the effect."""
    only = effect("any", [(1.0, wave(2.0, 0.3))])
    data = problem(6)
    precomputed = Precomputed.of(data)
    start = replace(precomputed.start, noise=(20, 0), between=(0.3, 0.01))
    fit = EffectFit(only, {}, np.array([2.0]), np.array([[1e-12]]), 1.0, start)
    size, low, high = left_size(precomputed, fit)
    torque = data.basis(only, {}).friction[:, 0]
    base = np.vstack(base_rows(data))
    torque = np.concatenate([torque, 0 * torque])
    torque = torque - base @ np.linalg.lstsq(base, torque, rcond=None)[0]
    unit = torque / np.sqrt(np.sum(torque**2))
    generator = np.random.default_rng(0)
    smooth = precomputed.discrepancy
    amplitude = np.repeat(np.exp(start.amplitude), smooth.widths.astype(int))
    # what the base takes of a function is orthogonal to what it leaves of the effect
    parts = zip(np.split(unit, 2), smooth.shown, strict=True)
    across = np.concatenate([one @ columns for one, columns in parts])
    random = 0.5 * across @ (amplitude[:, None] * generator.normal(size=(len(amplitude), 2000)))
    expected = np.std(random) / np.sqrt(len(torque) / 2)
    assert (high - low) / (2 * 1.96) == pytest.approx(np.hypot(expected, 0.05 * size), rel=0.06)
    assert (high + low) / 2 == pytest.approx(size, rel=0.01)


def test_accepted_effects_are_part_of_the_null_hypothesis():
    data = problem(7, friction=lambda rows: 1.0 * A(rows) + 1.0 * B(rows))
    first, second = effect("a", [(1.0, A)]), effect("b", [(1.0, B)])
    precomputed = Precomputed.of(data, discrepancy=0.0)
    before = Step.of(precomputed, [])
    step = Step.of(precomputed, [EffectFit(first, {}, np.array([1.0]), np.eye(1), 1.0)])
    assert step.known == before.known + 1
    found = step.tested(alone(step, first, second))
    assert found["a"].freedom == 0
    assert found["a"].statistic == 0.0
    assert found["b"].coefficients[0] == pytest.approx(1.0, rel=0.05)
    assert step.noise()[0].point < before.noise()[0].point
    assert step.fit.objective < before.fit.objective
    both = Step.of(
        precomputed, [EffectFit(one, {}, np.ones(1), np.eye(1), 1.0) for one in (first, second)]
    )
    assert both.fit.coefficients[before.known :] == pytest.approx([1.0, 1.0], rel=0.05)
