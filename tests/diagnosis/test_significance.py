"""Chance is what it says, however many shapes were tried."""

import numpy as np
import pytest
from scipy import stats

from frictioncli.diagnosis.significance import (
    chance,
    credible_set,
    log_evidence,
    probabilities,
    tries,
)


def test_one_shape_is_one_try():
    columns = np.random.default_rng(0).normal(size=(500, 1, 2))
    count, freedom = tries(columns, np.random.default_rng(1))
    assert freedom == 2
    assert count == pytest.approx(1.0, abs=0.25)


def test_orthogonal_shapes_count_one_by_one():
    """Of ten independent scores the greatest passes the 5 % limit of one with 1 - 0.95^10."""
    columns = np.eye(500)[:, :10].reshape(500, 10, 1)
    count, freedom = tries(columns, np.random.default_rng(1))
    assert freedom == 1
    assert count == pytest.approx(10.0, rel=0.3)


def test_equal_shapes_count_once():
    column = np.random.default_rng(0).normal(size=(500, 1))
    count, _ = tries(np.repeat(column, 20, axis=1).reshape(500, 20, 1), np.random.default_rng(1))
    assert count == pytest.approx(1.0, abs=0.25)


def test_columns_of_zeros_say_nothing():
    assert tries(np.zeros((50, 3, 1)), np.random.default_rng(1)) == (1.0, 0)
    assert chance(100.0, 0, 1.0) == 1.0


def test_chance_of_one_try_is_the_chi_squared_tail():
    assert chance(9.0, 1, 1.0) == pytest.approx(0.0026998, rel=1e-4)
    assert chance(9.0, 1, 20.0) == pytest.approx(1 - (1 - 0.0026998) ** 20, rel=1e-4)


def test_noise_passes_as_often_as_its_chance_says():
    generator = np.random.default_rng(3)
    columns = generator.normal(size=(200, 8, 1))
    count, freedom = tries(columns, np.random.default_rng(1))
    size = np.linalg.norm(columns[:, :, 0], axis=0)
    passed = 0
    for _ in range(2000):
        noise = generator.normal(size=200)
        best = np.max(np.square(columns[:, :, 0].T @ noise / size))
        passed += chance(best, freedom, count) < 0.05
    # 2,000 tries of 5 %: 100, with a standard deviation of 10
    assert 65 <= passed <= 135


def test_evidence_prefers_the_better_and_the_simpler():
    assert log_evidence(np.array([40.0]), 1) > log_evidence(np.array([20.0]), 1)
    assert log_evidence(np.array([40.0]), 1) > log_evidence(np.array([40.0]), 3)
    assert log_evidence(np.array([40.0]), 1) > log_evidence(np.array([40.0, 0, 0, 0]), 1)


def test_credible_set_is_the_least_that_reaches_its_level():
    share = probabilities({"a": 0.0, "b": np.log(3.0), "c": np.log(6.0)})
    assert share == pytest.approx({"c": 0.6, "b": 0.3, "a": 0.1})
    assert credible_set(share) == ("c", "b", "a")
    assert credible_set(share, 0.85) == ("c", "b")
    assert credible_set({"a": 0.99, "b": 0.01}) == ("a",)


def test_far_tails_do_not_vanish():
    assert 0 < chance(600.0, 1, 10.0) < 1e-100 or chance(600.0, 1, 10.0) < 10 * stats.chi2.sf(
        600, 1
    )
