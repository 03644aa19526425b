"""Many slices at once are as each alone, in a plain loop."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.pairs import slices


@settings(max_examples=60)
@given(
    lengths=st.lists(st.tuples(st.integers(0, 3), st.integers(1, 5)), max_size=6),
    behind=st.integers(0, 3),
)
def test_samples_get_the_value_of_their_slice(lengths, behind):
    """Each gap is followed by a slice; some touch each other or the ends."""
    expected, start, stop = [], [], []
    for number, (gap, length) in enumerate(lengths):
        expected += [-1.0] * gap
        start.append(len(expected))
        expected += [10.0 * number] * length
        stop.append(len(expected))
    expected += [-1.0] * behind
    values = 10.0 * np.arange(len(lengths))
    numbers = np.array(start, np.int64), np.array(stop, np.int64)
    found = slices.fill_slices(values, *numbers, len(expected), -1.0)
    assert found.tolist() == expected


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_means_leave_out_what_is_no_number(wrong):
    values = np.array([1.0, 2.0, 6.0, wrong, 4.0, 8.0, wrong, -wrong, 5.0])
    start, stop = np.array([0, 3, 6]), np.array([3, 6, 8])
    np.testing.assert_array_equal(slices.slice_means(values, start, stop), [3.0, 6.0, np.nan])


def test_means_of_numbers_are_those_of_each_slice():
    values = np.random.default_rng(4).normal(size=100)
    start, stop = np.array([2, 30, 60]), np.array([30, 59, 100])
    expected = [values[own].mean() for own in map(slice, start, stop)]
    np.testing.assert_allclose(slices.slice_means(values, start, stop), expected, rtol=1e-12)
