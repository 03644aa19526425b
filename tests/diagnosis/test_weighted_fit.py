"""Pooling keeps what effects can show, and weighted estimates know how far they can be off."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.model.noise import Noise
from tests.diagnosis import dense_noise

NOISE = Noise(point=0.3, pair=0.2, drift=0.5, drift_time=100.0)
QUIET = Noise(point=0.2, pair=0.1, drift=0.1, drift_time=40.0)
PAIRS = dense_noise.layout(9, 7, bins=4)
EXTRA = np.linspace(0.0, 0.1, 16)
ROWS = 64


def dense(pairs, noise, extra):
    """Covariance of the pair means, from its definition."""
    white = noise.pair**2 + noise.point**2 / 4 + extra
    return noise.drift**2 * dense_noise.alike(pairs, noise.drift_time) + np.diag(white)


def test_pooled_contrasts_are_orthonormal_sums():
    pooling = PAIRS.pooling.toarray()
    np.testing.assert_allclose(pooling @ pooling.T, np.eye(len(pooling)), atol=1e-12)


def test_what_is_alike_in_neighbouring_pairs_survives_pooling():
    """A ripple with one phase everywhere keeps its whole norm."""
    ripple = np.tile([1.0, -1.0, 1.0, -1.0], 16)
    assert np.linalg.norm(PAIRS.contrasts(ripple[:, None])) == pytest.approx(np.sqrt(64.0))


def test_only_neighbours_of_one_speed_and_run_are_pooled():
    """Six pairs at 20 deg/s, one at 40, and one of another run: 5 + 1, 1 and 1 by each bin."""
    pairs = PairLayout.of(
        row_pair=np.repeat(np.arange(8), 2),
        run=np.array([0, 0, 0, 0, 0, 0, 0, 1]),
        time=np.arange(8.0),
        speed=np.array([20.0, 20.1, 20.0, 40.0, 20.0, 20.0, 20.0, 20.0]),
        position=np.tile([0.0, 5.0], 8),
    )
    counts = sorted(np.count_nonzero(pairs.pooling.toarray(), axis=1))
    assert counts == [1, 1, 1, 1, 1, 1, 5, 5]


def test_white_deviations_stay_white():
    """Of four bins one is lost to the pair's mean."""
    noise = 0.3 * np.random.default_rng(0).normal(size=(ROWS, 2000))
    inside = PAIRS.contrasts(noise) / 0.3
    assert np.mean(np.var(inside, axis=1)) == pytest.approx(0.75, abs=0.03)


@pytest.mark.parametrize("noise", [NOISE, replace(NOISE, drift=0.0)], ids=["drift", "no drift"])
def test_weights_hold_deviation_and_correlation_of_the_pair_means(noise):
    weights = Weights.of(PAIRS, noise, EXTRA)
    expected = dense(PAIRS, noise, EXTRA)
    np.testing.assert_allclose(weights.deviation, np.sqrt(np.diag(expected)))
    size = np.outer(weights.deviation, weights.deviation)
    np.testing.assert_allclose(correlation(weights) * size, expected, atol=1e-12)


def correlation(weights):
    """Correlation of the pair means' noise; that of deviations inside pairs must be none."""
    count = len(weights.weighted(np.zeros((ROWS, 1))))
    whole = weights.correlated(np.eye(count))
    inside, between = count - 16, slice(count - 16, count)
    np.testing.assert_array_equal(whole[:inside], np.eye(count)[:inside])
    assert not whole[between, :inside].any()
    return whole[between, between]


def weighted_fit():
    return WeightedFit(Weights.of(PAIRS, NOISE, EXTRA), Weights.of(PAIRS, QUIET, 0 * EXTRA))


def columns(seed):
    """Functions of the angle and of the pair, alike where they are pooled."""
    generator = np.random.default_rng(seed)
    angle = np.tile(generator.normal(size=(4, 3)), (16, 1))
    return angle + np.repeat(generator.normal(size=(16, 3)), 4, axis=0)


@given(st.integers(0, 10_000))
@settings(max_examples=25)
def test_coefficients_are_those_of_weighted_rows(seed):
    """Rows in units of point noise about their pair, and each pair's mean once."""
    friction, load = columns(seed), columns(seed + 1)
    generator = np.random.default_rng(seed)
    targets = generator.normal(size=ROWS), generator.normal(size=ROWS)
    rows, data = [], []
    for part, target, weights in zip(
        (friction, load), targets, (weighted_fit().friction, weighted_fit().load), strict=True
    ):
        for values, into in ((part, rows), (target[:, None], data)):
            means = values.reshape(16, 4, -1).mean(axis=1)
            into.append((values - np.repeat(means, 4, axis=0)) / weights.point)
            into.append(means / weights.deviation[:, None])
    expected = np.linalg.lstsq(np.vstack(rows), np.vstack(data)[:, 0], rcond=None)[0]
    found = weighted_fit().coefficients(friction, load, targets)
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9)


def test_coefficients_by_the_covariance_are_those_of_generalised_least_squares():
    """Deviations from the pair means in units of point noise, means by the dense covariance."""
    friction, load = columns(5), columns(6)
    generator = np.random.default_rng(7)
    targets = generator.normal(size=ROWS), generator.normal(size=ROWS)
    normal, right = np.zeros((3, 3)), np.zeros(3)
    for part, target, noise, extra in (
        (friction, targets[0], NOISE, EXTRA),
        (load, targets[1], QUIET, 0 * EXTRA),
    ):
        precision = np.linalg.inv(dense(PAIRS, noise, extra))
        # within a pair only its deviations count, of any mean
        within = np.kron(np.eye(16), np.eye(4) - 0.25) / noise.point**2
        means = np.kron(np.eye(16), np.full((1, 4), 0.25))
        whole = within + means.T @ precision @ means
        normal += part.T @ whole @ part
        right += part.T @ whole @ target
    fit = weighted_fit().by_covariance()
    found = fit.coefficients(friction, load, targets)
    np.testing.assert_allclose(found, np.linalg.solve(normal, right), rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(
        fit.error_covariance(friction, load), np.linalg.inv(normal), rtol=1e-6
    )


def test_covariance_is_what_repeated_noise_makes_of_the_estimates():
    """4,000 draws of drift, pair and point noise in both channels: errors are within 5 %."""
    draws = 4000
    generator = np.random.default_rng(2)
    friction, load = columns(5), columns(6)
    tool = weighted_fit()
    drawn = []
    for noise, extra in ((NOISE, EXTRA), (QUIET, 0 * EXTRA)):
        common = dense(PAIRS, noise, extra) - noise.point**2 / 4 * np.eye(16)
        means = np.linalg.cholesky(common) @ generator.normal(size=(16, draws))
        drawn.append(np.repeat(means, 4, axis=0) + noise.point * generator.normal(size=(64, draws)))
    covariance = tool.error_covariance(friction, load)
    estimates = np.array(
        [tool.coefficients(friction, load, (drawn[0][:, i], drawn[1][:, i])) for i in range(draws)]
    )
    size = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(estimates.std(axis=0), size, rtol=0.06)
    np.testing.assert_allclose(
        np.corrcoef(estimates.T), covariance / np.outer(size, size), atol=0.06
    )
    assert np.abs(estimates.mean(axis=0) / size).max() < 4 / np.sqrt(draws)


def test_a_column_of_zeros_has_a_coefficient_of_zero():
    friction, load = columns(7), columns(8)
    friction[:, 1] = load[:, 1] = 0.0
    found = weighted_fit().coefficients(friction, load, (friction @ [1.0, 5.0, 2.0], load[:, 0]))
    covariance = weighted_fit().error_covariance(friction, load)
    assert found[1] == pytest.approx(0.0, abs=1e-12)
    assert covariance[1, 1] == pytest.approx(0.0, abs=1e-12)
    assert np.isfinite(found).all()


def test_torque_that_is_not_fitted_adds_to_the_errors_what_it_does_to_the_estimates():
    """4,000 draws of it without noise: errors are within 6 %; it counts only where asked for."""
    draws = 4000
    friction, load = columns(5), columns(6)
    alone = weighted_fit()
    tool = alone.beside(columns(9)[:, :2], columns(10)[:, :2]).beside(columns(11), columns(12))
    smooth = [np.hstack(one) for one in ((columns(9)[:, :2], columns(11)),)]
    smooth += [np.hstack([columns(10)[:, :2], columns(12)])]
    random = np.random.default_rng(3).normal(size=(5, draws))
    added = [one @ random for one in smooth]
    estimates = np.array(
        [tool.coefficients(friction, load, (added[0][:, i], added[1][:, i])) for i in range(draws)]
    )
    noise = alone.error_covariance(friction, load)
    np.testing.assert_allclose(tool.error_covariance(friction, load), noise)
    covariance = tool.error_covariance(friction, load, whole=True) - noise
    size = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(estimates.std(axis=0), size, rtol=0.06)
    np.testing.assert_allclose(
        np.corrcoef(estimates.T), covariance / np.outer(size, size), atol=0.06
    )


def test_rows_that_weigh_alike_give_ordinary_least_squares():
    """Coefficients as numpy finds them, errors as many draws of the noise show them.

    Columns along the angle that are alike in all pairs, and one that differs from pair to pair.
    """
    generator = np.random.default_rng(3)
    waves = np.tile(generator.normal(size=(2, 4, 2)), (1, 16, 1))
    pairs = np.repeat(generator.normal(size=(2, 16, 1)), 4, axis=1)
    friction, load = np.concatenate([waves, pairs], axis=2)
    truth = np.array([1.0, -2.0, 0.5])
    noisy = Weights.of(PAIRS, NOISE, EXTRA).alike()
    fit = WeightedFit(noisy, noisy)
    between = np.linalg.cholesky(dense(PAIRS, replace(NOISE, point=0.0), EXTRA))
    rows = np.repeat(np.arange(16), 4)
    estimates = []
    for _ in range(2000):
        targets = [
            column @ truth
            + (between @ generator.normal(size=16))[rows]
            + NOISE.point * generator.normal(size=ROWS)
            for column in (friction, load)
        ]
        estimates.append(fit.coefficients(friction, load, (targets[0], targets[1])))
    expected = np.linalg.lstsq(np.vstack([friction, load]), np.concatenate(targets), rcond=None)[0]
    np.testing.assert_allclose(estimates[-1], expected, rtol=1e-9)
    errors = np.sqrt(np.diag(fit.error_covariance(friction, load)))
    np.testing.assert_allclose(np.std(estimates, axis=0), errors, rtol=0.06)
