"""Evidence where the noise is estimated anew, against dense algebra, drawn noise and a search."""

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.optimize import minimize

from frictioncli.design.expected_evidence import candidate_noises
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.model.noise import Noise, pair_covariance

TRUE = Noise(point=0.3, pair=0.2, drift=0.4, drift_time=600.0)
BINS, STEP = 6, 60.0


@pytest.fixture(scope="module")
def layout():
    """Two runs of thirty and twenty pairs, one a minute."""
    counts = np.array([30, 20])
    pairs = np.arange(counts.sum())
    time = np.concatenate([np.arange(count) * STEP for count in counts])
    run = np.repeat([0, 1], counts)
    return PairLayout.of(
        row_pair=np.repeat(pairs, BINS),
        run=run,
        time=time,
        speed=np.full(len(pairs), 50.0),
        position=np.tile(np.arange(BINS) * 2.0, len(pairs)),
    )


def base(layout):
    """A mean, and two laws of time; one column twice, as collinear bases have."""
    slow = layout.time / 1000.0
    return np.column_stack([np.ones_like(slow), slow, np.sin(layout.time / 130.0), 3.0 * slow])


def dense(layout, noise):
    """Covariance of pair means by its definition."""
    apart = np.abs(layout.time[:, np.newaxis] - layout.time)
    same = layout.run[:, np.newaxis] == layout.run
    white = (noise.pair**2 + noise.point**2 / layout.bins) * np.eye(len(layout.time))
    return white + noise.drift**2 * same * np.exp(-apart / noise.drift_time)


def torque_of(layout, kind):
    """A torque of RMS 1 that grows from run to run and within them, or changes pair by pair."""
    slow = layout.run * 1.0 + np.tanh((layout.time - 700.0) / 400.0)
    quick = (-1.0) ** np.arange(len(layout.time))
    torque = slow if kind == "slow" else quick
    return torque / np.sqrt(np.mean(np.square(torque)))


def left_of(layout, noise, torque, outside):
    """Squared length of a torque that the base leaves, by what is orthogonal to the base."""
    rest = outside.T @ torque
    return float(rest @ np.linalg.solve(outside.T @ dense(layout, noise) @ outside, rest))


def test_true_noise_under_others_is_as_drawn(layout):
    """Squares of drawn noise after generalised least squares, and determinants off the base."""
    found = candidate_noises(layout, TRUE, np.zeros_like(layout.time), base(layout))
    assert found.noises[0] == TRUE
    assert found.degrees_of_freedom == len(layout.time) - 3
    outside = null_space(base(layout).T)
    draws = np.random.default_rng(3).multivariate_normal(
        np.zeros(len(layout.time)), dense(layout, TRUE), size=4000
    )
    first = np.linalg.slogdet(outside.T @ dense(layout, TRUE) @ outside)[1]
    assert found.expected_squares[0] == pytest.approx(found.degrees_of_freedom)
    for noise, square, determinant in zip(
        found.noises, found.expected_squares, found.log_determinants, strict=True
    ):
        root = np.linalg.cholesky(np.linalg.inv(dense(layout, noise)))
        design, target = root.T @ base(layout), root.T @ draws.T
        rest = target - design @ np.linalg.lstsq(design, target, rcond=1e-11)[0]
        squares = np.sum(np.square(rest), axis=0)
        error = squares.std() / np.sqrt(len(squares))
        assert square == pytest.approx(squares.mean(), abs=4 * error)
        own = np.linalg.slogdet(outside.T @ dense(layout, noise) @ outside)[1]
        assert determinant == pytest.approx(own - first, abs=1e-6)


def test_without_a_torque_there_is_no_evidence(layout):
    found = candidate_noises(layout, TRUE, np.zeros_like(layout.time), base(layout))
    assert found.log_likelihood_ratio(np.zeros((len(found.noises), 2)))[0] == pytest.approx(
        0.0, abs=1e-9
    )


@pytest.mark.parametrize("kind", ["slow", "quick"])
@pytest.mark.parametrize("size", [0.3, 1.0, 3.0])
def test_evidence_is_nearly_that_of_any_noise(layout, kind, size):
    """Against a search for the strength and the time of the drift that suit the torque best."""
    found = candidate_noises(layout, TRUE, np.zeros_like(layout.time), base(layout))
    torque, outside = size * torque_of(layout, kind), null_space(base(layout).T)
    left = np.array([left_of(layout, noise, torque, outside) for noise in found.noises])
    true = outside.T @ dense(layout, TRUE) @ outside

    def doubled(logs):
        strength, time = np.exp(logs)
        noise = Noise(point=TRUE.point, pair=TRUE.pair, drift=strength, drift_time=time)
        whole = outside.T @ dense(layout, noise) @ outside
        square = np.trace(np.linalg.solve(whole, true)) + left_of(layout, noise, torque, outside)
        return (
            found.degrees_of_freedom * np.log(square / found.degrees_of_freedom)
            + np.linalg.slogdet(whole)[1]
        )

    bounds = [(np.log(0.04), np.log(4.0)), (np.log(60.0), np.log(1740.0))]
    starts = [np.log([TRUE.drift, TRUE.drift_time]), np.log([2.0, 1700.0]), np.log([0.4, 70.0])]
    best = min(minimize(doubled, start, bounds=bounds).fun for start in starts)
    searched = best - np.linalg.slogdet(true)[1]
    evidence = float(found.log_likelihood_ratio(left)[0])
    assert searched - 1e-6 <= evidence <= 1.15 * searched + 0.5


def test_a_slow_torque_tells_less_than_a_quick_one(layout):
    """Both as far from nothing under the true noise; wandering may take only the slow one."""
    found = candidate_noises(layout, TRUE, np.zeros_like(layout.time), base(layout))
    outside = null_space(base(layout).T)
    evidence = {}
    for kind in ("slow", "quick"):
        torque = torque_of(layout, kind)
        torque = torque * np.sqrt(60.0 / left_of(layout, TRUE, torque, outside))
        left = np.array([left_of(layout, noise, torque, outside) for noise in found.noises])
        assert left[0] == pytest.approx(60.0)
        evidence[kind] = float(found.log_likelihood_ratio(left)[0])
    known = found.degrees_of_freedom * np.log(1 + 60.0 / found.degrees_of_freedom)
    assert 0.9 * known < evidence["quick"] <= known
    assert evidence["slow"] < 0.75 * evidence["quick"]


def test_covariances_are_those_of_the_model(layout):
    """The dense covariance that these tests lean on is that of the noise model."""
    covariance = pair_covariance(TRUE, time=layout.time, run=layout.run, bins=layout.bins)
    np.testing.assert_allclose(
        covariance.solve(dense(layout, TRUE)), np.eye(len(layout.time)), atol=1e-8
    )
