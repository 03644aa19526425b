"""The spectra are the noise that they stand for."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from frictioncli.diagnosis.noise.spectra import STRENGTHS, InverseCovariances, spectra_of
from tests.diagnosis.dense_noise import alike, layout

PAIRS = layout(7, 5, bins=[2, 3, 4] * 4)
EXTRA = np.linspace(0.0, 0.2, 12)
RESIDUAL = np.random.default_rng(1).normal(size=12)
SPECTRA = spectra_of(PAIRS, 0.3, EXTRA, RESIDUAL)


@pytest.mark.parametrize("number", range(len(SPECTRA.spectra)))
@pytest.mark.parametrize("strength", STRENGTHS)
def test_eigenvectors_and_values_give_back_the_covariance(number, strength):
    """H^1/2 U (1 + rho lambda) U' H^1/2 is H + rho R, and nothing joins the two runs."""
    spectrum = SPECTRA.spectra[number]
    vectors = np.zeros((12, 12))
    for part, own in zip(SPECTRA.runs, spectrum.vectors, strict=True):
        vectors[part, part] = own
    root = np.sqrt(np.diag(SPECTRA.profile))
    found = root @ vectors @ np.diag(1 + strength * spectrum.values) @ vectors.T @ root
    expected = np.diag(SPECTRA.profile) + strength * alike(PAIRS, spectrum.time)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * (1 + strength))


def test_inverses_and_determinants_are_those_of_the_covariances():
    """What is scaled has the covariance I + rho H^-1/2 R H^-1/2."""
    indices = [(t, s) for t in range(len(SPECTRA.spectra)) for s in range(len(STRENGTHS))]
    found = InverseCovariances.of(SPECTRA, indices)
    columns = np.random.default_rng(2).normal(size=(12, 3))
    root = np.sqrt(SPECTRA.profile)
    for number, (time, strength) in enumerate(indices):
        drift = alike(PAIRS, SPECTRA.spectra[time].time) / np.outer(root, root)
        covariance = np.eye(12) + STRENGTHS[strength] * drift
        np.testing.assert_allclose(
            found.times(columns)[number], np.linalg.solve(covariance, columns), atol=1e-9
        )
        assert found.determinants[number] == pytest.approx(np.linalg.slogdet(covariance)[1])


@given(
    arrays(float, (12, 3), elements=st.floats(-1e3, 1e3)),
    st.integers(0, len(SPECTRA.spectra) - 1),
)
@settings(max_examples=50)
def test_modes_can_be_undone_and_keep_lengths(means, number):
    spectrum = SPECTRA.spectra[number]
    scaled = SPECTRA.scaled(means)
    np.testing.assert_allclose(scaled * np.sqrt(SPECTRA.profile)[:, None], means, atol=1e-9)
    modes = SPECTRA.modes(spectrum, scaled)
    np.testing.assert_allclose(SPECTRA.from_modes(spectrum, modes), scaled, atol=1e-9)
    np.testing.assert_allclose(modes.T @ modes, scaled.T @ scaled, rtol=1e-9, atol=1e-6)


def test_modes_are_uncorrelated_under_the_noise():
    """Whatever the strength, modes of the covariance are a diagonal matrix."""
    spectrum = SPECTRA.spectra[2]
    noise = np.diag(SPECTRA.profile) + 6.0 * alike(PAIRS, spectrum.time)
    half = SPECTRA.modes(spectrum, SPECTRA.scaled(noise))
    whole = SPECTRA.modes(spectrum, SPECTRA.scaled(half.T))
    np.testing.assert_allclose(whole, np.diag(1 + 6.0 * spectrum.values), atol=1e-10)


def test_one_vector_is_taken_like_a_column():
    spectrum = SPECTRA.spectra[1]
    np.testing.assert_allclose(
        SPECTRA.modes(spectrum, SPECTRA.scaled(RESIDUAL)),
        SPECTRA.modes(spectrum, SPECTRA.scaled(RESIDUAL[:, None]))[:, 0],
    )


def test_profile_is_point_noise_by_bins_and_what_is_known_and_what_neighbours_show():
    """Pairs of one speed alternate by 1: variance (1.4826 * 1)^2 / 2 of a pair."""
    pairs = layout(16, bins=[2, 4] * 8)
    order = np.arange(16) // 4 % 2
    extra = np.full(16, 0.02)
    known = 0.3**2 / np.resize([2.0, 4.0], 16) + extra
    spectra = spectra_of(pairs, 0.3, extra, order.astype(float))
    white = known + 1.4826**2 / 2 - known.mean()
    assert spectra.known == pytest.approx(known.mean())
    np.testing.assert_allclose(spectra.profile, white / white.mean())


def test_a_slow_cause_is_not_taken_for_pair_noise():
    """A ramp of 0.01 from pair to pair: next to nothing beside a point noise of 0.3."""
    pairs = layout(40, bins=[2, 6] * 20)
    spectra = spectra_of(pairs, 0.3, np.zeros(40), 0.01 * np.arange(40.0))
    known = 0.3**2 / np.resize([2.0, 6.0], 40)
    white = known + 0.05 * known.mean()
    np.testing.assert_allclose(spectra.profile, white / white.mean(), atol=1e-9)


def test_times_go_from_the_pairs_distance_to_the_run_s_length():
    pairs = layout(30, 20)
    times = [
        spectrum.time for spectrum in spectra_of(pairs, 0.3, np.zeros(50), np.ones(50)).spectra
    ]
    distances = np.concatenate([np.diff(pairs.time[:30]), np.diff(pairs.time[30:])])
    assert times[0] == pytest.approx(np.median(distances))
    assert times[-1] == pytest.approx(max(np.ptp(pairs.time[:30]), np.ptp(pairs.time[30:])))
    np.testing.assert_allclose(np.diff(np.log(times)), np.log(times[-1] / times[0]) / 5)


def test_runs_of_a_single_pair_have_no_drift_of_their_own():
    pairs = layout(1, 1, 1)
    spectra = spectra_of(pairs, 0.3, np.zeros(3), np.array([0.1, -0.1, 0.2]))
    for spectrum in spectra.spectra:
        assert spectrum.time > 0
        np.testing.assert_allclose(spectrum.values, 1 / spectra.profile)


def test_pairs_at_the_same_time_have_the_same_drift():
    """Pairs that share moves may have one middle: the drift is the same in both."""
    times = np.array([0.0, 60.0, 60.0, 200.0, 200.0, 260.0])
    pairs = replace(layout(6), time=times)
    for spectrum in spectra_of(pairs, 0.3, np.zeros(6), np.ones(6)).spectra:
        (vectors,) = spectrum.vectors
        found = vectors @ np.diag(spectrum.values) @ vectors.T
        expected = np.exp(-np.abs(times[:, None] - times) / spectrum.time)
        np.testing.assert_allclose(found, expected, atol=1e-5)
        within = np.sum(np.var(np.linalg.cholesky(expected + 1e-9 * np.eye(6)), axis=0))
        assert spectrum.within == pytest.approx(within, abs=1e-5)
