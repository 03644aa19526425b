"""Velocity from positions by local least-squares lines."""

import numpy as np
import pytest

from frictioncli.logs.samples.differentiation import half_window, local_slope, max_gap

from .logs import back_and_forth


@pytest.mark.parametrize(("period", "half"), [(0.001, 4), (0.004, 4), (0.012, 2), (0.5, 1)])
def test_window_is_short(period, half):
    assert half_window(period) == half


def test_ramp_is_exact_at_any_spacing():
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.002, 0.02, 500))
    slope = local_slope(time, 3.0 - 41.5 * time, half=3, gap=1.0)
    np.testing.assert_allclose(slope, -41.5, rtol=1e-9)


def test_no_window_reaches_across_a_gap():
    time = np.concatenate((np.arange(0, 1, 0.01), np.arange(5, 6, 0.01)))
    values = np.where(time < 3, 10 * time, 700 - 20 * time)
    slope = local_slope(time, values, half=4, gap=max_gap(0.01))
    np.testing.assert_allclose(slope, np.where(time < 3, 10, -20), rtol=1e-9)


def test_a_lone_sample_has_no_slope():
    slope = local_slope(np.array([0.0, 5.0, 5.1]), np.array([1.0, 2.0, 3.0]), half=2, gap=1.0)
    np.testing.assert_allclose(slope, [np.nan, 10.0, 10.0])


def test_constant_speed_keeps_its_edges():
    """More than two samples inside the plateau nothing is smeared."""
    time, position, velocity, _ = back_and_forth()
    slope = local_slope(time, position, half=half_window(0.012), gap=1.0)
    plateau = np.abs(velocity) == 40.0
    inner = plateau & np.roll(plateau, 2) & np.roll(plateau, -2)
    np.testing.assert_allclose(slope[inner], velocity[inner], rtol=1e-9)


def test_quantised_positions_give_no_bias():
    time = np.arange(0, 20, 0.012)
    position = np.round(13.7 * time / 0.1) * 0.1
    slope = local_slope(time, position, half=2, gap=1.0)
    assert np.mean(slope) == pytest.approx(13.7, abs=0.05)
