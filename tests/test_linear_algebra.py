"""Pseudo-inverses, complements, residuals and bases against dense algebra and known results."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.linear_algebra import (
    gram_inverse,
    least_squares_residual,
    orthonormal_basis,
    scaled_gram_inverse,
    schur_complement,
)

GENERATOR = np.random.default_rng(4)
UNITS = np.array([1e-6, 1.0, 1e4, 1e7])
COLUMNS = GENERATOR.normal(size=(3, 30, 4))
"""Three sets of four columns."""


def products(columns):
    return columns.swapaxes(-1, -2) @ columns


def test_inverse_of_a_regular_matrix_is_its_inverse():
    gram = products(COLUMNS)
    identity = np.broadcast_to(np.eye(4), gram.shape)
    np.testing.assert_allclose(gram_inverse(gram, tolerance=1e-10) @ gram, identity, atol=1e-12)


def test_inverse_of_a_rank_one_matrix_is_known():
    """The pseudo-inverse of v v' is v v' / |v|^4."""
    v = np.array([1.0, -2.0, 2.0])
    found = gram_inverse(np.outer(v, v), tolerance=1e-10)
    np.testing.assert_allclose(found, np.outer(v, v) / 81.0, atol=1e-15)


def test_scaled_inverse_does_not_depend_on_units():
    """A spread of 26 decades between squared lengths is beyond the tolerance without scaling."""
    scaled = scaled_gram_inverse(products(COLUMNS * UNITS), tolerance=1e-10)
    expected = np.linalg.inv(products(COLUMNS)) / np.outer(UNITS, UNITS)
    np.testing.assert_allclose(scaled, expected, rtol=1e-9)


def test_scaled_inverse_of_one_matrix_is_that_of_a_stack():
    gram = products(COLUMNS * UNITS)
    stack = scaled_gram_inverse(gram, tolerance=1e-10)
    for number, one in enumerate(gram):
        np.testing.assert_array_equal(stack[number], scaled_gram_inverse(one, tolerance=1e-10))


def test_absent_columns_are_zero_in_the_inverse():
    columns = COLUMNS[0] * [1.0, 0.0, 1.0, 1e-120]
    inverse = scaled_gram_inverse(products(columns), tolerance=1e-10, absent=1e-200)
    assert not inverse[[1, 3]].any()
    assert not inverse[:, [1, 3]].any()
    present = COLUMNS[0][:, [0, 2]]
    np.testing.assert_allclose(inverse[::2, ::2], np.linalg.inv(products(present)), rtol=1e-12)


def test_two_equal_columns_share_their_coefficient():
    column = COLUMNS[0, :, :1]
    twins = np.hstack([column, column])
    coefficients = scaled_gram_inverse(products(twins), tolerance=1e-10) @ (twins.T @ column)
    np.testing.assert_allclose(coefficients, 0.5)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_complement_holds_the_products_of_residuals(count):
    """The others projected off the first columns, by a dense projection matrix."""
    complement, size = schur_complement(products(COLUMNS * UNITS), count, tolerance=1e-10)
    for number, columns in enumerate(COLUMNS * UNITS):
        first, others = columns[:, :count], columns[:, count:]
        residual = others - first @ np.linalg.pinv(first) @ others
        lengths = np.linalg.norm(others, axis=0)
        np.testing.assert_allclose(size[number], lengths)
        np.testing.assert_allclose(
            complement[number], products(residual / lengths), atol=1e-12, rtol=1e-9
        )


def test_residual_is_orthogonal_and_leaves_the_rest():
    columns, target = COLUMNS[0] * UNITS, COLUMNS[1, :, 0]
    residual = least_squares_residual(columns, target, tolerance=1e-9)
    np.testing.assert_allclose(columns.T @ residual / UNITS, 0.0, atol=1e-12)
    rank = np.linalg.matrix_rank(np.column_stack([COLUMNS[0], target - residual]), tol=1e-9)
    assert rank == 4


def test_columns_of_zeros_explain_nothing():
    target = COLUMNS[1, :, 0]
    zeros = np.zeros((30, 2))
    np.testing.assert_array_equal(least_squares_residual(zeros, target, tolerance=1e-9), target)
    assert orthonormal_basis(zeros, tolerance=1e-7).shape == (30, 0)


def test_basis_is_orthonormal_and_spans_the_columns():
    dependent = np.column_stack([COLUMNS[0] * UNITS, COLUMNS[0] @ [1.0, 2.0, 3.0, 4.0]])
    basis = orthonormal_basis(dependent, tolerance=1e-7)
    assert basis.shape == (30, 4)
    np.testing.assert_allclose(basis.T @ basis, np.eye(4), atol=1e-12)
    np.testing.assert_allclose(basis @ (basis.T @ COLUMNS[0]), COLUMNS[0], atol=1e-12)


@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(1, 6))
@settings(max_examples=40)
def test_basis_is_orthonormal_and_holds_every_column(seed, rank, count):
    generator = np.random.default_rng(seed)
    columns = generator.normal(size=(10, rank)) @ generator.normal(size=(rank, count))
    columns = columns * 10.0 ** generator.integers(-6, 6, count)
    unit = orthonormal_basis(columns, tolerance=1e-7)
    assert unit.shape[1] == min(rank, count)
    np.testing.assert_allclose(unit.T @ unit, np.eye(unit.shape[1]), atol=1e-10)
    left = columns - unit @ (unit.T @ columns)
    assert (np.linalg.norm(left, axis=0) <= 1e-6 * np.linalg.norm(columns, axis=0)).all()


def test_the_basis_of_nothing_is_empty():
    assert orthonormal_basis(np.zeros((5, 2)), tolerance=1e-7).shape == (5, 0)
    assert orthonormal_basis(np.empty((5, 0)), tolerance=1e-7).shape == (5, 0)
