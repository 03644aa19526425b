"""Sizes that are stated: those of plain least squares, with intervals that hold the truth."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import at_temperature
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.extension import extend
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import span_of
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.noise.discrepancy import discrepancy_of
from frictioncli.diagnosis.search.fitted_size import fitted_sizes
from frictioncli.diagnosis.search.measurement import beside_base, measurement_causes
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.stated_size import (
    _holding_found,
    sizes_beside_each_other,
    sizes_in_model,
    sizing_fit,
    span_at_measured,
)
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.thermal.refine import restricted
from frictioncli.effects import BY_NAME
from frictioncli.model.noise import Noise
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_standing import cause
from tests.diagnosis.wave_effects import A, B, effect
from tests.equation_16 import TRUTH, friction

DATA = problem(1)
SPAN = span_of(DATA)
SMOOTH = discrepancy_of(DATA, SPAN)
ROWS = len(DATA.friction)
POINT, PAIR = 0.3, 0.1
SHAPES = {
    "torque_constant": {},
    "direction_asymmetry": {"exponent": 1.0},
    "stribeck": {"velocity": 8.0, "exponent": 1.0, "shift": 0.0},
}


def fit_of(discrepancy):
    """Return the fit of all rows alike, beside so much discrepancy."""
    noise = Noise(point=POINT, pair=PAIR, drift=0.0, drift_time=100.0)
    weights = Weights.of(DATA.layout, noise, np.zeros(len(DATA.layout.time))).alike()
    return WeightedFit(weights, weights, () if discrepancy is None else (discrepancy,))


def torque_of(name, size):
    """Return an effect of so large an RMS, and its torque, friction above load."""
    effect, shape = BY_NAME[name], SHAPES[name]
    columns = np.vstack(DATA.basis(effect, shape))
    coefficients = np.ones(columns.shape[1])
    coefficients *= size / np.sqrt(np.sum(np.square(columns @ coefficients)) / ROWS)
    width = len(coefficients)
    return EffectFit(effect, shape, coefficients, np.eye(width), 99.0), columns @ coefficients


def stated(fit, both, discrepancy):
    """Return what is stated of an effect in a joint with so much torque beside the base."""
    friction, load = np.split(both, 2)
    gravity = DATA.load_base @ DATA.gravity
    joint = replace(DATA, friction=DATA.table.friction + friction, load=gravity + load)
    weighted_fit = fit_of(discrepancy)
    found = replace(cause(), fit=fit, effects=(fit.effect.name,))
    span = span_at_measured(joint, [])
    extension = extend(joint, weighted_fit, [fit])
    (one,) = fitted_sizes([found], extension, joint, weighted_fit, span)
    return one


def noise(generator):
    """Return noise of both channels: of points, and of pairs in the friction."""
    pairs = generator.normal(0, PAIR, (2, len(DATA.layout.time)))[:, DATA.layout.row_pair]
    return (pairs + generator.normal(0, POINT, (2, ROWS))).ravel()


@pytest.mark.parametrize("name", ["stribeck", "direction_asymmetry"])
def test_sizes_are_those_of_plain_least_squares(name):
    """Whatever the form of an effect misses: twice as much of it at one speed of four."""
    fit, torque = torque_of(name, 1.0)
    fastest = np.tile(DATA.table.speed > 0.8 * DATA.table.speed.max(), 2)
    both = torque * np.where(fastest, 2.0, 1.0) + noise(np.random.default_rng(2))
    one = stated(fit, both, None)
    base = np.vstack(base_rows(DATA))
    own = np.vstack(DATA.basis(fit.effect, fit.shape))
    columns = np.hstack([base, own])
    fitted = np.linalg.lstsq(columns, both, rcond=1e-12)[0][base.shape[1] :]
    left = own @ fitted - base @ np.linalg.lstsq(base, own @ fitted, rcond=1e-12)[0]
    assert one.visible == pytest.approx(np.sqrt(np.sum(left**2) / ROWS), rel=0.03)
    if len(fitted) == 1:
        assert one.size == pytest.approx(np.sqrt(np.sum((own @ fitted) ** 2) / ROWS), rel=0.03)
        low, high = one.size_interval
        assert low < one.size < high
    else:
        assert (one.size, one.size_interval) == (one.visible, one.visible_interval)


@pytest.mark.parametrize("name", ["torque_constant", "direction_asymmetry"])
def test_intervals_hold_what_is_left_beside_discrepancy(name):
    """Nineteen of twenty do, beside smooth errors of the model; without these few would."""
    fit, torque = torque_of(name, 1.0)
    true = np.sqrt(np.sum(np.square(torque - SPAN @ (SPAN.T @ torque))) / ROWS)
    columns = SMOOTH.torques(np.full(len(SMOOTH.components), np.log(SMOOTH.amplitude)))
    discrepancy = tuple(np.split(columns, 2))
    generator = np.random.default_rng(3)
    held = {True: 0, False: 0}
    for _ in range(25):
        smooth = columns @ generator.normal(size=columns.shape[1])
        both = torque + smooth + noise(generator)
        for counted in held:
            low, high = stated(fit, both, discrepancy if counted else None).visible_interval
            held[counted] += low <= true <= high
    assert held[True] >= 22
    assert held[False] < 20


def test_effects_of_the_measurement_keep_their_sizes():
    fit = EffectFit(BY_NAME["torque_delay"], {}, np.array([0.02]), np.array([[1e-6]]), 50.0)
    found = replace(cause(), fit=fit, effects=("torque_delay",))
    extension = extend(DATA, fit_of(None), [fit])
    assert fitted_sizes([found], extension, DATA, fit_of(None), SPAN) == (found,)


def test_what_may_be_below_the_margin_does_not_blur_the_others():
    """Beside one that is not there, and differs from it by a tenth, an effect of 0.28 N·m is known
    to ±0.13 N·m; without that one to ±0.03 N·m."""
    there, imitation = effect("there", [(1.0, A)]), effect("imitation", [(1.0, A), (0.1, B)])
    joint = problem(4, friction=lambda rows: 0.4 * A(rows))
    precomputed, fits = Precomputed.of(joint), []
    for one in (there, imitation):
        fits.append(Step.of(precomputed, fits).fitted(one, {}))
    step = Step.of(precomputed, fits)
    found = cause(interval=(0.0, 0.9))
    causes = [replace(found, fit=fit, effects=(fit.effect.name,)) for fit in fits]
    extension = extend(joint, step.predicting_fit(), fits)
    together = sizes_in_model(causes, extension, step, [], joint)
    kept, gone = sizes_beside_each_other(causes, step, [], joint, 0.2)
    assert [kept.fit.effect.name, gone.fit.effect.name] == ["there", "imitation"]
    assert gone == together[1]
    assert gone.visible_interval[0] < 0.2
    low, high = kept.visible_interval
    assert 0.2 < low < 0.4 / np.sqrt(2) < high
    assert high - low < 0.5 * np.subtract(*together[0].visible_interval[::-1])


def slow_and_fast(rows):
    """Return a wave of four hours, and a smaller one of ten minutes."""
    return np.sin(2 * np.pi * rows.time / 14400.0) + 0.4 * np.sin(2 * np.pi * rows.time / 600.0)


def drifting(rows, generator):
    """Return a drift of 0.6 N·m with a correlation time of an hour, anew in each run."""
    pairs = rows.groupby(["run", "pair"])["time"].mean()
    apart = np.abs(np.subtract.outer(pairs.to_numpy(), pairs.to_numpy()))
    run = pairs.index.get_level_values("run").to_numpy()
    covariance = 0.6**2 * np.exp(-apart / 3600.0) * np.equal.outer(run, run)
    drawn = np.linalg.cholesky(covariance) @ generator.normal(size=len(pairs))
    pair = rows.groupby(["run", "pair"]).ngroup().to_numpy()
    return drawn[pair]


def test_a_drift_leaves_a_lower_limit_of_a_size():
    """The slow wave may be drift, so that by all rows alike the size may be near zero.

    The fast one tells that it is more than 0.24 of 0.43 N·m.
    """
    waves = replace(effect("waves", [(1.0, slow_and_fast)]), needs=("time",))
    undetermined = 0
    for seed in range(6):
        generator = np.random.default_rng(seed)
        joint = problem(
            seed,
            friction=lambda rows, own=generator: 0.6 * slow_and_fast(rows) + drifting(rows, own),
            every=2,
        )
        torque = 0.6 * np.vstack(joint.basis(waves, {}))[:, 0]
        span = span_at_measured(joint, [])
        true = np.sqrt(np.sum(np.square(torque - span @ (span.T @ torque))) / len(joint.friction))
        precomputed = Precomputed.of(joint)
        fit = Step.of(precomputed, []).fitted(waves, {})
        step = Step.of(precomputed, [fit])
        found = replace(cause(), fit=fit, effects=("waves",))
        extension = extend(joint, step.predicting_fit(), [fit])
        (one,) = sizes_in_model([found], extension, step, [], joint)
        (alike,) = fitted_sizes(
            [found], extension, joint, sizing_fit(step, [], extension.effects), span
        )
        low, high = one.visible_interval
        assert 0.24 < low < true < high
        assert low <= one.visible <= high
        assert (alike.visible_interval[1], alike.visible_interval[0] <= low) == (high, True)
        undetermined += alike.visible_interval[0] < 0.24
    assert undetermined >= 3


def logged_late(rows, delay, time_constant):
    """Return what a delay and a filter add to friction and load, by their transfer function.

    Gravity is L cos q, and what it adds to friction a cosine of twice the angle.
    """
    turn, rate = np.radians(rows["position"]), np.radians(rows["speed"])
    gravity, bend = 95.0, TRUTH["alpha"] * 95.0**2 / 2
    first, second = (
        np.exp(-1j * n * rate * delay) / (1 + 1j * n * rate * time_constant) for n in (1, 2)
    )
    return (
        bend * np.cos(2 * turn) * (np.real(second) - 1) - gravity * np.sin(turn) * np.imag(first),
        gravity * np.cos(turn) * (np.real(first) - 1) - bend * np.sin(2 * turn) * np.imag(second),
    )


def inertial(position, speed, inertia, settling):
    """Return friction and load of a speed that settles exponentially after each reversal."""
    low, high = (
        inertia * np.radians(speed) / settling * np.exp(-distance / speed / settling)
        for distance in (position - 5.0, 175.0 - position)
    )
    return (low + high) / 2, (low - high) / 2


def sizes_of_inertia(settling, delay, time_constant):
    """Return the true size of an inertia behind a filter, and what is stated of it.

    Without effects of the measurement that were refused beside the base, and with them.
    """

    def added(rows, channel):
        ends = inertial(rows["position"], rows["speed"], 5.0, settling)
        return ends[channel] + logged_late(rows, delay, time_constant)[channel]

    joint = problem(1, friction=lambda rows: added(rows, 0), load=lambda rows: added(rows, 1))
    beside = beside_base(joint)
    assert "torque_filter" in {one.fit.effect.name for one in beside.refused}
    shape = {"distance": 40.0, "growth": 1.0}
    start = EffectFit(BY_NAME["inertia"], shape, np.ones(2), np.eye(2), 99.0)
    fit = Step.of(beside.precomputed, []).refined(start)
    step = Step.of(beside.precomputed, [fit])
    measurement = measurement_causes(step, beside.effects)
    found = [replace(cause(), fit=fit, effects=("inertia",))]
    extension = extend(joint, step.predicting_fit(), [fit])
    both = np.concatenate(inertial(joint.table.position, joint.table.speed, 5.0, settling))
    span = span_at_measured(joint, measurement)
    true = np.sqrt(np.sum(np.square(both - span @ (span.T @ both))) / len(joint.friction))
    (without,) = sizes_in_model(found, extension, step, measurement, joint)
    (one,) = sizes_in_model(found, extension, step, measurement, joint, beside.refused)
    return true, without, one


def test_inertia_may_hide_the_filter_beside_which_it_is_as_large():
    """Beside the base alone the filter looks impossible; the interval allows for it yet."""
    true, without, one = sizes_of_inertia(0.4, 0.018, 0.04)
    assert not without.visible_interval[0] < true < without.visible_interval[1]
    assert one.visible_interval[0] < true < one.visible_interval[1]
    assert one.visible == without.visible


def test_what_would_leave_a_cause_undetermined_does_not_count_in_its_interval():
    """Beside the filter this inertia may be 0: then the search has decided which is there."""
    _, without, one = sizes_of_inertia(0.5, 0.0, 0.055)
    assert one.visible_interval == without.visible_interval
    assert one.visible_interval[0] > 0


@pytest.mark.parametrize(
    ("time_constant", "share", "heating"),
    [(300.0, 1.0, 40.0), (1500.0, 0.3, 5.0), (4500.0, 1.0, 2.0), (15000.0, 1.0, 40.0)],
)
def test_the_size_of_a_lag_is_the_friction_that_the_base_cannot_have(time_constant, share, heating):
    """Of equation (16) at both temperatures, and as precise as estimates of it scatter.

    A gear that warms more and friction that falls less with temperature are hardly told apart.
    """
    lag, coefficients = BY_NAME["thermal_lag"], np.array([share, heating, 0.0, 0.0])
    hidden = HiddenTemperature.of(time_constant, coefficients, DATA.reference_power)
    warm = at_temperature(DATA, DATA.parameters, hidden)
    table, load = warm.table, warm.load_base @ warm.gravity
    there, measured = (
        friction(TRUTH, load=table.load, speed=table.speed, temperature=one)
        for one in (table.temperature, table.measured_temperature)
    )
    both = np.concatenate([there - measured, np.zeros(ROWS)])
    true = np.sqrt(np.sum(np.square(both - SPAN @ (SPAN.T @ both))) / ROWS)
    shape = {"time_constant": time_constant}
    fit = EffectFit(restricted([0, 1]), shape, coefficients, np.eye(4), 99.0)
    found = replace(cause(), fit=fit, effects=(lag.name,))
    generator, sizes, halves = np.random.default_rng(5), [], []
    for _ in range(25):
        own, its_load = np.split(noise(generator), 2)
        joint = replace(warm, friction=there + own, load=load + its_load)
        extension = extend(joint, fit_of(None), [fit])
        (one,) = fitted_sizes([found], extension, joint, fit_of(None), SPAN)
        low, high = one.visible_interval
        assert low < true < high
        sizes.append(one.visible)
        halves.append(np.sqrt(((high - low) / 2) ** 2 - (1.96 * 0.05 * one.visible) ** 2))
    assert np.mean(sizes) == pytest.approx(true, rel=0.01)
    assert np.mean(halves) / 1.96 == pytest.approx(np.std(sizes), rel=0.35)


@pytest.mark.parametrize(
    ("found", "interval"),
    [
        # surely more was found: it may be as much
        ((0.15, 0.19), (0.03, 0.19)),
        # both agree
        ((0.04, 0.19), (0.03, 0.05)),
    ],
)
def test_an_interval_reaches_what_was_found_where_that_is_surely_more(found, interval):
    stated = replace(cause(interval=(0.03, 0.05)), size_interval=(0.04, 0.06))
    held = _holding_found(stated, cause(interval=found))
    assert held.visible_interval == interval
    assert held.size_interval == (0.04, max(0.06, interval[1]))
    delay = cause(BY_NAME["torque_delay"], interval=found)
    of_log = replace(delay, visible_interval=(0.03, 0.05))
    assert _holding_found(of_log, delay) is of_log
