"""Groups of columns from their inner products, against QR decompositions and least squares."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.diagnosis.noise.orthonormal_groups import Groups, gram_schmidt


def inner_products(columns):
    return columns.swapaxes(-1, -2) @ columns


def squares(columns):
    return np.sum(np.square(columns), axis=-2)


@given(st.integers(1, 6), st.integers(0, 10_000), st.floats(-6, 6))
@settings(max_examples=60)
def test_unmixing_is_the_inverse_triangle_of_a_qr_decomposition(width, seed, power):
    """X = QR, so Q' = (R')^-1 X'; signs are such that R's diagonal is positive."""
    generator = np.random.default_rng(seed)
    columns = generator.normal(size=(2, 3, 20, width)) * 10.0**power
    found = gram_schmidt(inner_products(columns), squares(columns))
    for place in np.ndindex(2, 3):
        triangle = np.linalg.qr(columns[place])[1]
        triangle *= np.sign(np.diag(triangle))[:, np.newaxis]
        size = np.linalg.norm(columns[place], axis=0)
        expected = np.linalg.inv(triangle.T)
        np.testing.assert_allclose(found[place] * size, expected * size, atol=1e-9)


@pytest.mark.parametrize(("left", "seen"), [(0.0, 0), (0.0009, 0), (0.0011, 1), (1.0, 1)])
def test_a_column_needs_a_thousandth_of_its_length(left, seen):
    columns = np.eye(5)[:, :2] * [1.0, 3.0]
    rest = columns * [1.0, left]
    mixed = rest @ gram_schmidt(inner_products(rest), squares(columns)).T
    np.testing.assert_allclose(mixed, np.eye(5)[:, :2] * [1.0, seen], atol=1e-12)


@pytest.mark.parametrize(("share", "length"), [(0.0, 0), (0.5e-4, 0), (2e-4, 1)])
def test_a_column_needs_a_ten_thousandth_beside_the_others_of_its_group(share, length):
    first, second, new, last = np.eye(6)[:, :4].T
    columns = np.column_stack([first, second, 0.6 * first + 0.8 * second + share * new, last])
    mixed = columns @ gram_schmidt(inner_products(columns), squares(columns)).T
    np.testing.assert_allclose(np.linalg.norm(mixed, axis=0), [1.0, 1.0, length, 1.0], atol=1e-6)
    np.testing.assert_allclose(mixed[:, 3], last, atol=1e-12)


@given(st.lists(st.integers(1, 4), min_size=1, max_size=6), st.integers(0, 10_000))
@settings(max_examples=40)
def test_what_a_group_takes_is_what_least_squares_takes(widths, seed):
    generator = np.random.default_rng(seed)
    groups = Groups.of(widths)
    columns, data = generator.normal(size=(15, sum(widths))), generator.normal(size=(15, 3))
    mixings = [
        gram_schmidt(inner_products(own), squares(own))
        for own in (np.moveaxis(columns[:, places], 1, 0) for _, places in groups.by_width())
    ]
    found = groups.explained(mixings, columns.T @ data)
    for group in range(len(widths)):
        own = columns[:, groups.columns(group)]
        left = data - own @ np.linalg.lstsq(own, data, rcond=None)[0]
        np.testing.assert_allclose(found[group], squares(data) - squares(left), atol=1e-9)


def test_groups_of_one_width_stand_together():
    found = Groups.of([1, 2, 1, 3, 2]).by_width()
    assert [which.tolist() for which, _ in found] == [[0, 2], [1, 4], [3]]
    assert [columns.tolist() for _, columns in found] == [[[0], [3]], [[1, 2], [7, 8]], [[4, 5, 6]]]
    assert Groups.of([]).by_width() == []


def test_chosen_groups_follow_each_other():
    some, columns = Groups.of([1, 2, 1, 3]).select(np.array([False, True, False, True]))
    assert some.start.tolist() == [0, 2]
    assert some.width.tolist() == [2, 3]
    assert columns.tolist() == [1, 2, 4, 5, 6]
