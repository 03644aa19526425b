"""Both channels fitted together, against dense generalised least squares of all rows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import block_diag, null_space

from frictioncli.diagnosis.fit.two_channel_fit import (
    NormalEquations,
    fit_candidates,
    fit_channels,
    noise_of,
)
from frictioncli.diagnosis.noise.likelihood_scan import fit_null
from frictioncli.diagnosis.noise.spectra import STRENGTHS, spectra_of, weighted_gram
from tests.diagnosis import dense_noise

PAIRS = dense_noise.layout(40, 30, bins=2)
COUNT = 70
NOTHING = np.zeros((1, 1))


def spectra(known=0.1, seed=0):
    extra = np.full(COUNT, known)
    return spectra_of(PAIRS, 1e-3, extra, np.random.default_rng(seed).normal(size=COUNT))


def inner(spectra, setting, columns):
    spectrum = spectra.spectra[setting[0]]
    return weighted_gram(spectra, setting, spectra.modes(spectrum, spectra.scaled(columns)))


def both(seed=0, contrasts=50):
    """Random columns (two of the base, two of a candidate) and data of both channels."""
    generator = np.random.default_rng(seed)
    truth = np.array([1.0, -0.5, 0.8, 0.3])
    inside, means, channels = [], [], []
    for number, setting in enumerate([(2, 4), (1, 2)]):
        spectrum = spectra(seed=number)
        noise = 0.04 * dense_noise.covariance(PAIRS, spectrum, setting)
        columns = generator.normal(size=(COUNT, 4)) * [1.0, 0.1, 3.0, 1.0]
        white = generator.normal(size=(contrasts, 4))
        drift = np.linalg.cholesky(noise) @ generator.normal(size=COUNT)
        means.append(np.column_stack([columns, columns @ truth + drift]))
        inside.append(np.column_stack([white, white @ truth + generator.normal(size=contrasts)]))
        channels.append((spectrum, setting))
    return channels, inside, means


def fitted(channels, inside, means, base=2):
    friction, load = (
        NormalEquations(
            within=rows.T @ rows,
            between=inner(spectrum, setting, columns),
            determinant=0.0,
            freedom=COUNT - base,
        )
        for (spectrum, setting), rows, columns in zip(channels, inside, means, strict=True)
    )
    return fit_channels((friction, load), base)


def dense(channels, inside, means, scales):
    """Coefficients and covariance by stacking all rows under one dense covariance."""
    rows = np.vstack([*inside, *means])
    noise = block_diag(
        *(np.eye(len(part)) for part in inside),
        *(
            scale * dense_noise.covariance(PAIRS, *channel)
            for scale, channel in zip(scales, channels, strict=True)
        ),
    )
    inverse = np.linalg.inv(noise)
    columns, data = rows[:, :-1], rows[:, -1]
    covariance = np.linalg.inv(columns.T @ inverse @ columns)
    return covariance @ columns.T @ inverse @ data, covariance


def settled_scales(channels, inside, means, base=2):
    """Scales and coefficients fitted in turn until nothing changes any more."""
    scales = [1.0, 1.0]
    for _ in range(30):
        coefficients, covariance = dense(channels, inside, means, scales)
        scales = []
        for channel, columns in zip(channels, means, strict=True):
            left = columns[:, -1] - columns[:, :-1] @ coefficients
            noise = dense_noise.covariance(PAIRS, *channel)
            scales.append(float(left @ np.linalg.solve(noise, left)) / (COUNT - base))
    return scales, coefficients, covariance


@pytest.mark.parametrize("seed", range(3))
def test_coefficients_are_those_of_dense_least_squares(seed):
    case = both(seed)
    fit = fitted(*case)
    scales, coefficients, covariance = settled_scales(*case)
    error = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(fit.scales, scales, rtol=2e-3)
    np.testing.assert_allclose(fit.coefficients, coefficients, atol=2e-3 * error.min())
    size = np.outer(error, error)
    np.testing.assert_allclose(fit.covariance / size, covariance / size, atol=5e-3)
    # and they are the truth, within their errors
    assert np.abs((fit.coefficients - [1.0, -0.5, 0.8, 0.3]) / error).max() < 4


def test_scales_are_those_of_the_noise():
    """0.04 in both channels; 20 cases of 68 degrees of freedom have an error of 4 %."""
    scales = np.array([fitted(*both(seed)).scales for seed in range(20)])
    np.testing.assert_allclose(scales.mean(axis=0), 0.04, rtol=0.12)


def test_a_channel_that_says_nothing_changes_nothing():
    """Columns that are zero in load: the friction channel alone decides, its scale apart."""
    channels, inside, means = both(1)
    inside[1][:, :-1] = means[1][:, :-1] = 0.0
    fit = fitted(channels, inside, means)
    alone, covariance = dense(channels[:1], inside[:1], means[:1], fit.scales[:1])
    error = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(fit.coefficients, alone, atol=5e-3 * error.min())


def test_likelihood_is_that_of_the_contrasts():
    """Base alone against base and candidate, each under another noise; scipy on contrasts K'y.

    Friction and load share no column, and nothing is known inside pairs: then it is exact.
    """
    generator = np.random.default_rng(5)
    base, candidate = generator.normal(size=(COUNT, 2)), generator.normal(size=(COUNT, 1))
    own, other = spectra(seed=1), spectra(seed=2)
    offset = np.ones((COUNT, 1))
    friction = (0.5 * candidate + 0.3 * generator.normal(size=(COUNT, 1))) + base @ [[1.0], [2.0]]
    load = generator.normal(size=(COUNT, 1))
    null = fit_null(own, base, friction), fit_null(other, offset, load)

    def likelihood(setting, *candidates):
        known = 3
        zero = np.zeros((COUNT, 1))
        first = np.hstack([base, zero, *candidates, friction])
        second = np.hstack([zero, zero, offset, *(0 * one for one in candidates), load])
        places = [(null[0], own, setting, first), (null[1], other, (2, 3), second)]
        channels = (
            NormalEquations(
                within=np.zeros((columns.shape[1],) * 2),
                between=inner(noises_of, place, columns),
                determinant=float(alone.determinant[place]),
                freedom=alone.freedom,
            )
            for alone, noises_of, place, columns in places
        )
        return fit_channels(tuple(channels), known).likelihood

    def direct(setting, *candidates):
        contrasts = null_space(base.T)
        noise = contrasts.T @ dense_noise.covariance(PAIRS, own, setting) @ contrasts
        seen = (contrasts.T @ friction)[:, 0]
        if candidates:
            column = contrasts.T @ candidates[0]
            weighted = np.linalg.solve(noise, column)
            seen = seen - column @ np.linalg.solve(column.T @ weighted, weighted.T @ seen)
        scale = seen @ np.linalg.solve(noise, seen) / len(seen)
        return stats.multivariate_normal.logpdf(seen, cov=scale * noise)

    found = likelihood((1, 3), candidate) - likelihood((3, 5))
    assert found == pytest.approx(direct((1, 3), candidate) - direct((3, 5)), abs=1e-5)
    assert found > 5
    same = likelihood((3, 5), candidate) - likelihood((3, 5))
    assert same == pytest.approx(direct((3, 5), candidate) - direct((3, 5)), abs=1e-5)


def test_what_the_base_leaves_of_the_candidate_is_its_white_length():
    channels, inside, means = both(2)
    fit = fitted(channels, inside, means)
    whitened = [
        *inside,
        *(
            np.linalg.solve(
                np.linalg.cholesky(scale * dense_noise.covariance(PAIRS, *channel)), columns
            )
            for scale, channel, columns in zip(fit.scales, channels, means, strict=True)
        ),
    ]
    rows = np.vstack(whitened)[:, :4]
    left = rows[:, 2:] - rows[:, :2] @ np.linalg.lstsq(rows[:, :2], rows[:, 2:], rcond=None)[0]
    np.testing.assert_allclose(fit.visible, np.linalg.norm(left, axis=0), rtol=5e-3)
    assert fit.freedom == 2


@pytest.mark.parametrize(
    ("change", "freedom"),
    [
        ("the base's", 1),
        ("each other", 1),
        ("zero", 1),
        ("the base's, and zero", 0),
    ],
)
def test_columns_that_say_nothing_new_are_not_counted(change, freedom):
    channels, inside, means = both(3)
    for rows in (*inside, *means):
        if change == "each other":
            rows[:, 3] = -2.0 * rows[:, 2]
        elif change == "zero":
            rows[:, 3] = 0.0
        else:
            rows[:, 3] = rows[:, :2] @ [1.0, 2.0]
            rows[:, 2] *= "zero" not in change
    fit = fitted(channels, inside, means)
    assert fit.freedom == freedom
    assert np.isfinite(fit.coefficients).all()
    assert np.isfinite(fit.likelihood)
    if change != "each other":
        assert fit.visible[1] == 0.0


def test_the_base_alone_has_no_candidate():
    channels, inside, means = both(4)
    fit = fitted(channels, inside, means, base=4)
    assert fit.visible.shape == (0,)
    assert fit.freedom == 0


def test_units_of_the_columns_do_not_matter():
    channels, inside, means = both(6)
    factor = np.array([1e6, 1e-5, 1e3, 1.0, 1.0])
    plain = fitted(channels, inside, means)
    scaled = fitted(channels, [rows * factor for rows in inside], [rows * factor for rows in means])
    np.testing.assert_allclose(scaled.coefficients * factor[:4], plain.coefficients, rtol=1e-6)
    assert scaled.likelihood == pytest.approx(plain.likelihood, abs=1e-6)


def test_a_candidate_never_lowers_the_likelihood():
    channels, inside, means = both(7)
    candidate = fitted(channels, inside, means).likelihood
    chosen = [0, 1, 4]
    alone = fitted(channels, [one[:, chosen] for one in inside], [one[:, chosen] for one in means])
    assert candidate >= alone.likelihood - 1e-9


@pytest.mark.parametrize("setting", [(0, 0), (2, 5)])
def test_noise_in_torque_units_is_the_covariance_of_its_place(setting):
    """pair^2 + point^2/bins on the diagonal and drift^2 R are a (H + rho R) for even bins."""
    pairs = dense_noise.layout(12, 10, bins=4)
    even = spectra_of(pairs, 0.4, np.full(22, 0.01), np.random.default_rng(0).normal(size=22))
    noise = noise_of(even, setting, 0.5, 0.4)
    drift = noise.drift**2 * dense_noise.alike(pairs, noise.drift_time)
    found = np.diag(np.full(22, noise.pair**2 + 0.4**2 / 4 + 0.01)) + drift
    np.testing.assert_allclose(found, 0.5 * dense_noise.covariance(pairs, even, setting))
    assert noise.point == 0.4
    assert noise.drift**2 == pytest.approx(0.5 * STRENGTHS[setting[1]])


def test_noise_below_what_is_known_has_no_pair_part():
    assert noise_of(replace(spectra(), known=0.6), (0, 0), 0.5, 0.4).pair == 0.0


@pytest.mark.parametrize("size", [0.0, 1e-160, 1e-155])
def test_a_column_that_is_nearly_nothing_changes_nothing(size):
    """The square of its length is no number with all its digits any more, or none at all."""
    channels, inside, means = both()
    with_it = [
        [np.insert(rows, 2, size * np.cos(np.arange(len(rows))), axis=1) for rows in part]
        for part in (inside, means)
    ]
    without, found = fitted(channels, inside, means), fitted(channels, *with_it)
    assert found.coefficients[2] == 0.0
    np.testing.assert_allclose(np.delete(found.coefficients, 2), without.coefficients, rtol=1e-9)
    assert found.likelihood == pytest.approx(without.likelihood, rel=1e-9)


def test_many_candidates_at_once_are_fitted_as_each_alone():
    """Among them a repeated column and one of zeros, which must not touch their neighbours."""
    channels, inside, means = both(8)
    cases = []
    for change in (lambda rows: None, repeat_third, empty_last):
        parts = [[rows.copy() for rows in part] for part in (inside, means)]
        for rows in (*parts[0], *parts[1]):
            change(rows)
        cases.append(parts)
    stacked = tuple(
        NormalEquations(
            within=np.stack([case[0][number].T @ case[0][number] for case in cases]),
            between=np.stack([inner(*channels[number], case[1][number]) for case in cases]),
            determinant=0.0,
            freedom=COUNT - 2,
        )
        for number in range(2)
    )
    found = fit_candidates(stacked, 2)
    assert [fit.freedom for fit in found] == [2, 1, 1]
    for fit, case in zip(found, cases, strict=True):
        alone = fitted(channels, *case)
        assert fit.likelihood == pytest.approx(alone.likelihood, rel=1e-10)
        np.testing.assert_allclose(fit.coefficients, alone.coefficients, rtol=1e-8, atol=1e-12)
        np.testing.assert_allclose(fit.visible, alone.visible, rtol=1e-8, atol=1e-12)
    # the first against dense least squares, at the scales found
    coefficients, covariance = dense(channels, inside, means, found[0].scales)
    error = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(found[0].coefficients, coefficients, atol=2e-3 * error.min())
    assert found[2].coefficients[3] == 0.0


def repeat_third(rows):
    rows[:, 3] = -2.0 * rows[:, 2]


def empty_last(rows):
    rows[:, 3] = 0.0
