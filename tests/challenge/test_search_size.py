"""Bisection for the least size that is found."""

import math

import pytest

from frictioncli.challenge.search_size import search_size


def searched(threshold, start, least=0.01, most=100.0):
    """The result, and the sizes that were tried."""
    tried = []

    def found(size):
        tried.append(size)
        return size >= threshold

    return search_size(found, start, least=least, most=most), tried


@pytest.mark.parametrize("threshold", [0.13, 0.5, 0.99, 1.0, 1.01, 3.3, 14.0])
def test_the_threshold_lies_between_the_bounds_which_are_close(threshold):
    result, tried = searched(threshold, 1.0)
    assert result.low < threshold <= result.high
    assert result.high / result.low <= 1.35
    assert result.size == pytest.approx(math.sqrt(result.low * result.high))
    assert len(tried) <= 8
    assert len(set(tried)) == len(tried)


def test_all_found_leaves_no_lower_bound():
    result, tried = searched(0.0, 1.0, least=0.1)
    assert result.low is None
    assert result.size == result.high == min(tried) == pytest.approx(0.125)


def test_nothing_found_has_no_size():
    result, _ = searched(math.inf, 1.0, most=10.0)
    assert (result.size, result.low, result.high) == (None, 8.0, None)


def test_sizes_stay_in_their_range():
    _, tried = searched(math.inf, 50.0, least=1.0, most=20.0)
    assert max(tried) <= 20.0
    _, tried = searched(0.0, 0.1, least=1.0, most=20.0)
    assert min(tried) >= 1.0


def test_a_size_that_cannot_be_tried_ends_the_search():
    result = search_size(lambda size: None, 1.0, least=0.1, most=10.0)
    assert (result.size, result.low, result.high) == (None, None, None)
    result = search_size(lambda size: size < 3 or None, 1.0, least=0.1, most=10.0)
    assert result.high == pytest.approx(0.125)
