"""Null distributions beside simulated statistics, and Bayes factors by quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, stats

from frictioncli.diagnosis.noise.significance import (
    NullDistribution,
    credible_set,
    effective_shapes,
    log_bayes_factor,
    posterior_probabilities,
)


def one_shape(coefficients, freedom):
    return NullDistribution(coefficients=coefficients, freedom=freedom)


@pytest.mark.parametrize("coefficients", [1, 2, 4])
def test_with_noise_well_known_the_tail_is_that_of_chi_squared(coefficients):
    null = one_shape(coefficients, 1e9)
    for probability in (0.5, 0.1, 0.05, 0.01):
        statistic = stats.chi2.isf(probability, coefficients)
        assert null.p_value(statistic) == pytest.approx(probability, rel=1e-6)
        assert null.critical_value(probability) == pytest.approx(statistic, rel=1e-6)


@pytest.mark.parametrize(("coefficients", "rows"), [(1, 8), (2, 12), (4, 20)])
def test_with_noise_of_unknown_scale_a_likelihood_ratio_passes_as_often_as_its_p_value(
    coefficients, rows
):
    """Twice the log likelihood ratio of 20,000 regressions, n ln(S0/S1) of their square sums."""
    generator = np.random.default_rng(coefficients)
    columns = np.linalg.qr(generator.normal(size=(rows, coefficients)))[0]
    data = generator.normal(size=(rows, 20_000))
    before = np.sum(data**2, axis=0)
    after = before - np.sum((columns.T @ data) ** 2, axis=0)
    freedom = rows - coefficients
    ratios = freedom * np.log(before / after)
    found = np.array([one_shape(coefficients, freedom).p_value(one) for one in ratios[:4000]])
    for level in (0.5, 0.1, 0.05):
        # the standard deviation of a share of 4,000
        error = np.sqrt(level * (1 - level) / 4000)
        assert np.mean(found < level) == pytest.approx(level, abs=4 * error)


@given(st.integers(1, 5), st.floats(2.0, 1e5), st.floats(1.0, 30.0), st.floats(1e-9, 0.9))
@settings(max_examples=60)
def test_critical_value_and_p_value_are_inverse(coefficients, freedom, shapes, probability):
    null = NullDistribution(coefficients=coefficients, freedom=freedom, shapes=shapes)
    assert null.p_value(null.critical_value(probability)) == pytest.approx(probability, rel=1e-6)


def test_p_values_go_with_the_number_of_shapes_and_stay_below_one():
    null = NullDistribution(coefficients=1, freedom=50.0, shapes=7.0)
    assert null.p_value(9.0) == pytest.approx(7 * one_shape(1, 50.0).p_value(9.0))
    assert null.p_value(0.1) == 1.0


def ripples(orders, angle):
    waves = angle[:, None] * orders
    return np.stack([np.sin(waves), np.cos(waves)], axis=-1).reshape(len(angle), -1)


SEARCHES = {
    "three waves": (np.sin(np.linspace(0, np.pi, 120)[:, None] * np.linspace(5, 6, 3)), 1),
    "forty waves": (np.sin(np.linspace(0, np.pi, 120)[:, None] * np.linspace(5, 6, 40)), 1),
    "ripples": (ripples(np.linspace(3, 20, 34), np.linspace(0, np.pi, 120)), 2),
    "steps": ((np.linspace(0, 1, 120)[:, None] > np.linspace(0.05, 0.95, 19)) - 0.5, 1),
    "decays": (np.exp(-np.linspace(0, 1, 120)[:, None] / np.geomspace(0.05, 2, 8)), 1),
}
"""Columns of several shapes side by side, and the columns of each."""


@pytest.mark.parametrize("name", SEARCHES)
def test_the_greatest_of_several_shapes_passes_about_as_often_as_its_p_value_says(name):
    """20,000 draws of white noise."""
    columns, width = SEARCHES[name]
    columns = columns - columns.mean(axis=0)
    count = effective_shapes(columns.T @ columns, width)
    noise = np.random.default_rng(1).normal(size=(120, 20_000))
    greatest = np.zeros(20_000)
    for first in range(0, columns.shape[1], width):
        span = np.linalg.qr(columns[:, first : first + width])[0]
        greatest = np.maximum(greatest, np.sum(np.square(span.T @ noise), axis=0))
    null = NullDistribution(coefficients=width, freedom=1e9, shapes=count)
    for level, most in ((0.05, 1.2), (0.01, 1.2)):
        share = np.mean(greatest > null.critical_value(level))
        # the farther the tail, the less the shapes are alike there
        assert 0.55 * level < share < most * level


def test_directions_of_two_columns_each_count_once():
    """Planes that are orthogonal are as many tries; a plane and itself are one."""
    planes = np.eye(6)
    assert effective_shapes(planes, 2) == pytest.approx(3.0, abs=0.03)
    assert effective_shapes(np.kron(np.ones((3, 3)), np.eye(2)), 2) == pytest.approx(1.0)
    assert effective_shapes(np.diag([4.0, 9.0, 0.0]), 1) == pytest.approx(2.0, abs=0.02)
    assert effective_shapes(np.zeros((3, 3)), 1) == 1.0


def test_a_coefficient_that_no_data_determine_is_never_significant():
    null = NullDistribution(coefficients=0, freedom=100.0)
    assert null.p_value(100.0) == 1.0
    assert null.critical_value(0.01) == np.inf
    assert one_shape(1, 100.0).p_value(0.0) == 1.0


def test_far_tails_do_not_vanish():
    """By the integral of the density of chi squared with two degrees, exp(-x/2)."""
    null = one_shape(2, 1e12)
    assert null.p_value(600.0) == pytest.approx(np.exp(-300.0), rel=1e-3)
    assert null.critical_value(np.exp(-30.0)) == pytest.approx(60.0, rel=1e-4)


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
