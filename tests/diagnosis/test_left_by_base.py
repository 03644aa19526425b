"""What the base leaves of an effect, and the interval of its size, beside dense projections."""

import numpy as np
import pytest

from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import left_by, products_left_by, span_of, visible_size
from frictioncli.diagnosis.search.effect_size import elsewhere
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Basis
from tests.diagnosis.dense_noise import problem


@pytest.fixture(scope="module")
def joint():
    return problem(1)


@pytest.mark.parametrize("name", ["load_linear", "dress_pack", "torque_constant", "inertia"])
def test_what_is_left_is_the_residual_of_both_channels_together(joint, name):
    effect = BY_NAME[name]
    basis = joint.basis(effect, {axis.name: axis.at(0.5) for axis in effect.shape})
    base, columns = np.vstack(base_rows(joint)), np.vstack(basis)
    fitted = np.linalg.lstsq(base / np.linalg.norm(base, axis=0), columns, rcond=1e-9)[0]
    residual = columns - (base / np.linalg.norm(base, axis=0)) @ fitted
    found = left_by(span_of(joint), basis)
    np.testing.assert_allclose(found, residual, atol=1e-7 * np.abs(columns).max())


@pytest.mark.parametrize("name", ["load_linear", "dress_pack", "load_velocity"])
def test_products_of_what_is_left_are_those_of_its_rows(joint, name):
    effect = BY_NAME[name]
    basis = joint.basis(effect, {axis.name: axis.at(0.5) for axis in effect.shape})
    span = span_of(joint)
    left = left_by(span, basis)
    size = np.square(np.vstack(basis)).sum()
    np.testing.assert_allclose(products_left_by(span, basis), left.T @ left, atol=1e-12 * size)


def test_a_constant_that_loads_no_gear_is_not_taken_by_a_constant_that_does(joint):
    """In friction alone the two are one; the load torque knows which constant is there."""
    effect = BY_NAME["load_offset"]
    basis = joint.basis(effect, {})
    size = np.sqrt(np.mean(np.square(basis.friction)))
    base = base_rows(joint)[0]
    scaled = base / np.maximum(np.linalg.norm(base, axis=0), 1e-300)
    alone = basis.friction - scaled @ np.linalg.lstsq(scaled, basis.friction, rcond=1e-9)[0]
    assert np.sqrt(np.mean(np.square(alone))) < 1e-6 * size
    both = np.split(left_by(span_of(joint), basis), 2)[0]
    assert np.sqrt(np.mean(np.square(both))) > 0.8 * size


def test_what_stands_beside_the_base_leaves_nothing_of_itself(joint):
    basis = joint.basis(BY_NAME["load_linear"], {})
    again = left_by(span_of(joint, [Basis(*basis)]), basis)
    assert np.abs(again).max() < 1e-9


CASES = {
    "one": ([1.0], [[0.04]]),
    "one, barely seen": ([0.3], [[0.04]]),
    "one, very well known": ([1.0], [[1e-6]]),
    "two": ([1.0, -0.5], [[0.02, 0.01], [0.01, 0.03]]),
    "two, one of them hardly known": ([1.0, 0.2], [[0.3, 0.0], [0.0, 0.005]]),
    "four": ([0.5, 0.5, -0.3, 0.8], 0.02 * np.eye(4)),
    "four, barely seen": ([0.1, 0.1, -0.1, 0.1], 0.02 * np.eye(4)),
    "four that are alike": (
        [0.5, 0.5, -0.3, 0.8],
        0.02 * (0.3 * np.eye(4) + 0.7 * np.ones((4, 4))),
    ),
}
"""True coefficients and the covariance of their estimates."""


@pytest.mark.parametrize("name", CASES)
def test_intervals_of_a_size_hold_the_true_one(name):
    """2,000 estimates: 95 % intervals hold the truth in 92 to 98 %, and sizes are not biased."""
    truth, covariance = map(np.array, CASES[name])
    generator = np.random.default_rng(len(name))
    left = generator.normal(size=(300, len(truth))) @ np.diag(np.linspace(0.5, 2.0, len(truth)))
    size = np.sqrt(np.mean(np.square(left @ truth)))
    drawn = generator.multivariate_normal(truth, covariance, size=2000)
    found = np.array([visible_size(np.vstack([left, 0 * left]), one, covariance) for one in drawn])
    held = (found[:, 1] <= size) & (size <= found[:, 2])
    assert 0.92 < np.mean(held) < 0.985
    # what is named rests on the lower bound
    assert np.mean(found[:, 1] > size) < 0.035
    assert (found[:, 1] <= found[:, 0]).all()
    assert (found[:, 0] <= found[:, 2]).all()
    assert np.median(found[:, 0]) == pytest.approx(size, rel=0.1)


def test_intervals_of_an_effect_that_is_not_there_begin_at_zero():
    """Three coefficients of noise: the lower bound is above zero in 2.5 % of the cases."""
    generator = np.random.default_rng(5)
    left, covariance = generator.normal(size=(200, 3)), 0.01 * np.eye(3)
    drawn = generator.multivariate_normal(np.zeros(3), covariance, size=3000)
    found = np.array([visible_size(np.vstack([left, 0 * left]), one, covariance) for one in drawn])
    assert np.mean(found[:, 1] > 0) < 0.035
    assert found[:, 2].min() > 0.1


def test_a_single_coefficient_has_the_interval_of_its_errors():
    size, low, high = visible_size(
        np.repeat([[2.0], [0.0]], 9, axis=0), np.array([-3.0]), np.array([[0.01]])
    )
    assert (size, low, high) == pytest.approx((6.0, 6.0 - 1.96 * 0.2, 6.0 + 1.96 * 0.2), rel=1e-3)


def test_nothing_is_left_of_nothing():
    assert visible_size(np.zeros((5, 2)), np.ones(2), np.eye(2)) == (0.0, 0.0, 0.0)
    assert visible_size(
        np.repeat([[1.0], [0.0]], 5, axis=0), np.array([2.0]), np.zeros((1, 1))
    ) == (2.0, 2.0, 2.0)


@pytest.mark.parametrize(
    ("name", "shape", "coefficients", "where"),
    [
        # gravity takes a constant from the load, and the gear is unloaded by it
        ("direction_asymmetry", {"exponent": 1.0}, (1.0, 0.0, 0.0), "friction"),
        ("direction_asymmetry", {"exponent": 1.0}, (1.0, 0.5, 0.0), ""),
        ("dress_pack", {"rest": -40.0, "stiffening": 0.0}, (1.0,), ""),
        ("position_ripple", {"order": 9.0}, (1.0, 0.0, 0.0, 0.0), ""),
    ],
)
def test_an_effect_of_the_load_shows_in_the_load(joint, name, shape, coefficients, where):
    effect, values = BY_NAME[name], np.array(coefficients)
    fit = EffectFit(effect, shape, values, np.zeros((len(values),) * 2), 0.0)
    reason = elsewhere(Precomputed.of(joint), fit)
    assert reason == (f"it would show in the {where} rather than in the load" if where else "")
