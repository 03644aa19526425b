"""Variance components of a mixed model that are most probable, by iteration from several starts.

The noise model of the pair means of each channel is chosen from a grid; variances and amplitudes
follow from fixed-point and Newton steps on the restricted likelihood of
:mod:`frictioncli.diagnosis.fit.mixed_model`.
"""

from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.base_products import BaseProducts
from frictioncli.diagnosis.fit.mixed_model import (
    LEAST_VARIANCE,
    Components,
    MixedFit,
    Variances,
    evaluate,
    evaluate_chosen,
)
from frictioncli.diagnosis.fit.products import ChosenProducts, Products
from frictioncli.diagnosis.fit.transformed_columns import Places, TransformedColumns

_ROUNDS = 2
"""Rounds in which the noise models are chosen anew."""

_ITERATIONS = 8
"""Iterations of the variance components in each round."""

_CONVERGED = 0.02
"""Change of minus twice the log likelihood below which the iteration ends."""

_LONGEST_STEP = 1.5
"""Longest step of the logarithm of an amplitude in one iteration."""


def fit_variances(
    components: Components, products: Products, known: int, *starts: Variances
) -> MixedFit:
    """Return the fit with the variance components that are most probable; see :func:`evaluate`.

    What changes slowly may be drift, or a column that explains it: each is a maximum of its own,
    and only a start near it reaches it.

    Parameters
    ----------
    components, products, known
        As of :func:`evaluate`.
    *starts : Variances
        Where to start.
    """
    fits: list[MixedFit] = []
    for start in starts:
        found = {one.variances.noise for one in fits}
        fits.append(_fitted_from(components, products, known, start, found))
    return min(fits, key=lambda one: one.objective)


def _fitted_from(
    components: Components,
    products: Products,
    known: int,
    start: Variances,
    found: set[tuple[int, int]],
) -> MixedFit:
    """Return the most probable fit that is reached from one start.

    It ends early where it comes to noise models of which a fit is found already: maxima differ by
    what the noise takes.
    """
    best = evaluate(components, products, known, start)
    if not _is_allowed(components, start):
        best = replace(best, objective=np.inf)
    for _ in range(_ROUNDS):
        variances = _with_likeliest_noise(components, products, best)
        if variances.noise in found:
            break
        chosen = products.chosen(variances.noise)
        before = np.inf
        for number in range(_ITERATIONS):
            fit = evaluate_chosen(components, chosen, known, variances)
            if fit.objective < best.objective:
                best = fit
            if abs(before - fit.objective) < _CONVERGED:
                found = found | {variances.noise}
                break
            before = fit.objective
            if number < _ITERATIONS - 1:
                variances = _updated(components, chosen, fit)
        if best.variances.noise == start.noise:
            break
        start = best.variances
    return best


def _is_allowed(components: Components, variances: Variances) -> bool:
    """Return whether there is no more drift than is allowed."""
    parts = zip(components.drifts, variances.noise, variances.between, strict=True)
    drifts = [float(drift[number]) * scale for drift, number, scale in parts]
    return all(one <= most for one, most in zip(drifts, components.most_drift, strict=True))


def _updated(components: Components, chosen: ChosenProducts, fit: MixedFit) -> Variances:
    """Return variance components that are more probable: fixed-point and Newton steps."""
    variances, covariances = fit.variances, fit.covariances()
    residual = np.append(-fit.coefficients, 1.0)
    within, between = (
        _updated_variances(*one)
        for one in zip(
            chosen.squares(residual),
            chosen.traces(covariances),
            (variances.within, variances.between),
            (components.within, (components.pairs,) * 2),
            strict=True,
        )
    )
    return replace(
        variances,
        within=within,
        between=between,
        amplitude=_updated_amplitude(components, fit, chosen.places, covariances),
    )


def _updated_variances(
    squares: list[float],
    traces: list[float],
    before: tuple[float, float],
    counts: tuple[int, int],
) -> tuple[float, float]:
    """Return more probable variances of friction and load, from squares of the residuals."""
    found = []
    for square, trace, variance, count in zip(squares, traces, before, counts, strict=True):
        divisor = max(count - trace / variance, 0.2 * count, 1.0)
        found.append(max(square / divisor, LEAST_VARIANCE))
    return found[0], found[1]


def _updated_amplitude(
    components: Components, fit: MixedFit, shown: Places, covariances: tuple[Array, Array]
) -> Array:
    """Return logarithms of amplitudes that are more probable, shape (functions,)."""
    before, places = fit.variances.amplitude, components.functions
    if not places:
        return before
    diagonal = np.empty(len(fit.coefficients))
    for channel, covariance in enumerate(covariances):
        diagonal[shown.shown(channel)[:-1]] = np.diagonal(covariance)
    precision = np.exp(-2 * before)
    square = precision * _sums(np.square(fit.coefficients), places)
    freedom = components.widths - precision * _sums(diagonal, places)
    spread = np.square(components.spread)
    slope = square - freedom - (before - components.prior) / spread
    curvature = 2 * np.maximum(np.maximum(square, 0.5 * freedom), 1e-3) + 1 / spread
    step = np.clip(slope / curvature, -_LONGEST_STEP, _LONGEST_STEP)
    return np.maximum(before + step, components.least)


def _sums(values: Array, places: tuple[slice, ...]) -> Array:
    """Return the sum of the values in each place, shape (places,)."""
    return np.array([values[place].sum() for place in places])


def _with_likeliest_noise(components: Components, products: Products, fit: MixedFit) -> Variances:
    """Return the variances with the likeliest noise model of the pair means of each channel.

    The base is fitted anew under every noise model; the other coefficients stay.
    """
    base, columns = components.base, products.columns
    # the base is fitted anew
    left = np.append(-fit.coefficients, 1.0)
    left[:base] = 0.0
    bases = components.bases or BaseProducts.of_part(columns.parts[0], base)
    noise, scales = [], []
    for channel in (0, 1):
        whole, right = _under_each_model(columns, channel, base, left)
        explained = bases[channel].explained(right)
        square = np.maximum(whole - explained, 1e-300)
        freedom = max(components.pairs - bases[channel].rank, 1)
        cost = freedom * np.log(square) + components.determinants[channel]
        cost = cost + bases[channel].determinant
        drift = components.drifts[channel] * square / freedom
        best = int(np.argmin(np.where(drift > components.most_drift[channel], np.inf, cost)))
        noise.append(best)
        scales.append(max(float(square[best]) / freedom, LEAST_VARIANCE))
    return replace(fit.variances, noise=(noise[0], noise[1]), between=(scales[0], scales[1]))


def _under_each_model(
    columns: TransformedColumns, channel: int, base: int, combination: Array
) -> tuple[Array, Array]:
    """Return squares of a combination of columns, and products of the base with it.

    Parameters
    ----------
    columns : TransformedColumns
        Columns of the model, in whose first part those of the base come first.
    channel : int
        0 for friction, 1 for load.
    base : int
        Number of the columns of the base.
    combination : ndarray, shape (columns,)
        The combination.

    Returns
    -------
    ndarray, shape (noise models,), and ndarray, shape (noise models, base)
        Of the pair means under each noise model.
    """
    noises, first = columns.noises, columns.parts[0].columns.channels[channel]
    scaled = columns.combined(channel, combination)
    weighted = noises.inverses(channel).times(scaled[:, np.newaxis])[:, :, 0]
    return weighted @ scaled, weighted @ noises.spectra[channel].scaled(first.means[:, :base])
