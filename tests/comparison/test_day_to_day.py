"""What is chance and what is change, against formulas and draws of the tests' own."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from frictioncli.comparison.day_to_day import PRIOR_DEGREES_OF_FREEDOM, LevelModel

EVEN = np.zeros(10)


def trend_design(runs):
    return np.column_stack([np.ones(runs), np.linspace(0, 1, runs)])


def change(model, levels):
    fit = model.fit(levels, trend_design(len(levels)))
    return fit.estimate(np.array([0.0, 1.0]))


def test_two_runs_depend_on_the_assumed_variance():
    model = LevelModel.of(np.diag([0.09, 0.16]), np.zeros(2), 1.0)
    found = change(model, np.array([0.0, 4.0]))
    # difference of two runs, each of 1 % from day to day beside its own noise
    half = stats.t.ppf(0.975, PRIOR_DEGREES_OF_FREEDOM) * np.sqrt(2 * 1.0 + 0.09 + 0.16)
    assert found.value == pytest.approx(4.0)
    assert found.high - found.value == pytest.approx(half)
    assert found.p_value == pytest.approx(
        2 * stats.t.sf(4.0 / np.sqrt(2.25), PRIOR_DEGREES_OF_FREEDOM), rel=1e-9
    )


def test_many_runs_determine_the_variance():
    """As ordinary regression over 400 runs: the assumption of 1 % does not count any more."""
    generator = np.random.default_rng(1)
    share = np.linspace(0, 1, 400)
    levels = 3.0 * share + 5.0 * generator.standard_normal(400)
    found = change(LevelModel.of(np.zeros((400, 400)), np.zeros(400), 1.0), levels)
    line = stats.linregress(share, levels)
    assert found.value == pytest.approx(line.slope)
    half = stats.t.ppf(0.975, 398) * line.stderr
    assert found.high - found.value == pytest.approx(half, rel=0.01)


def test_levels_that_follow_the_ambient_temperature_are_no_change():
    """Friction rises with the cold: 0.3 % per °C, and each day is colder than the last."""
    ambient = np.linspace(30, 20, 8)
    levels = -0.3 * (ambient - ambient.mean())
    blind = change(LevelModel.of(np.zeros((8, 8)), np.full(8, 20.0), 1.0), levels)
    seeing = change(LevelModel.of(np.zeros((8, 8)), ambient, 1.0), levels)
    assert blind.low > 0
    assert seeing.low < 0 < seeing.high


def test_the_effect_of_ambient_temperature_is_predicted():
    generator = np.random.default_rng(3)
    ambient = generator.uniform(10, 35, 12)
    effect = -0.3 * (ambient - ambient.mean())
    model = LevelModel.of(np.zeros((12, 12)), ambient, 0.1)
    found = model.ambient_effect(effect + np.linspace(0, 4, 12), trend_design(12))
    assert np.corrcoef(found, effect)[0, 1] > 0.98


def test_without_temperatures_intervals_are_wide():
    levels = np.array([0.0, 1.0, 2.0, 3.0])
    known = change(LevelModel.of(np.zeros((4, 4)), np.zeros(4), 1.0), levels)
    unknown = change(LevelModel.of(np.zeros((4, 4)), np.full(4, np.nan), 1.0), levels)
    assert unknown.high - unknown.low > 5 * (known.high - known.low)


@pytest.mark.parametrize("runs", [2, 3, 6, 10])
def test_false_alarms_keep_to_their_rate_under_the_assumption(runs):
    """Levels drawn with the prior's own model: the share of p < 0.05 must be 5 %."""
    generator = np.random.default_rng(runs)
    model = LevelModel.of(np.zeros((runs, runs)), np.zeros(runs), 1.0)
    factor = PRIOR_DEGREES_OF_FREEDOM / generator.chisquare(PRIOR_DEGREES_OF_FREEDOM, 2000)
    draws = np.sqrt(factor)[:, None] * generator.standard_normal((2000, runs))
    alarms = sum(change(model, levels).p_value < 0.05 for levels in draws)
    assert 70 <= alarms <= 130  # 100 expected, standard deviation 10


@settings(max_examples=60)
@given(
    st.lists(st.floats(-20, 20), min_size=3, max_size=12),
    st.floats(-50, 50),
    st.floats(-10, 10),
)
def test_a_common_shift_changes_nothing_and_a_slope_adds(levels, shift, slope):
    runs = len(levels)
    model = LevelModel.of(0.2 * np.eye(runs), np.linspace(15, 25, runs), 1.0)
    before = change(model, np.array(levels))
    after = change(model, np.array(levels) + shift + slope * np.linspace(0, 1, runs))
    assert after.value == pytest.approx(before.value + slope, abs=1e-6)
    assert after.high - after.low == pytest.approx(before.high - before.low, rel=1e-6, abs=1e-6)
