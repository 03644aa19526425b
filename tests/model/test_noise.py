"""The banded algebra of the noise model against dense matrices."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.model.noise import (
    Noise,
    pair_covariance,
    plausible_noise,
    restricted_log_likelihood,
)

TIME = np.array([0.0, 10.0, 25.0, 400.0, 0.0, 30.0, 31.0])
RUN = np.array([0, 0, 0, 0, 1, 1, 1])
BINS = np.array([30.0, 30, 20, 30, 30, 10, 30])
NOISE = Noise(point=0.3, pair=0.25, drift=0.4, drift_time=120.0)


def dense():
    """The covariance as its definition says it."""
    apart = np.abs(TIME[:, None] - TIME[None, :])
    same = RUN[:, None] == RUN[None, :]
    drift = 0.4**2 * np.exp(-apart / 120.0) * same
    return drift + np.diag(0.25**2 + 0.3**2 / BINS)


def test_solve_and_times_agree_with_the_dense_matrix():
    covariance = pair_covariance(NOISE, time=TIME, run=RUN, bins=BINS)
    right = np.random.default_rng(0).normal(size=(7, 3))
    np.testing.assert_allclose(covariance.solve(right), np.linalg.solve(dense(), right), rtol=1e-8)
    np.testing.assert_allclose(covariance.times(right), dense() @ right, rtol=1e-8)
    assert covariance.log_determinant == pytest.approx(np.linalg.slogdet(dense())[1], rel=1e-9)


def test_whitened_columns_are_the_lower_triangular_innovations():
    """The Cholesky factor of the covariance, in the order of the pairs, makes columns white."""
    covariance = pair_covariance(NOISE, time=TIME, run=RUN, bins=BINS)
    right = np.random.default_rng(0).normal(size=(7, 3))
    expected = np.linalg.solve(np.linalg.cholesky(dense()), right)
    np.testing.assert_allclose(covariance.whitened(right), expected, rtol=1e-8)


def test_restricted_likelihood_agrees_with_its_definition():
    """-1/2 (ln|V| + ln|X'V^-1 X| + r'Pr) with P = V^-1 - V^-1 X (X'V^-1X)^-1 X'V^-1."""
    generator = np.random.default_rng(1)
    design, residual = generator.normal(size=(7, 2)), generator.normal(size=7)
    inverse = np.linalg.inv(dense())
    information = design.T @ inverse @ design
    middle = inverse - inverse @ design @ np.linalg.inv(information) @ design.T @ inverse
    expected = -0.5 * (
        np.linalg.slogdet(dense())[1]
        + np.linalg.slogdet(information)[1]
        + residual @ middle @ residual
    )
    covariance = pair_covariance(NOISE, time=TIME, run=RUN, bins=BINS)
    found = restricted_log_likelihood(covariance, residual, design)
    assert found == pytest.approx(expected, rel=1e-8)


def test_diagonal_of_the_inverse_agrees_with_the_dense_matrix():
    covariance = pair_covariance(NOISE, time=TIME, run=RUN, bins=BINS)
    expected = np.diag(np.linalg.inv(dense()))
    np.testing.assert_allclose(covariance.inverse_diagonal(), expected, rtol=1e-8)


def test_drawn_disturbances_have_the_covariance():
    covariance = pair_covariance(NOISE, time=TIME, run=RUN, bins=BINS)
    generator = np.random.default_rng(2)
    drawn = np.array([covariance.draw(generator) for _ in range(20_000)])
    np.testing.assert_allclose(np.cov(drawn.T), dense(), atol=0.01)


def test_known_noise_is_found():
    """600 pairs, pair 0.3 and drift 0.5 N·m over 20 min: found within a fifth, a half for time."""
    time = 60.0 * np.arange(600.0)
    run = np.zeros(600, dtype=int)
    bins = np.full(600, 30.0)
    truth = Noise(point=0.3, pair=0.3, drift=0.5, drift_time=1200.0)
    residual = pair_covariance(truth, time=time, run=run, bins=bins).draw(np.random.default_rng(3))
    layout = {"time": time, "run": run, "bins": bins}
    design = np.ones((600, 1))
    noise, weight = plausible_noise(residual=residual, design=design, point=0.3, **layout)[0]
    assert noise.pair == pytest.approx(0.3, rel=0.2)
    assert noise.drift == pytest.approx(0.5, rel=0.2)
    assert noise.drift_time == pytest.approx(1200.0, rel=0.6)
    assert 0 < weight <= 1
    # no other noise with its correlation time is likelier, to the first order
    likelihood = [
        restricted_log_likelihood(pair_covariance(one, **layout), residual, design)
        for one in (
            noise,
            replace(noise, pair=noise.pair * 1.001),
            replace(noise, pair=noise.pair / 1.001),
            replace(noise, drift=noise.drift * 1.001),
            replace(noise, drift=noise.drift / 1.001),
        )
    ]
    np.testing.assert_allclose(likelihood[1:], likelihood[0], rtol=0, atol=1e-3)
    assert max(likelihood) == likelihood[0]


@pytest.mark.parametrize(("distance", "drift_time"), [(10.0, 1e4), (10.0, 10.0), (10.0, 0.5)])
def test_what_is_new_with_a_pair_is_what_the_pair_before_does_not_tell(distance, drift_time):
    """The variance of the drift that is left once that at the pair before is known."""
    noise = replace(NOISE, drift_time=drift_time)
    both = noise.drift**2 * np.exp(-np.array([[0.0, distance], [distance, 0.0]]) / drift_time)
    left = both[1, 1] - both[0, 1] ** 2 / both[0, 0]
    expected = np.sqrt(noise.point**2 + noise.pair**2 + left)
    assert noise.unpredictable(distance) == pytest.approx(expected, rel=1e-9)
