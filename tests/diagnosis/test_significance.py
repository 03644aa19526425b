"""Null distributions of simulated statistics, and Bayes factors by quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, stats

from frictioncli.diagnosis.noise.significance import (
    NullDistribution,
    credible_set,
    fit_null_distribution,
    log_bayes_factor,
    posterior_probabilities,
)


@pytest.mark.parametrize("freedom", [1, 2, 4])
def test_chance_of_one_try_is_the_chi_squared_tail(freedom):
    drawn = stats.chi2.rvs(freedom, size=40_000, random_state=1)
    chance = fit_null_distribution(drawn)
    for probability in (0.5, 0.1, 0.05, 0.01):
        statistic = stats.chi2.isf(probability, freedom)
        assert chance.p_value(statistic) == pytest.approx(probability, rel=0.06)
        assert chance.critical_value(probability) == pytest.approx(statistic, rel=0.04)


def test_exact_moments_give_the_exact_tail():
    """A mean of n and a variance of 2 n are those of chi squared."""
    drawn = 3.0 + np.sqrt(6.0) * np.array([1.0, -1.0])
    assert fit_null_distribution(drawn).p_value(11.0) == pytest.approx(
        stats.chi2.sf(11.0, 3), rel=1e-12
    )


@pytest.mark.parametrize("tries", [1, 5, 20])
def test_the_greatest_of_many_passes_as_often_as_its_chance_says(tries):
    """200 draws tell what 20,000 further ones do: 5 % are found in 3 to 7.5 %."""
    generator = np.random.default_rng(3)
    shares = []
    for _ in range(20):
        drawn = np.square(generator.normal(size=(200, tries))).max(axis=1)
        new = np.square(generator.normal(size=(1000, tries))).max(axis=1)
        shares.append(np.mean(new > fit_null_distribution(drawn).critical_value(0.05)))
    assert 0.03 < np.mean(shares) < 0.075


@given(st.floats(0.3, 20.0), st.floats(0.1, 10.0), st.floats(1e-9, 0.9))
@settings(max_examples=60)
def test_limit_and_beyond_are_inverse(shape, scale, probability):
    chance = NullDistribution(shape, scale)
    assert chance.p_value(chance.critical_value(probability)) == pytest.approx(
        probability, rel=1e-6
    )


@pytest.mark.parametrize("drawn", [[], [3.0], [0.0] * 50, [2.0] * 50])
def test_noise_that_says_nothing_is_no_measure_of_chance(drawn):
    chance = fit_null_distribution(np.array(drawn))
    assert chance.p_value(100.0) == 1.0
    assert chance.critical_value(0.01) == np.inf


def test_far_tails_do_not_vanish():
    """By the integral of the density of chi squared with two degrees, exp(-x/2)."""
    assert NullDistribution(1.0, 2.0).p_value(600.0) == pytest.approx(np.exp(-300.0), rel=1e-9)
    assert NullDistribution(1.0, 2.0).critical_value(np.exp(-300.0)) == pytest.approx(600.0)


@pytest.mark.parametrize("estimate", [0.0, 1.0, 4.0])
def test_evidence_is_an_integral_over_the_coefficient(estimate):
    """A coefficient known to 1, before the data normal with variance 100: Bayes by quadrature."""
    product = integrate.quad(
        lambda b: stats.norm.pdf(estimate, b, 1.0) * stats.norm.pdf(b, 0.0, 10.0),
        -80,
        80,
        limit=200,
    )[0]
    expected = np.log(product / stats.norm.pdf(estimate, 0.0, 1.0))
    assert log_bayes_factor(np.array([estimate**2]), 1) == pytest.approx(expected, abs=1e-6)


def test_evidence_of_many_shapes_is_the_mean_of_their_factors():
    grid = np.array([30.0, 12.0, 0.0])
    factors = [np.exp(log_bayes_factor(np.array([one]), 2)) for one in grid]
    assert log_bayes_factor(grid, 2) == pytest.approx(np.log(np.mean(factors)))


def test_evidence_prefers_the_better_and_the_simpler():
    assert log_bayes_factor(np.array([40.0]), 1) > log_bayes_factor(np.array([20.0]), 1)
    assert log_bayes_factor(np.array([40.0]), 1) > log_bayes_factor(np.array([40.0]), 3)
    assert log_bayes_factor(np.array([40.0]), 1) > log_bayes_factor(np.array([40.0, 0, 0, 0]), 1)
    assert log_bayes_factor(np.zeros(5), 1) < 0


def test_evidence_of_much_data_does_not_overflow():
    assert log_bayes_factor(np.array([1e6, 0.0]), 1) == pytest.approx(
        100 / 101 * 5e5 - np.log(101) / 2 - np.log(2), rel=1e-12
    )


def test_credible_set_is_the_least_that_reaches_its_level():
    share = posterior_probabilities({"a": 0.0, "b": np.log(3.0), "c": np.log(6.0)})
    assert share == pytest.approx({"c": 0.6, "b": 0.3, "a": 0.1})
    assert list(share) == ["c", "b", "a"]
    assert credible_set(share) == ("c", "b", "a")
    assert credible_set(share, 0.85) == ("c", "b")
    assert credible_set({"a": 0.99, "b": 0.01}) == ("a",)
    assert posterior_probabilities({}) == {}
    assert credible_set({}) == ()


@given(st.dictionaries(st.sampled_from("abcdefgh"), st.floats(-1e4, 1e4), min_size=1))
@settings(max_examples=60)
def test_probabilities_add_up_and_the_credible_set_cannot_be_smaller(evidence):
    share = posterior_probabilities(evidence)
    assert set(share) == set(evidence)
    assert sum(share.values()) == pytest.approx(1.0)
    assert list(share.values()) == sorted(share.values(), reverse=True)
    chosen = credible_set(share, 0.9)
    assert sum(share[name] for name in chosen) >= 0.9 - 1e-9
    assert sum(share[name] for name in chosen[:-1]) < 0.9
