"""Autoregressive noise, whose coefficients are known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from frictioncli.regression.whitening import places, whitening


def test_the_process_is_found_in_stretches():
    generator = np.random.default_rng(1)
    noise = lfilter([1.0], [1.0, -0.6, 0.2], generator.standard_normal(60_000))
    place = np.arange(60_000) % 50
    found = whitening(noise, place)
    assert found.order == 2
    np.testing.assert_allclose(found.predictors[2], [0.6, -0.2], atol=0.02)
    assert found.deviations[2] == pytest.approx(1.0, rel=0.01)


def test_white_noise_stays_as_it_is():
    noise = 3.0 * np.random.default_rng(2).standard_normal(20_000)
    found = whitening(noise, np.arange(20_000))
    assert found.order == 0
    np.testing.assert_allclose(found.apply(noise, np.arange(20_000)), noise / 3.0, rtol=0.02)


def test_columns_are_whitened_as_the_noise_is():
    generator = np.random.default_rng(3)
    noise = lfilter([1.0], [1.0, -0.9], generator.standard_normal(20_000))
    place = np.arange(20_000)
    white = whitening(noise, place).apply(np.column_stack([noise, 2 * noise]), place)
    np.testing.assert_allclose(white[:, 1], 2 * white[:, 0])
    assert abs(np.corrcoef(white[1:, 0], white[:-1, 0])[0, 1]) < 0.02


def test_a_gap_or_another_move_begins_anew():
    assert places(np.array([3, 3, 3, 3, 4, 4]), np.array([7, 8, 10, 11, 12, 13])).tolist() == [
        *[0, 1, 0, 1],
        *[0, 1],
    ]
