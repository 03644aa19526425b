"""Both sides of an equation of motion pass the same filter."""

import numpy as np
import pytest

from frictioncli.regression.filters import filter_step, filtered, matched_filters


@pytest.mark.parametrize("step", [1, 2, 3, 6, 25])
def test_the_acceleration_of_positions_is_the_average_of_the_acceleration(step):
    """A sine of three hertz, whose derivatives are known in closed form."""
    period = 0.024 / step
    filters = matched_filters(step, period)
    time = period * np.arange(1000)
    rate = 2 * np.pi * 3.0
    centre = np.arange(200, 800, 2 * step)
    slope, curvature, jerk = filtered(
        np.sin(rate * time), centre, filters.slope, filters.curvature, filters.jerk
    )
    for found, derivative, order in (
        (slope, rate * np.cos(rate * time), 1),
        (curvature, -(rate**2) * np.sin(rate * time), 2),
        (jerk, -(rate**3) * np.cos(rate * time), 3),
    ):
        (average,) = filtered(derivative, centre, filters.mean)
        # the error of the fourth order at three hertz, sampled as coarsely as the filter allows
        assert np.abs(found - average).max() < 0.015 * rate**order


@pytest.mark.parametrize("step", [1, 2, 5])
def test_weights_are_exact_for_parabolas_and_do_not_shift(step):
    period = 0.01
    filters = matched_filters(step, period)
    offset = period * np.arange(-filters.half, filters.half + 1)
    for weights, moments in (
        (filters.mean, [1.0, 0.0]),
        (filters.slope, [0.0, 1.0, 0.0]),
        (filters.curvature, [0.0, 0.0, 2.0, 0.0]),
        (filters.jerk, [0.0, 0.0, 0.0, 6.0]),
    ):
        for power, moment in enumerate(moments):
            assert weights @ offset**power == pytest.approx(moment, abs=1e-9)


def test_rows_two_triangles_apart_are_nearly_independent():
    filters = matched_filters(4, 0.01)
    autocorrelation = np.correlate(filters.mean, filters.mean, mode="full")
    centre = len(autocorrelation) // 2
    assert autocorrelation[centre + 8] / autocorrelation[centre] < 0.06


def test_a_filter_has_at_least_one_sample_a_step():
    assert [filter_step(period, 0.05) for period in (0.5, 0.05, 0.01, 0.001)] == [1, 1, 5, 50]


def test_a_signal_shorter_than_the_weights_has_no_rows():
    """As a log whose moves are all too short, or whose times run backwards."""
    found = filtered(np.arange(3.0), np.empty(0, np.int64), np.full(5, 0.2), np.ones(5))
    assert found.shape == (2, 0)
