"""Coefficients within bounds beside scipy's bounded least squares."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from frictioncli.diagnosis.fit.bounded import bounded_coefficients

BOUNDS = st.tuples(
    st.sampled_from([-np.inf, -2.0, -0.5, 0.0]), st.sampled_from([0.0, 0.3, 4.0, np.inf])
).filter(lambda pair: pair[0] < pair[1])


def case(seed, width, *, alike=0.0):
    """Return columns and data, the last column perhaps nearly the first."""
    generator = np.random.default_rng(seed)
    columns = generator.normal(size=(20, width)) * 10 ** generator.uniform(-2, 2, width)
    if alike and width > 1:
        size = np.linalg.norm(columns[:, -1]) / np.linalg.norm(columns[:, 0])
        columns[:, -1] = size * columns[:, 0] + alike * columns[:, -1]
    coefficients = generator.normal(size=width) * 2
    return columns, columns @ coefficients + generator.normal(size=20)


def gain(columns, data, coefficients):
    """Return by how much coefficients reduce the sum of squares."""
    return data @ data - np.sum(np.square(data - columns @ coefficients))


@given(st.integers(0, 10**6), st.lists(BOUNDS, min_size=1, max_size=4), st.sampled_from([0, 0.05]))
@settings(max_examples=150, deadline=None)
def test_coefficients_are_the_best_between_their_bounds(seed, bounds, alike):
    lower, upper = map(np.array, zip(*bounds, strict=True))
    columns, data = case(seed, len(bounds), alike=alike)
    expected = lsq_linear(columns, data, (lower, upper), method="bvls", tol=1e-12).x
    inner, right = columns.T @ columns, columns.T @ data
    found, twice, free = bounded_coefficients(inner[None], right[None], lower, upper)
    assert (found[0] >= lower - 1e-9).all()
    assert (found[0] <= upper + 1e-9).all()
    best = gain(columns, data, expected)
    assert twice[0] == pytest.approx(gain(columns, data, found[0]), rel=1e-6, abs=1e-8)
    assert twice[0] == pytest.approx(best, rel=1e-6, abs=1e-6)
    on_a_bound = np.isclose(found[0], lower, atol=1e-12) | np.isclose(found[0], upper, atol=1e-12)
    assert not (free[0] & on_a_bound & (found[0] != 0)).any()


def test_the_free_ones_have_no_slope_and_the_fixed_ones_want_to_leave():
    """The conditions of Karush, Kuhn and Tucker, for many candidates at once."""
    generator = np.random.default_rng(4)
    columns = generator.normal(size=(200, 30, 3))
    data = generator.normal(size=(200, 30)) + columns @ np.array([1.0, -1.0, 3.0])
    inner = np.einsum("cri,crj->cij", columns, columns)
    right = np.einsum("cri,cr->ci", columns, data)
    lower, upper = np.array([0.0, 0.0, -1.0]), np.array([np.inf, 2.0, 1.0])
    found, _, free = bounded_coefficients(inner, right, lower, upper)
    slope = right - np.einsum("cij,cj->ci", inner, found)
    assert np.abs(slope[free]).max() < 1e-9
    at_lower = ~free & (found == lower)
    at_upper = ~free & (found == upper)
    assert (free | at_lower | at_upper).all()
    assert at_lower.any()
    assert at_upper.any()
    assert (slope[at_lower] <= 1e-9).all()
    assert (slope[at_upper] >= -1e-9).all()


def test_without_bounds_in_the_way_it_is_least_squares():
    columns, data = case(3, 4)
    found, twice, free = bounded_coefficients(
        (columns.T @ columns)[None], (columns.T @ data)[None], np.full(4, -np.inf), np.full(4, 1e9)
    )
    expected, left, *_ = np.linalg.lstsq(columns, data, rcond=None)
    np.testing.assert_allclose(found[0], expected, rtol=1e-6)
    assert twice[0] == pytest.approx(data @ data - left[0])
    assert free.all()


def test_a_column_without_length_has_no_coefficient():
    inner, right = np.diag([4.0, 0.0])[None], np.array([[2.0, 0.0]])
    found, twice, free = bounded_coefficients(inner, right, np.zeros(2), np.full(2, 9.0))
    np.testing.assert_allclose(found, [[0.5, 0.0]])
    assert twice[0] == pytest.approx(1.0)
    np.testing.assert_array_equal(free, [[True, False]])


def test_bounds_above_zero_may_forbid_the_candidate():
    """Nothing between 1 and 2 is better than nothing at all where the data say -1."""
    found, twice, free = bounded_coefficients(
        np.ones((1, 1, 1)), -np.ones((1, 1)), np.ones(1), np.full(1, 2.0)
    )
    assert (found[0, 0], twice[0], free[0, 0]) == (0.0, 0.0, False)
