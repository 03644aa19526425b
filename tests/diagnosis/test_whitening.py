"""Whitened noise is white, and pooling keeps what effects can show."""

import numpy as np
import pytest

from frictioncli.diagnosis.whitening import PairLayout, Whitener, innovations
from frictioncli.model.noise import Noise

NOISE = Noise(point=0.3, pair=0.2, drift=0.5, drift_time=100.0)


def layout(pairs=12, bins=4):
    run = np.repeat([0, 1], pairs // 2)
    time = np.concatenate([np.cumsum(np.arange(1.0, pairs // 2 + 1) * 9)] * 2)
    return PairLayout.of(
        row_pair=np.repeat(np.arange(pairs), bins),
        run=run,
        time=time,
        speed=np.tile([20.0, 60.0], pairs // 2),
        position=np.tile(np.arange(bins) * 5.0, pairs),
    )


def test_innovations_invert_the_covariance():
    """W V W' is the identity for V of its definition."""
    pairs = layout()
    apart = np.abs(pairs.time[:, None] - pairs.time[None, :])
    same = pairs.run[:, None] == pairs.run[None, :]
    extra = np.linspace(0.0, 0.1, len(pairs.time))
    white = np.diag(0.2**2 + 0.3**2 / 4 + extra)
    covariance = 0.5**2 * np.exp(-apart / 100.0) * same + white
    matrix = innovations(pairs, NOISE, extra)
    np.testing.assert_allclose(matrix @ covariance @ matrix.T, np.eye(12), atol=1e-10)


def test_pooled_contrasts_are_orthonormal_sums():
    pairs = layout()
    pooling = pairs.pooling.toarray()
    np.testing.assert_allclose(pooling @ pooling.T, np.eye(len(pooling)), atol=1e-12)


def test_what_is_alike_in_neighbouring_pairs_survives_pooling():
    """A ripple with one phase everywhere keeps its whole norm."""
    pairs = layout()
    ripple = np.tile([1.0, -1.0, 1.0, -1.0], 12)
    assert np.linalg.norm(pairs.contrasts(ripple[:, None])) == pytest.approx(np.sqrt(48.0))


def test_white_noise_stays_white():
    """2,000 draws of the noise, whitened, have unit variance in every row that has any."""
    pairs = layout()
    generator = np.random.default_rng(0)
    whitener = Whitener.of(pairs, NOISE, np.zeros(12))
    keep = np.exp(-np.diff(pairs.time[:6]) / 100.0)
    drawn = []
    for _ in range(2000):
        wander = []
        for _ in range(2):
            state = [0.5 * generator.normal()]
            for k in keep:
                state.append(k * state[-1] + 0.5 * np.sqrt(1 - k**2) * generator.normal())
            wander += state
        common = np.array(wander) + 0.2 * generator.normal(size=12)
        drawn.append(np.repeat(common, 4) + 0.3 * generator.normal(size=48))
    white = whitener.whiten(np.array(drawn).T)
    between = white[-12:]
    np.testing.assert_allclose(np.var(between, axis=1), 1.0, atol=0.12)
    inside = white[:-12]
    # one of four bins is lost to the pair's mean
    assert np.mean(np.var(inside, axis=1)) == pytest.approx(0.75, abs=0.05)
