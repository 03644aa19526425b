"""Noise within pairs beside simulated noise with memory along the move."""

import numpy as np
import pytest

from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.data.within_noise import WithinNoise, whitening, within_noise_of

POSITION = np.arange(2.5, 175, 5.0)
SPEEDS = (20.0, 50.0, 100.0)


def noise(generator, pairs, speed, share, time, deviation=0.3):
    """Return noise with memory along each move, step by step; shape (pairs, bins). [N·m]"""
    keep = np.exp(-5.0 / speed / time)
    wander = generator.normal(size=(pairs, len(POSITION)))
    for i in range(1, len(POSITION)):
        wander[:, i] = keep * wander[:, i - 1] + np.sqrt(1 - keep**2) * wander[:, i]
    white = generator.normal(size=wander.shape)
    return deviation * (np.sqrt(share) * wander + np.sqrt(1 - share) * white)


def experiment(seed, share=0.7, time=0.25, pairs=60):
    """Return a layout of so many pairs at three speeds in turn, and noise of its rows."""
    generator = np.random.default_rng(seed)
    speed = np.resize(SPEEDS, pairs)
    rows = np.zeros((pairs, len(POSITION)))
    for one in SPEEDS:
        rows[speed == one] = noise(generator, int(np.sum(speed == one)), one, share, time)
    layout = PairLayout.of(
        row_pair=np.repeat(np.arange(pairs), len(POSITION)),
        run=np.zeros(pairs, int),
        time=20.0 * np.arange(pairs),
        speed=speed,
        position=np.tile(POSITION, pairs),
    )
    return layout, rows.ravel()[:, np.newaxis], np.tile(POSITION, pairs)


@pytest.mark.slow
@pytest.mark.parametrize(("share", "time"), [(0.75, 0.12), (0.5, 0.25), (0.9, 0.5)])
def test_correlation_is_that_of_the_noise(share, time):
    """Twenty experiments of 60 pairs; neighbours of a fast move tell most."""
    found = [
        layout.with_noise_from(rows, position).noise
        for layout, rows, position in (experiment(seed, share, time) for seed in range(20))
    ]
    apart = 5.0 / 100.0
    expected = share * np.exp(-apart / time)
    neighbours = [one.share * np.exp(-apart / one.time) for one in found]
    assert np.mean(neighbours) == pytest.approx(expected, abs=0.04)
    assert np.median([one.share for one in found]) == pytest.approx(share, abs=0.16)
    assert np.median([one.time for one in found]) == pytest.approx(time, rel=1.1)


def test_white_noise_has_no_memory_worth_the_name():
    found = [
        layout.with_noise_from(rows, position).noise
        for layout, rows, position in (experiment(seed, 0.0, 0.25) for seed in range(10))
    ]
    near = [one.share * np.exp(-0.05 / one.time) for one in found]
    assert np.mean(near) < 0.04


def test_effects_that_neighbouring_pairs_share_change_nothing():
    """A ripple, gravity, friction that goes with speed: whatever is alike in pairs of one speed."""
    layout, rows, position = experiment(3)
    speed = layout.speed[layout.row_pair]
    torque = np.sin(7 * np.radians(position)) * speed / 10 + 90 * np.cos(np.radians(position))
    pairs = 3.0 * np.sin(layout.time / 300.0)[layout.row_pair]
    disturbed = rows + (torque + pairs)[:, np.newaxis]
    plain = layout.with_noise_from(rows, position)
    again = layout.with_noise_from(disturbed, position)
    assert again.noise == plain.noise
    np.testing.assert_allclose(
        again.pure_deviation(disturbed, position), plain.pure_deviation(rows, position), rtol=1e-6
    )


@pytest.mark.parametrize("share", [0.0, 0.7])
def test_pure_deviation_is_that_of_the_noise(share):
    """0.3 in the mean of 40 experiments, each with the memory that is true."""
    found = []
    for seed in range(40):
        layout, rows, position = experiment(100 + seed, share, 0.25, pairs=30)
        own = PairLayout.of(
            row_pair=layout.row_pair,
            run=layout.run,
            time=layout.time,
            speed=layout.speed,
            position=position,
            noise=WithinNoise(time=0.25, share=share),
        )
        found.append(float(own.pure_deviation(rows, position)[0]) ** 2)
    assert np.mean(found) == pytest.approx(0.3**2, rel=0.02)


def test_a_payload_that_comes_and_goes_is_no_noise():
    """It is there in a third of the pairs, and comes and goes within groups of neighbours."""
    layout, rows, position = experiment(2, pairs=90)
    carried = (layout.row_pair // 12) % 3 == 1
    course = 4.0 * np.cos(np.radians(position)) * carried
    with_payload = rows + course[:, np.newaxis]
    layout = layout.split_at_jumps(with_payload, position).with_noise_from(with_payload, position)
    assert layout.pure_deviation(with_payload, position) == pytest.approx(0.3, rel=0.1)


def test_pooled_deviations_keep_what_a_payload_for_some_pairs_changes():
    layout, rows, position = experiment(2, pairs=90)
    carried = (layout.row_pair // 12) % 3 == 1
    course = (4.0 * np.cos(np.radians(position)) * carried)[:, np.newaxis]
    split = layout.split_at_jumps(rows + course, position)
    own = (course - split.means(course)[layout.row_pair])[:, 0]
    assert np.sum(np.square(split.contrasts(course))) == pytest.approx(np.sum(np.square(own)))
    assert np.sum(np.square(layout.contrasts(course))) < 0.9 * np.sum(np.square(own))
    assert layout.split_at_jumps(rows, position) is layout


def test_whitened_deviations_are_white():
    """Pooled deviations of many draws: variance 1 along every direction but the constant."""
    generator = np.random.default_rng(8)
    pairs, draws, speed = 5, 4000, 100.0
    row_pair = np.repeat(np.arange(pairs), len(POSITION))
    layout = PairLayout.of(
        row_pair=row_pair,
        run=np.zeros(pairs, int),
        time=np.arange(5.0),
        speed=np.full(pairs, speed),
        position=np.tile(POSITION, pairs),
        noise=WithinNoise(time=0.25, share=0.7),
    )
    drawn = np.stack([noise(generator, pairs, speed, 0.7, 0.25).ravel() for _ in range(draws)], 1)
    covariance = np.cov(layout.contrasts(drawn / 0.3))
    expected = np.eye(len(POSITION)) - 1 / len(POSITION)
    assert np.abs(covariance - expected).max() < 5 * np.sqrt(2 / draws)
    white = PairLayout.of(
        row_pair=row_pair,
        run=layout.run,
        time=layout.time,
        speed=layout.speed,
        position=np.tile(POSITION, pairs),
    )
    assert np.abs(np.cov(white.contrasts(drawn / 0.3)) - expected).max() > 0.4


def test_whitening_is_the_pseudo_root_of_the_covariance_of_deviations():
    correlation = WithinNoise(time=0.1, share=0.9).correlation(POSITION, 70.0)
    np.testing.assert_allclose(np.diag(correlation), 1.0)
    apart = (POSITION[4] - POSITION[1]) / 70.0
    assert correlation[1, 4] == pytest.approx(0.9 * np.exp(-apart / 0.1))
    matrix, values = whitening(correlation)
    centre = np.eye(len(POSITION)) - 1 / len(POSITION)
    covariance = centre @ correlation @ centre
    np.testing.assert_allclose(matrix @ matrix, np.linalg.pinv(covariance), atol=1e-9)
    np.testing.assert_allclose(matrix @ np.ones(len(POSITION)), 0.0, atol=1e-9)
    log = np.linalg.slogdet(covariance + 1 / len(POSITION))[1]
    assert np.sum(np.log(values)) == pytest.approx(log)


def test_too_little_pure_error_is_taken_for_white_noise():
    """Two pairs of 20 bins: 19 degrees of freedom."""
    block = (50.0, POSITION[:20], np.random.default_rng(0).normal(size=(1, 2, 20)))
    assert within_noise_of([block]) == WithinNoise()
    assert within_noise_of([]) == WithinNoise()
    layout, rows, position = experiment(0, pairs=3)
    assert layout.pure_deviation(rows, position) is None
