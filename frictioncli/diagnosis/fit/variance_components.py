"""Variance components of a mixed model that are most probable, by iteration from several starts.

The noise model of the pair means of each channel is chosen from a grid; variances and amplitudes
follow from fixed-point and Newton steps on the restricted likelihood of
:mod:`frictioncli.diagnosis.fit.mixed_model`.
"""

from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.mixed_model import (
    LEAST_VARIANCE,
    BaseProducts,
    Components,
    MixedFit,
    Variances,
    evaluate,
    evaluate_chosen,
    scales_of,
)
from frictioncli.diagnosis.fit.products import AnyProducts

_ROUNDS = 2
"""Rounds in which the noise models are chosen anew."""

_ITERATIONS = 8
"""Iterations of the variance components in each round."""

_CONVERGED = 0.02
"""Change of minus twice the log likelihood below which the iteration ends."""

_LONGEST_STEP = 1.5
"""Longest step of the logarithm of an amplitude in one iteration."""


def fit_variances(
    components: Components, products: AnyProducts, known: int, *starts: Variances
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
    products: AnyProducts,
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
        for _ in range(_ITERATIONS):
            fit = evaluate_chosen(components, chosen, known, variances)
            if fit.objective < best.objective:
                best = fit
            if abs(before - fit.objective) < _CONVERGED:
                break
            before = fit.objective
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


def _updated(components: Components, chosen: Array, fit: MixedFit) -> Variances:
    """Return variance components that are more probable: fixed-point and Newton steps."""
    variances, covariance = fit.variances, fit.covariance
    residual = np.append(-fit.coefficients, 1.0)
    squares = (chosen @ residual) @ residual
    known = np.zeros(chosen.shape[1:])
    known[:-1, :-1] = covariance
    taken = chosen.reshape(4, -1) @ known.ravel() / scales_of(variances)
    freedom = np.array([(one, components.pairs) for one in components.within], float).ravel()
    divisor = np.maximum(np.maximum(freedom - taken, 0.2 * freedom), 1.0)
    scales = np.maximum(squares / divisor, LEAST_VARIANCE).tolist()
    return replace(
        variances,
        within=(scales[0], scales[2]),
        between=(scales[1], scales[3]),
        amplitude=_updated_amplitude(components, fit),
    )


def _updated_amplitude(components: Components, fit: MixedFit) -> Array:
    """Return logarithms of amplitudes that are more probable, shape (functions,)."""
    before, places = fit.variances.amplitude, components.functions
    if not places:
        return before
    precision = np.exp(-2 * before)
    square = precision * _sums(np.square(fit.coefficients), places)
    freedom = components.widths - precision * _sums(np.diagonal(fit.covariance), places)
    spread = np.square(components.spread)
    slope = square - freedom - (before - components.prior) / spread
    curvature = 2 * np.maximum(np.maximum(square, 0.5 * freedom), 1e-3) + 1 / spread
    step = np.clip(slope / curvature, -_LONGEST_STEP, _LONGEST_STEP)
    return np.maximum(before + step, components.least)


def _sums(values: Array, places: tuple[slice, ...]) -> Array:
    """Return the sum of the values in each place, shape (places,)."""
    return np.array([values[place].sum() for place in places])


def _with_likeliest_noise(
    components: Components, products: AnyProducts, fit: MixedFit
) -> Variances:
    """Return the variances with the likeliest noise model of the pair means of each channel.

    The base is fitted anew under every noise model; the other coefficients stay.
    """
    base = components.base
    left = np.append(-fit.coefficients[base:], 1.0)
    bases = components.bases or [BaseProducts.of(one) for one in products.of_base(base)]
    noise, scales = [], []
    for channel in (0, 1):
        products_with_left = products.with_rest(channel, base, left)
        whole = products_with_left[:, base:] @ left
        explained = bases[channel].explained(products_with_left[:, :base])
        square = np.maximum(whole - explained, 1e-300)
        freedom = max(components.pairs - bases[channel].rank, 1)
        cost = freedom * np.log(square) + components.determinants[channel]
        cost = cost + bases[channel].determinant
        drift = components.drifts[channel] * square / freedom
        best = int(np.argmin(np.where(drift > components.most_drift[channel], np.inf, cost)))
        noise.append(best)
        scales.append(max(float(square[best]) / freedom, LEAST_VARIANCE))
    return replace(fit.variances, noise=(noise[0], noise[1]), between=(scales[0], scales[1]))
