"""The mixed model beside dense matrices: restricted likelihood, coefficients and variances.

The model is written out: a vector of deviations and pair means of both channels, a covariance with
white deviations, Ornstein-Uhlenbeck pair means and random functions, and flat coefficients that are
integrated out.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.optimize import minimize

from frictioncli.diagnosis.fit.block_cholesky import BlockCholesky
from frictioncli.diagnosis.fit.columns import ChannelColumns, ModelColumns
from frictioncli.diagnosis.fit.mixed_model import Components, Variances, evaluate
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import NoiseModels, Part, TransformedColumns
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.noise.spectra import STRENGTHS, spectra_of
from tests.diagnosis.dense_noise import alike, covariance, layout, settings

PAIRS = layout(13, 11, bins=3)
COUNT, DEVIATIONS = 24, 40
BASE, WIDTHS = 3, (4, 2)
PRIOR, SPREAD = np.log(0.3), 0.7


class World:
    """Columns and a misfit that are drawn from the model itself."""

    def __init__(self, seed, amplitude=(0.6, 0.15), within=(0.2, 0.5), drift=0.6):
        generator = np.random.default_rng(seed)
        spectra = tuple(
            spectra_of(PAIRS, 0.3, extra, generator.normal(size=COUNT))
            for extra in (np.linspace(0, 0.2, COUNT), np.zeros(COUNT))
        )
        self.noises = NoiseModels(spectra, tuple(settings(spectra[0])))
        count = BASE + sum(WIDTHS)
        self.columns = [
            (generator.normal(size=(DEVIATIONS, count)), generator.normal(size=(COUNT, count)))
            for _ in range(2)
        ]
        ends = np.cumsum([BASE, *WIDTHS])
        self.functions = tuple(slice(a, b) for a, b in pairwise(ends))
        coefficients = generator.normal(size=count)
        for place, size in zip(self.functions, amplitude, strict=True):
            coefficients[place] *= size
        self.misfit = []
        for (deviations, means), variance in zip(self.columns, within, strict=True):
            noise = np.linalg.cholesky(0.04 * np.eye(COUNT) + 0.04 * drift**2 * alike(PAIRS, 100.0))
            self.misfit.append(
                (
                    deviations @ coefficients
                    + np.sqrt(variance) * generator.normal(size=DEVIATIONS),
                    means @ coefficients + noise @ generator.normal(size=COUNT),
                )
            )
        self.components = Components(
            base=BASE,
            functions=self.functions,
            widths=np.array(WIDTHS, float),
            prior=np.full(len(WIDTHS), PRIOR),
            spread=np.full(len(WIDTHS), SPREAD),
            least=np.full(len(WIDTHS), PRIOR),
            within=(DEVIATIONS, DEVIATIONS),
            pairs=COUNT,
            determinants=(self.noises.determinants(0), self.noises.determinants(1)),
            drifts=(self.noises.drifts(0), self.noises.drifts(1)),
        )
        known = self._part(self.columns)
        data = self._part([(one[0][:, None], one[1][:, None]) for one in self.misfit])
        self.transformed = TransformedColumns((known, data))
        self.products = Products.of(self.transformed)

    def _part(self, channels):
        return Part(ModelColumns(*(ChannelColumns(*one) for one in channels)), self.noises)

    def dense(self, variances):
        """Return all columns, the misfit and the covariance of its noise, stacked."""
        columns = np.vstack([part for one in self.columns for part in one])
        data = np.concatenate([part for one in self.misfit for part in one])
        noise = []
        for channel in (0, 1):
            noise.append(variances.within[channel] * np.eye(DEVIATIONS))
            index = self.noises.indices[variances.noise[channel]]
            noise.append(
                variances.between[channel] * covariance(PAIRS, self.noises.spectra[channel], index)
            )
        return columns, data, block_diag(*noise)

    def objective(self, variances):
        """Return minus twice the log of the restricted likelihood times the prior, up to terms
        that no variance enters: by the covariance of the data itself."""
        columns, data, noise = self.dense(variances)
        whole = noise.copy()
        for place, size in zip(self.functions, variances.amplitude, strict=True):
            whole += np.exp(2 * size) * columns[:, place] @ columns[:, place].T
        flat = columns[:, :BASE]
        inverse = np.linalg.inv(whole)
        inner = flat.T @ inverse @ flat
        left = data - flat @ np.linalg.solve(inner, flat.T @ inverse @ data)
        found = left @ inverse @ left
        found += np.linalg.slogdet(whole)[1] + np.linalg.slogdet(inner)[1]
        prior = (variances.amplitude - PRIOR) / SPREAD
        return found + prior @ prior


def variances(world, generator):
    many = len(world.noises.indices)
    return Variances(
        noise=tuple(generator.integers(0, many, 2).tolist()),
        within=tuple(np.exp(generator.normal(-1, 1, 2)).tolist()),
        between=tuple(np.exp(generator.normal(-2, 1, 2)).tolist()),
        amplitude=generator.normal(-1, 1, len(WIDTHS)),
    )


def evaluated(world, at):
    return evaluate(world.components, world.products, BASE + sum(WIDTHS), at)


@pytest.mark.parametrize("seed", range(5))
def test_the_objective_is_the_restricted_likelihood_of_the_dense_model(seed):
    """Differences between variances count: the profile's determinant is in none of them."""
    world = World(seed)
    generator = np.random.default_rng(100 + seed)
    drawn = [variances(world, generator) for _ in range(12)]
    found = np.array([evaluated(world, one).objective for one in drawn])
    expected = np.array([world.objective(one) for one in drawn])
    np.testing.assert_allclose(found - found[0], expected - expected[0], rtol=1e-8, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_coefficients_and_covariance_are_those_of_the_mixed_model_equations(seed):
    """Dense normal equations with the prior precision of the random functions."""
    world = World(seed)
    at = variances(world, np.random.default_rng(seed))
    columns, data, noise = world.dense(at)
    inverse = np.linalg.inv(noise)
    precision = np.zeros(columns.shape[1])
    for place, size in zip(world.functions, at.amplitude, strict=True):
        precision[place] = np.exp(-2 * size)
    expected = np.linalg.inv(columns.T @ inverse @ columns + np.diag(precision))
    found = evaluated(world, at)
    np.testing.assert_allclose(found.covariance, expected, rtol=1e-7, atol=1e-10)
    place = slice(1, 5)
    np.testing.assert_allclose(
        found.covariance_of(place), expected[place, place], rtol=1e-7, atol=1e-10
    )
    np.testing.assert_allclose(
        found.coefficients, expected @ columns.T @ inverse @ data, rtol=1e-7, atol=1e-9
    )


def test_predictions_of_random_functions_are_conditional_means():
    """By the joint normal distribution of coefficients and data, nothing flat."""
    world = World(8)
    at = variances(world, np.random.default_rng(8))
    columns, data, noise = world.dense(at)
    wide = 1e3 * np.ones(BASE)
    before = np.concatenate(
        [wide**2, *(np.full(n, np.exp(2 * a)) for n, a in zip(WIDTHS, at.amplitude, strict=True))]
    )
    across = before[:, None] * columns.T
    expected = across @ np.linalg.solve(columns @ across + noise, data)
    np.testing.assert_allclose(evaluated(world, at).coefficients, expected, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_the_optimum_is_one_that_a_general_optimiser_cannot_better(seed):
    """Nelder-Mead on the dense objective, from the optimum and from afar, at its noise model.

    The discrepancy is never less than what is expected of it.
    """
    world = World(seed, amplitude=((0.6, 0.15), (3.0, 0.02), (0.05, 0.3))[seed % 3])
    start = replace(
        variances(world, np.random.default_rng(seed)),
        within=(0.1, 0.1),
        between=(0.1, 0.1),
        amplitude=np.full(2, PRIOR),
    )
    fit = fit_variances(world.components, world.products, BASE + sum(WIDTHS), start)
    assert fit.objective == pytest.approx(evaluated(world, fit.variances).objective, abs=1e-9)

    def at(logarithms):
        within, between, amplitude = np.split(logarithms, [2, 4])
        return replace(
            fit.variances,
            within=tuple(np.exp(within)),
            between=tuple(np.exp(between)),
            amplitude=np.maximum(amplitude, PRIOR),
        )

    found = fit.variances
    assert (found.amplitude >= PRIOR).all()
    own = np.concatenate([np.log(found.within), np.log(found.between), found.amplitude])
    far = np.concatenate([np.zeros(4) - 2.0, np.full(2, PRIOR)])
    offset = world.objective(found) - fit.objective
    best = min(
        minimize(
            lambda x: world.objective(at(x)),
            begin,
            method="Nelder-Mead",
            options={"maxfev": 1500, "xatol": 1e-3, "fatol": 1e-4},
        ).fun
        for begin in (own, far)
    )
    assert fit.objective + offset - best < 0.05


@pytest.mark.parametrize("seed", range(4))
def test_no_noise_model_is_much_likelier_than_the_one_chosen(seed):
    """Every noise model of the friction channel, the other variances optimised for it."""
    world = World(seed, drift=3.0)
    start = Variances(
        noise=(0, 0), within=(0.2, 0.2), between=(0.1, 0.1), amplitude=np.full(2, PRIOR)
    )
    known = BASE + sum(WIDTHS)
    best = fit_variances(world.components, world.products, known, start)
    for number in range(0, len(world.noises.indices), 5):
        at = replace(best.variances, noise=(number, best.variances.noise[1]))
        own = minimize(
            lambda x, at=at: (
                evaluated(world, replace(at, between=(np.exp(x[0]), at.between[1]))).objective
            ),
            [np.log(at.between[0])],
            method="Nelder-Mead",
        ).fun
        # the noise is chosen with the coefficients of the random functions held
        assert best.objective < own + 2.0


def test_a_column_that_no_data_see_changes_nothing():
    world = World(3)
    for part in world.columns[0] + world.columns[1]:
        part[:, 1] = 0.0
    known = world._part(world.columns)
    products = Products.of(TransformedColumns((known, world.transformed.parts[1])))
    at = variances(world, np.random.default_rng(3))
    fit = evaluate(world.components, products, BASE + sum(WIDTHS), at)
    assert np.isfinite(fit.objective)
    assert fit.coefficients[1] == pytest.approx(0.0, abs=1e-12)


def test_functions_that_show_in_one_channel_are_fitted_as_columns_that_are_zero_in_the_other():
    """The dense model has them as columns of zeros; the one in blocks does not have them at all."""
    world = World(5)
    friction, load = (slice(one.start, one.stop) for one in world.functions[:2])
    for part in world.columns[1]:
        part[:, friction] = 0.0
    for part in world.columns[0]:
        part[:, load] = 0.0
    known, data = world._part(world.columns), world.transformed.parts[1]
    base, further = slice(0, BASE), slice(load.stop, BASE + sum(WIDTHS))
    parts = (
        known.take(base),
        replace(known.take(friction), shown=(0,)),
        replace(known.take(load), shown=(1,)),
        known.take(further),
        data,
    )
    whole, blocks = (Products.of(TransformedColumns(one)) for one in ((known, data), parts))
    assert blocks.within[0].shape[0] == whole.within[0].shape[0] - WIDTHS[1]
    at, count = variances(world, np.random.default_rng(5)), BASE + sum(WIDTHS)
    dense, found = (evaluate(world.components, one, count, at) for one in (whole, blocks))
    assert found.objective == pytest.approx(dense.objective, rel=1e-12)
    np.testing.assert_allclose(found.coefficients, dense.coefficients, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(found.covariance, dense.covariance, rtol=1e-8, atol=1e-10)
    fits = [fit_variances(world.components, one, count, at) for one in (whole, blocks)]
    assert fits[1].objective == pytest.approx(fits[0].objective, rel=1e-10)


@pytest.mark.parametrize("widths", [(3, 4), (0, 4), (3, 0), (0, 0)])
def test_a_factor_in_blocks_is_that_of_the_whole_matrix(widths):
    generator = np.random.default_rng(sum(widths))
    first, second = (np.arange(0, widths[0]), np.arange(6, 6 + widths[1]))
    matrix = np.zeros((14, 14))
    for _ in range(20):
        for absent in (first, second):
            row = generator.normal(size=14)
            row[absent] = 0.0
            matrix += np.outer(row, row)
    used = np.setdiff1d(np.arange(14), np.concatenate([first, second]))
    own = [matrix[np.ix_(one, one)] for one in (first, second)]
    across = [matrix[np.ix_(one, used)] for one in (first, second)]
    factor = BlockCholesky.of(((first, second), used), own, across, matrix[np.ix_(used, used)])
    np.testing.assert_allclose(factor.inverse(), np.linalg.inv(matrix), rtol=1e-9, atol=1e-12)
    right = generator.normal(size=14)
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(matrix, right), rtol=1e-9)
    leading = np.sort(np.concatenate([first, second, used[:-2]]))
    determinant = np.linalg.slogdet(matrix[np.ix_(leading, leading)])[1]
    assert 2 * factor.logarithms()[leading].sum() == pytest.approx(determinant)
    negative = -matrix[np.ix_(used, used)]
    assert BlockCholesky.of(((first, second), used), own, across, negative) is None


def test_strengths_begin_with_no_drift():
    """The noise models have white noise once, not once for each correlation time."""
    assert STRENGTHS[0] == 0.0
    world = World(0)
    assert sum(strength == 0 for _, strength in world.noises.indices) == 1


@pytest.mark.parametrize("seed", range(3))
def test_no_more_drift_is_chosen_than_is_allowed(seed):
    """The mean square of a drift about its mean over a run, of draws from its dense covariance."""
    world = World(seed, drift=3.0)
    first = variances(world, np.random.default_rng(seed))
    free = fit_variances(world.components, world.products, BASE + sum(WIDTHS), first)
    number = free.variances.noise[0]
    drift = world.components.drifts[0][number] * free.variances.between[0]
    time, strength = world.noises.indices[number]
    whole = alike(PAIRS, world.noises.spectra[0].spectra[time].time)
    roots = np.linalg.cholesky(whole + 1e-9 * np.eye(COUNT))
    draws = roots @ np.random.default_rng(9).normal(size=(COUNT, 4000))
    within = []
    for run in np.unique(PAIRS.run):
        own = draws[run == PAIRS.run]
        within.append(len(own) * np.mean(np.square(own - own.mean(axis=0))))
    square = sum(within) / COUNT * STRENGTHS[strength] * free.variances.between[0]
    assert drift == pytest.approx(square, rel=0.05)
    capped = replace(world.components, most_drift=(drift / 4, np.inf))
    # a start that has more of it is no way around
    fit = fit_variances(capped, world.products, BASE + sum(WIDTHS), first, free.variances)
    chosen = world.components.drifts[0][fit.variances.noise[0]] * fit.variances.between[0]
    assert chosen < drift / 2
    assert fit.objective > free.objective


def test_of_several_starts_the_best_counts():
    world = World(1, drift=3.0)
    known = BASE + sum(WIDTHS)
    starts = [variances(world, np.random.default_rng(seed)) for seed in range(4)]
    alone = [
        fit_variances(world.components, world.products, known, one).objective for one in starts
    ]
    together = fit_variances(world.components, world.products, known, *starts)
    assert together.objective == min(alone)


def test_a_random_function_that_explains_nothing_changes_nothing():
    """Its amplitude goes towards 0, where the likelihood is that without it."""
    world = World(2)
    generator = np.random.default_rng(7)
    own = [
        (0.001 * generator.normal(size=(DEVIATIONS, 3)), 0.001 * generator.normal(size=(COUNT, 3)))
        for _ in range(2)
    ]
    parts = world.transformed.parts
    products = Products.of(TransformedColumns((parts[0], world._part(own), parts[1])))
    known = BASE + sum(WIDTHS)
    start = variances(world, np.random.default_rng(2))
    without = fit_variances(world.components, world.products, known, start)
    beside = world.components.beside_function(slice(known, known + 3), PRIOR)
    first = replace(without.variances, amplitude=np.append(without.variances.amplitude, PRIOR))
    fit = fit_variances(beside, products, known + 3, first)
    assert fit.objective == pytest.approx(without.objective, abs=0.05)
