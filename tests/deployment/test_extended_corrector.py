"""The gear's state, told pair by pair, is what the extended model computes from the whole log."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.correction.evaluation import simulate
from frictioncli.correction.settings import CorrectionSettings, ScheduleSettings
from frictioncli.deployment.extended_corrector import ExtendedCorrector
from frictioncli.deployment.extension import MEMORYLESS, deployable_extension
from frictioncli.deployment.gear_temperature import GearLag, GearTemperature
from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients, stated_gravity
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.documents.apply_extension import (
    friction_beyond,
    with_effects,
    without_effects,
)
from frictioncli.diagnosis.documents.extended_model import ExtendedModel, FittedEffect
from frictioncli.documents import decode, to_json
from frictioncli.effects import BY_NAME
from frictioncli.effects.friction_heat import friction_power
from frictioncli.effects.pair_series import pair_heads
from frictioncli.model.friction import PUBLISHED
from tests.correction.models import published_model
from tests.deployment.joints import LAG, effect
from tests.deployment.logged_pairs import instants_before, pairs_of
from tests.equation_16 import torques

GRAVITY = GravityCoefficients(cosine=95.0, sine=0.0, offset=0.0)
LAGGING = FittedEffect(
    effect=BY_NAME["thermal_lag"],
    shape={"time_constant": 1500.0},
    coefficients=np.array([0.5, 6.0, 0.1, 0.3]),
)
HIDDEN = HiddenTemperature.of(1500.0, LAGGING.coefficients, 5000.0)
CHANGED = replace(PUBLISHED, tau_c=9.9, alpha=0.0015, beta=3.0, gamma=20.0, delta=0.07)


def model_with(*effects, hidden=HIDDEN):
    return ExtendedModel(
        temperature="motor",
        parameters=CHANGED,
        about=PUBLISHED,
        gravity=GRAVITY,
        gravity_about=GRAVITY,
        effects=effects,
        hidden=hidden if LAGGING in effects else None,
    )


def two_days(speeds=(67.5,)):
    """Two runs whose housing follows its own way; the load is the gravity that is fitted."""
    days = [torques(seed, speeds=speeds).assign(run=f"day{seed}") for seed in (1, 2)]
    rows = pd.concat(days, ignore_index=True)
    housing = rows["motor_temperature"] - 4 * np.sin(rows["time"] / 3000)
    return rows.assign(load=np.nan, housing_temperature=housing)


def replayed(rows, model, schedule):
    extension = deployable_extension(rows, model, None)
    base = published_model()
    added, _ = friction_beyond(rows, base, model)
    pairs = pairs_of(rows, added)
    told = instants_before(rows, model, extension) if extension.gear else [[]] * len(pairs)
    found, before = [], None
    for pair, instants in zip(pairs.itertuples(), told, strict=True):
        if before is None or pair.run != before.run:
            corrector = ExtendedCorrector(TemperatureCorrector(PUBLISHED), extension)
        if before is None or (pair.run, pair.phase) != (before.run, before.phase):
            corrector.base = TemperatureCorrector(PUBLISHED, k=schedule.k, tmax=schedule.tmax)
        for one in instants[:-1]:
            corrector.update(
                one.time,
                one.motor,
                before.registered,
                housing_temperature=one.housing,
                power=one.power,
            )
        corrector.update(
            pair.time,
            pair.motor_temperature,
            pair.registered,
            housing_temperature=pair.housing_temperature,
            power=instants[-1].power if instants else 0.0,
        )
        load = math.sqrt(pair.squared)
        beyond = corrector.added_friction(load, pair.speed)
        due = corrector.is_due
        if due:
            corrector.correct(pair.friction, load, pair.speed)
        predicted = corrector.friction(load, pair.speed) - PUBLISHED.alpha * pair.squared
        found.append((pair.run, pair.pair, due, corrector.correction, beyond, predicted))
        before = pair
    names = ["run", "pair", "corrected", "correction", "beyond", "predicted"]
    return pd.DataFrame(found, columns=names).assign(added=pairs["added"])


@pytest.mark.parametrize(
    "effects",
    [(LAGGING,), (LAGGING, effect("linear_viscous", 0.05), effect("coulomb_temperature", -0.7))],
    ids=["lag", "lag and others"],
)
def test_a_replay_of_the_log_is_the_batch_s_extended_simulation(effects):
    """Same moments; friction to 1e-9: the two sum the same numbers in another order."""
    rows, model, schedule = two_days(), model_with(*effects), ScheduleSettings(k=3.0)
    online = replayed(rows, model, schedule)
    np.testing.assert_allclose(online["beyond"], online["added"], rtol=1e-9, atol=1e-9)
    bare, base, added = without_effects(rows, published_model(), model)
    batch = with_effects(simulate(bare, base, CorrectionSettings(), schedule), added)
    both = batch.merge(online, on=["run", "pair"], suffixes=("", "_online"))
    assert len(both) == len(batch) == 2 * 80
    assert (both["corrected"] == both["corrected_online"]).all()
    assert both["corrected"].sum() > 10
    np.testing.assert_allclose(both["correction"], both["temperature_correction"], atol=1e-8)
    np.testing.assert_allclose(both["predicted"], both["friction_predicted"], rtol=1e-9)


def test_effects_that_need_the_past_are_named_and_left_out():
    others = [
        FittedEffect(effect=BY_NAME[name], shape={}, coefficients=np.zeros(1))
        for name in ("drift", "position_ripple", "dress_pack")
    ]
    extension = deployable_extension(
        two_days(), model_with(LAGGING, effect("load_linear", 0.1), *others), None
    )
    assert [term.effect.name for term in extension.terms] == ["load_linear"]
    assert extension.left_out == {
        "drift": "depends on the time since the first log",
        "position_ripple": "depends on the angle",
        "dress_pack": "shows in the load, not in friction",
    }
    assert deployable_extension(two_days(), model_with(), None) is None


def test_every_effect_is_carried_or_has_a_reason():
    for name, entry in BY_NAME.items():
        if name in (*MEMORYLESS, "thermal_lag"):
            assert entry.channel == "friction"
            continue
        one = FittedEffect(effect=entry, shape={}, coefficients=np.zeros(len(entry.coefficients)))
        why = deployable_extension(two_days(), model_with(one), None).left_out[name]
        if entry.measurement:
            assert why == "is a property of the log, not of the joint"
            continue
        assert ("load" in why) == (entry.channel == "load" and name != "inertia")


def test_the_state_refers_to_what_the_log_had():
    """Reference power from the model, and the start's spread by another route."""
    rows = two_days()
    gear = deployable_extension(rows, model_with(LAGGING), (900.0, 2600.0)).gear
    assert gear.reference_power == 5000.0
    assert gear.time_constant_ci95 == (900.0, 2600.0)
    _, problem = simulated(rows, "motor", PUBLISHED, stated_gravity(GRAVITY), HIDDEN)
    table = problem.table
    heads = pair_heads(table)
    power = np.append(0.0, friction_power(table, heads)) * 5000.0
    spread = []
    for run in np.unique(table.run):
        here = table.run[heads.first] == run
        time, motor, housing = (
            column[heads.first][here]
            for column in (table.time, table.motor_temperature, table.housing_temperature)
        )
        for end in range(1, int(here.sum()) + 1):
            lag = replace(LAG, lag_share=0.5, housing_share=0.1, housing_lag_share=0.3)
            follower = GearTemperature(lag)
            if end % 10 and end != here.sum():
                continue
            for at in zip(time[:end], motor, housing, power[here], strict=False):
                follower.update(*map(float, at))
            at_once = 0.4 * (housing[end - 1] - motor[end - 1])
            spread.append(follower.excess - at_once)
    assert gear.start_sd == pytest.approx(np.sqrt(np.mean(np.square(spread))), rel=0.1)


def integrated(time, motor, housing, power):
    """The gear's filters by a solver of differential equations; power in steps, the rest linear."""

    def slope(t, state):
        place = min(np.searchsorted(time, t, side="left"), len(time) - 1)
        inputs = np.array(
            [
                np.interp(t, time, motor),
                np.interp(t, time, housing),
                power[place] / LAG.reference_power,
            ]
        )
        return (inputs - state) / LAG.time_constant

    state = np.array([motor[0], housing[0], 0.0])
    for begin, end in pairwise(time):
        inside = (begin + 1e-9, end)
        state = solve_ivp(slope, inside, state, rtol=1e-10, atol=1e-10).y[:, -1]
    return (
        LAG.lag_share * (state[0] - motor[-1])
        + LAG.housing_lag_share * (state[1] - motor[-1])
        + LAG.housing_share * (housing[-1] - motor[-1])
        + LAG.friction_heating * state[2]
    )


def test_uneven_samples_are_stepped_exactly():
    """Against a numerical solution of theta dF/dt = u - F: to 1e-6 °C after 40 uneven steps."""
    generator = np.random.default_rng(4)
    time = np.cumsum(generator.uniform(1, 900, 40))
    motor = 30 + np.cumsum(generator.normal(0, 1, 40))
    housing = 27 + np.cumsum(generator.normal(0, 1, 40))
    power = generator.uniform(0, 8000, 40)
    gear = GearTemperature(LAG)
    for at in zip(time, motor, housing, power, strict=True):
        gear.update(*map(float, at))
    assert gear.excess == pytest.approx(integrated(time, motor, housing, power), abs=1e-6)


def test_a_hidden_housing_follows_the_motor():
    """40 °C after 20 °C for one time constant: it has closed 63 % of the distance."""
    hidden = replace(
        LAG, lag_share=0.0, friction_heating=0.0, housing_share=1.0, housing_lag_share=0.0
    )
    gear = GearTemperature(replace(hidden, housing_time_constant=3000.0))
    for time, motor in ((0.0, 20.0), (1e-6, 40.0), (3000.0, 40.0)):
        gear.update(time, motor)
    assert gear.excess == pytest.approx(-20.0 * math.exp(-1), rel=1e-6)


@settings(max_examples=50)
@given(
    cuts=st.lists(st.floats(0.01, 0.99), min_size=1, max_size=6, unique=True),
    duration=st.floats(10, 5000),
    warming=st.floats(-10, 10),
    power=st.floats(0, 9000),
)
def test_more_samples_of_the_same_course_change_nothing(cuts, duration, warming, power):
    coarse, fine = GearTemperature(LAG), GearTemperature(LAG)
    for gear in (coarse, fine):
        gear.update(0.0, 30.0)
    for share in (*sorted(cuts), 1.0):
        fine.update(share * duration, 30.0 + share * warming, power=power)
    coarse.update(duration, 30.0 + warming, power=power)
    assert fine.excess == pytest.approx(coarse.excess, abs=1e-9)
    assert fine.uncertainty == pytest.approx(coarse.uncertainty, abs=1e-9)


def test_the_unknown_start_fades_with_the_time_constant():
    gear = GearTemperature(replace(LAG, time_constant_ci95=None))
    for time, left in ((0.0, 1.0), (1500.0, math.exp(-1)), (15000.0, math.exp(-10))):
        gear.update(time, 40.0, 40.0)
        assert gear.uncertainty == pytest.approx(3.0 * left)


def test_while_the_motor_warms_the_interval_of_the_time_constant_shows():
    """Warming by 0.001 °C/s for long: the followers lag by theta/1000, 0.9 and 2.6 °C."""
    gear = GearTemperature(replace(LAG, friction_heating=0.0))
    for time in np.arange(0.0, 40_000.0, 100.0):
        gear.update(time, 20 + time / 1000, 20 + time / 1000)
    shares = LAG.lag_share + LAG.housing_lag_share
    assert gear.excess == pytest.approx(shares * -1.5, abs=1e-6)
    assert gear.uncertainty == pytest.approx(shares * (2.6 - 0.9) / (2 * 1.96), rel=1e-3)


def test_the_uncertainty_holds_the_truth():
    """Joints whose gear began off by the spread told, with time constants from the interval."""
    generator, missed, told = np.random.default_rng(7), [], []
    for _ in range(300):
        truth = generator.normal(1750.0, 1700 / (2 * 1.96))
        if truth < 300:
            continue
        gear = GearTemperature(LAG)
        real = GearTemperature(replace(LAG, time_constant=truth, time_constant_ci95=None))
        off = generator.normal(0, LAG.start_sd)
        length = generator.integers(2, 60)
        motor = 30 + np.cumsum(generator.normal(0.2, 0.5, length))
        for i, warm in enumerate(motor):
            for state in (gear, real):
                state.update(120.0 * i, float(warm), power=4000.0)
        missed.append(real.excess + off * math.exp(-120.0 * (length - 1) / truth) - gear.excess)
        told.append(gear.uncertainty)
    inside = np.mean(np.abs(missed) < 1.96 * np.array(told))
    assert 0.88 < inside <= 1.0
    assert np.sqrt(np.mean(np.square(missed))) == pytest.approx(
        np.sqrt(np.mean(np.square(told))), rel=0.25
    )


def test_an_unknown_housing_counts_as_the_latest_known_or_as_the_motor():
    gear = GearTemperature(replace(LAG, time_constant=1e9, time_constant_ci95=None))
    gear.update(0.0, 40.0)
    assert gear.excess == 0.0
    gear.update(1.0, 40.0, 30.0)
    assert gear.excess == pytest.approx(0.1 * -10.0, abs=1e-6)
    gear.update(2.0, 42.0)
    behind = 0.5 * -2.0 + 0.3 * -2.0
    assert gear.excess == pytest.approx(0.1 * -12.0 + behind, abs=1e-6)


def test_the_lag_goes_through_json():
    assert decode(to_json(LAG).encode(), GearLag) == LAG
