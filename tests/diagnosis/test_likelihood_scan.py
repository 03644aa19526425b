"""One channel under every noise, against dense matrices."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.linalg import null_space

from frictioncli.diagnosis.noise import likelihood_scan as scanning
from frictioncli.diagnosis.noise.likelihood_scan import fit_null, scan
from frictioncli.diagnosis.noise.orthonormal_groups import Groups
from frictioncli.diagnosis.noise.spectra import STRENGTHS, spectra_of, weighted_gram
from tests.diagnosis import dense_noise

PAIRS = dense_noise.layout(13, 9, bins=[2, 3] * 11)
COUNT = 22
GENERATOR = np.random.default_rng(4)
DATA = GENERATOR.normal(size=(COUNT, 1))
BASE = np.column_stack([np.ones(COUNT), GENERATOR.normal(size=(COUNT, 2))])
SPECTRA = spectra_of(PAIRS, 0.3, np.linspace(0, 0.3, COUNT), DATA[:, 0])
CANDIDATES = np.column_stack([GENERATOR.normal(size=(COUNT, 3)), PAIRS.time / 100.0])
GROUPS = Groups.of([1, 2, 1])
NULL = fit_null(SPECTRA, BASE, DATA)
EVERY = dense_noise.settings(SPECTRA)


def modes(columns, spectra=SPECTRA):
    return [spectra.modes(spectrum, spectra.scaled(columns)) for spectrum in spectra.spectra]


def scanned(draws, seed=0, candidates=CANDIDATES, groups=GROUPS):
    return scan(SPECTRA, NULL, modes(candidates), groups, draws, np.random.default_rng(seed))


def profiled(square, determinant, count):
    """Log density of contrasts whose scale is the best one, but for constants."""
    return -0.5 * (count * np.log(square) + determinant)


def test_likelihood_of_the_base_is_that_of_its_contrasts():
    """Contrasts K'y are normal with covariance a K'VK, a the best: by scipy."""
    contrasts = null_space(BASE.T)
    seen = (contrasts.T @ DATA)[:, 0]
    direct = []
    for setting in EVERY:
        inner = contrasts.T @ dense_noise.covariance(PAIRS, SPECTRA, setting) @ contrasts
        scale = seen @ np.linalg.solve(inner, seen) / len(seen)
        assert NULL.scale[setting] == pytest.approx(scale, rel=1e-7)
        direct.append(stats.multivariate_normal.logpdf(seen, cov=scale * inner))
    found = np.array([NULL.likelihood[setting] for setting in EVERY])
    np.testing.assert_allclose(found - found[0], np.array(direct) - direct[0], atol=1e-6)
    assert EVERY[int(np.argmax(direct))] == NULL.best
    assert NULL.freedom == COUNT - 3
    assert (NULL.likelihood[1:, 0] == -np.inf).all()


def test_determinant_is_the_restricted_one_but_for_a_constant():
    direct = [
        dense_noise.restricted(DATA, BASE, dense_noise.covariance(PAIRS, SPECTRA, setting))[1]
        for setting in EVERY
    ]
    found = np.array([NULL.determinant[setting] for setting in EVERY])
    np.testing.assert_allclose(found - found[0], np.array(direct) - direct[0], atol=1e-6)


@pytest.mark.parametrize("strength", [0.0, 0.7, 40.0])
def test_under_one_noise_the_statistic_is_that_of_generalised_least_squares(monkeypatch, strength):
    """(n - p) log of the square sums without and with the candidate, by a dense inverse."""
    monkeypatch.setattr(scanning, "STRENGTHS", np.array([strength]))
    spectra = replace(SPECTRA, spectra=SPECTRA.spectra[2:3])
    noise = np.diag(spectra.profile) + strength * dense_noise.alike(PAIRS, spectra.spectra[0].time)
    null = fit_null(spectra, BASE, DATA)
    drawn = scanning._drawn_noise(spectra, null, 25, np.random.default_rng(8))
    drawn = drawn * np.sqrt(spectra.profile)[:, None]
    found = scan(
        spectra, null, modes(CANDIDATES, spectra), GROUPS, 25, np.random.default_rng(8)
    ).drawn
    alone = dense_noise.left_square(drawn, BASE, noise)
    for group in range(3):
        both = np.hstack([BASE, CANDIDATES[:, GROUPS.columns(group)]])
        ratio = np.log(alone / dense_noise.left_square(drawn, both, noise))
        np.testing.assert_allclose(found[group], (COUNT - 3) * ratio, rtol=1e-6, atol=1e-9)


def test_over_all_noises_the_best_is_taken_with_and_without_the_candidate():
    drawn = scanning._drawn_noise(SPECTRA, NULL, 15, np.random.default_rng(3))
    data = np.hstack([DATA, drawn * np.sqrt(SPECTRA.profile)[:, None]])
    found = scanned(15, seed=3)
    alone, candidates = [], []
    for setting in EVERY:
        noise = dense_noise.covariance(PAIRS, SPECTRA, setting)
        square, determinant, count = dense_noise.restricted(data, BASE, noise)
        alone.append(profiled(square, determinant, count))
        candidates.append(
            [
                profiled(
                    dense_noise.left_square(
                        data, np.hstack([BASE, CANDIDATES[:, GROUPS.columns(group)]]), noise
                    ),
                    determinant,
                    count,
                )
                for group in range(3)
            ]
        )
    best = np.max(candidates, axis=0)
    ratio = 2 * (best - np.max(alone, axis=0))
    np.testing.assert_allclose(found.drawn, ratio[:, 1:], rtol=1e-6, atol=1e-6)
    which = np.argmax(np.array(candidates)[:, :, 0], axis=0)
    assert [tuple(map(int, place)) for place in found.best] == [EVERY[i] for i in which]


def test_a_candidate_never_explains_less_than_nothing():
    assert (scanned(50).drawn >= 0).all()


@pytest.mark.parametrize("kind", ["in the base", "zero", "nearly in the base"])
def test_a_candidate_that_the_base_leaves_nothing_of_says_nothing(kind):
    column = {
        "in the base": BASE @ np.array([1.0, -2.0, 0.5]),
        "zero": np.zeros(COUNT),
        "nearly in the base": BASE[:, 1] * 1e4 + CANDIDATES[:, 0],
    }[kind][:, None]
    found = scanned(20, candidates=column, groups=Groups.of([1]))
    np.testing.assert_allclose(found.drawn, 0.0, atol=1e-9)


def test_without_draws_only_the_noise_of_each_group_is_found():
    found = scanned(0)
    assert found.drawn.shape == (3, 0)
    np.testing.assert_array_equal(found.best, scanned(10).best)


def only(*places):
    """Return the null with these places as its only ones, and their chances."""
    likelihood = np.full_like(NULL.likelihood, -np.inf)
    for setting, chance in places:
        likelihood[setting] = np.log(chance)
    return replace(NULL, likelihood=likelihood)


@pytest.mark.parametrize("setting", [(0, 0), (1, 3), (5, 6)])
def test_draws_of_noise_have_the_covariance_that_they_claim(setting):
    draws = 20_000
    null = only((setting, 1.0))
    drawn = scanning._drawn_noise(SPECTRA, null, draws, np.random.default_rng(6))
    root = np.sqrt(SPECTRA.profile)
    expected = NULL.scale[setting] * dense_noise.covariance(PAIRS, SPECTRA, setting)
    expected = expected / np.outer(root, root)
    found = drawn @ drawn.T / draws
    size = np.sqrt(np.diag(expected))
    # correlations have a standard deviation of at most sqrt(2 / draws) = 0.01
    np.testing.assert_allclose(
        found / np.outer(size, size), expected / np.outer(size, size), atol=0.05
    )
    assert np.abs(drawn.mean(axis=1) / size).max() < 4.5 / np.sqrt(draws)


def test_draws_mix_noises_by_their_likelihood():
    draws = 20_000
    null = only(((0, 0), 0.3), ((3, 4), 0.7))
    drawn = scanning._drawn_noise(SPECTRA, null, draws, np.random.default_rng(7))
    root = np.sqrt(SPECTRA.profile)
    expected = sum(
        share * NULL.scale[setting] * dense_noise.covariance(PAIRS, SPECTRA, setting)
        for setting, share in (((0, 0), 0.3), ((3, 4), 0.7))
    ) / np.outer(root, root)
    np.testing.assert_allclose(np.diag(drawn @ drawn.T) / draws, np.diag(expected), rtol=0.06)


@pytest.mark.parametrize(("place", "strength"), [(1, 1.6), (3, 6.0), (4, 25.0)])
def test_the_best_noise_lies_near_the_one_that_was_simulated(place, strength):
    """Drift stepped forward in time, 20 times: half of the answers within a factor of 4."""
    pairs = dense_noise.layout(110, 90)
    generator = np.random.default_rng(12)
    spectra = spectra_of(pairs, 1.0, np.zeros(200), generator.normal(0, 0.6, 200))
    base = np.column_stack([np.ones(200), np.resize([1.0, 2.0, 3.0, 4.0], 200)])
    truth = spectra.spectra[place].time
    times, strengths = [], []
    for _ in range(20):
        state, drift = 0.0, []
        for i in range(200):
            new = i == 0 or pairs.run[i] != pairs.run[i - 1]
            keep = 0.0 if new else np.exp(-(pairs.time[i] - pairs.time[i - 1]) / truth)
            state = keep * state + np.sqrt(strength * (1 - keep**2)) * generator.normal()
            drift.append(state)
        white = np.sqrt(spectra.profile) * generator.normal(size=200)
        best = fit_null(spectra, base, 0.2 * (np.array(drift) + white)[:, None]).best
        times.append(spectra.spectra[best[0]].time)
        strengths.append(STRENGTHS[best[1]])
    assert 1 / 4 <= np.median(times) / truth <= 4
    assert 1 / 4 <= np.median(strengths) / strength <= 4.2
    assert np.mean(np.array(strengths) > 0) > 0.9


def test_without_drift_none_is_found():
    pairs = dense_noise.layout(60, 60)
    generator = np.random.default_rng(13)
    spectra = spectra_of(pairs, 1.0, np.zeros(120), generator.normal(0, 0.6, 120))
    found = [
        fit_null(spectra, np.ones((120, 1)), 0.5 * generator.normal(size=(120, 1))).best
        for _ in range(20)
    ]
    assert np.median([STRENGTHS[best[1]] for best in found]) <= 0.1


@given(
    st.lists(st.integers(1, 4), min_size=1, max_size=6),
    st.integers(0, 10_000),
)
@settings(max_examples=60)
def test_orthonormal_is_a_qr_decomposition_of_each_group(widths, seed):
    groups = Groups.of(widths)
    columns = np.random.default_rng(seed).normal(size=(15, sum(widths)))
    unit = groups.orthonormal(columns, columns)
    for group, width in enumerate(widths):
        own = groups.columns(group)
        assert own.stop - own.start == width
        expected, triangle = np.linalg.qr(columns[:, own])
        np.testing.assert_allclose(unit[:, own], expected * np.sign(np.diag(triangle)), atol=1e-8)


@given(st.integers(0, 10_000), st.sampled_from([1, 2, 3]))
@settings(max_examples=30)
def test_orthonormal_columns_span_no_more_than_their_group(seed, rank):
    """Of three columns of a lower rank the others become zero."""
    generator = np.random.default_rng(seed)
    columns = generator.normal(size=(12, rank)) @ generator.normal(size=(rank, 3))
    unit = Groups.of([3]).orthonormal(columns, columns)
    sizes = np.linalg.norm(unit, axis=0)
    assert np.count_nonzero(sizes) == rank
    np.testing.assert_allclose(sizes[sizes > 0], 1.0)
    projected = unit @ (unit.T @ columns)
    np.testing.assert_allclose(projected, columns, atol=1e-3 * np.linalg.norm(columns))


def test_columns_of_which_the_base_leaves_a_thousandth_are_zero():
    whole = np.eye(6)[:, :4]
    left = whole * [0.0, 0.0009, 0.0011, 1.0]
    unit = Groups.of([1, 1, 2]).orthonormal(whole, left)
    np.testing.assert_allclose(unit, whole * [0.0, 0.0, 1.0, 1.0])


def test_sums_are_by_group():
    groups = Groups.of([1, 3, 2])
    values = np.arange(12.0).reshape(6, 2)
    np.testing.assert_array_equal(groups.sums(values), [[0, 1], [12, 15], [18, 20]])
    assert Groups.of([]).sums(np.zeros((0, 5))).shape == (0, 5)


@pytest.mark.parametrize("setting", [(0, 0), (2, 4), (5, 7)])
def test_inner_products_of_modes_are_those_under_the_dense_noise(setting):
    inverse = np.linalg.inv(dense_noise.covariance(PAIRS, SPECTRA, setting))
    spectrum = SPECTRA.spectra[setting[0]]
    found = weighted_gram(SPECTRA, setting, SPECTRA.modes(spectrum, SPECTRA.scaled(CANDIDATES)))
    np.testing.assert_allclose(found, CANDIDATES.T @ inverse @ CANDIDATES, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("setting", [(0, 0), (2, 4)])
def test_inner_products_with_others_are_those_of_each_group(setting):
    inverse = np.linalg.inv(dense_noise.covariance(PAIRS, SPECTRA, setting))
    own = SPECTRA.modes_at(setting[0], CANDIDATES)
    stacked = np.stack([own[:, :2], own[:, 2:]])
    found = weighted_gram(SPECTRA, setting, stacked, SPECTRA.modes_at(setting[0], BASE))
    assert found.shape == (2, 2, 3)
    np.testing.assert_allclose(
        np.vstack(found), CANDIDATES.T @ inverse @ BASE, rtol=1e-7, atol=1e-9
    )


def test_groups_that_do_not_show_leave_the_others_as_they_are():
    """Zeros before, between and after: they take nothing, and the base's noise suits them best."""
    places = [1, 2, 3, 6]
    padded = np.zeros((COUNT, 8))
    padded[:, places] = CANDIDATES
    found = scanned(20, candidates=padded, groups=Groups.of([1, 1, 2, 2, 1, 1]))
    plain = scanned(20)
    shows = [1, 2, 4]
    np.testing.assert_allclose(found.drawn[shows], plain.drawn, rtol=1e-12)
    np.testing.assert_array_equal(found.best[shows], plain.best)
    hidden = [0, 3, 5]
    np.testing.assert_array_equal(found.drawn[hidden], 0.0)
    assert [found.noises[group] for group in hidden] == [NULL.best] * 3
