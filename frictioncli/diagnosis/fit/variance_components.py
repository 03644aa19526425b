"""Variance components of a mixed model that are most probable, by iteration from several starts.

The noise model of the pair means of each channel is chosen from a grid; variances and amplitudes
follow from fixed-point and Newton steps on the restricted likelihood of
:mod:`frictioncli.diagnosis.fit.mixed_model`.
"""

from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.fit.mixed_model import (
    LEAST_VARIANCE,
    Components,
    MixedFit,
    Products,
    Variances,
    evaluate,
)

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
    fits = [_fitted_from(components, products, known, start) for start in starts]
    return min(fits, key=lambda one: one.objective)


def _fitted_from(
    components: Components, products: Products, known: int, start: Variances
) -> MixedFit:
    """Return the most probable fit that is reached from one start."""
    best = evaluate(components, products, known, start)
    if not _is_allowed(components, start):
        best = replace(best, objective=np.inf)
    for _ in range(_ROUNDS):
        variances = _with_likeliest_noise(components, products, best)
        before = np.inf
        for _ in range(_ITERATIONS):
            fit = evaluate(components, products, known, variances)
            if fit.objective < best.objective:
                best = fit
            if abs(before - fit.objective) < _CONVERGED:
                break
            before = fit.objective
            variances = _updated(components, products, fit)
        if best.variances.noise == start.noise:
            break
        start = best.variances
    return best


def _is_allowed(components: Components, variances: Variances) -> bool:
    """Return whether there is no more drift than is allowed."""
    parts = zip(components.drifts, variances.noise, variances.between, strict=True)
    drifts = [float(drift[number]) * scale for drift, number, scale in parts]
    return all(one <= most for one, most in zip(drifts, components.most_drift, strict=True))


def _updated(components: Components, products: Products, fit: MixedFit) -> Variances:
    """Return variance components that are more probable: fixed-point and Newton steps."""
    variances, covariance = fit.variances, fit.covariance
    residual = np.append(-fit.coefficients, 1.0)
    within, between = [], []
    for channel in (0, 1):
        parts = (
            (products.within[channel], variances.within[channel], components.within[channel]),
            (
                products.between[channel][variances.noise[channel]],
                variances.between[channel],
                components.pairs,
            ),
        )
        scales = []
        for gram, scale, freedom in parts:
            square = float(residual @ gram @ residual)
            taken = float(np.sum(covariance * gram[:-1, :-1])) / scale
            scales.append(max(square / max(freedom - taken, 0.2 * freedom, 1.0), LEAST_VARIANCE))
        within.append(scales[0])
        between.append(scales[1])
    amplitude = variances.amplitude.copy()
    for number, place in enumerate(components.functions):
        precision = np.exp(-2 * amplitude[number])
        square = float(np.sum(np.square(fit.coefficients[place]))) * precision
        freedom = components.widths[number] - precision * float(np.trace(covariance[place, place]))
        spread = components.spread[number] ** 2
        prior = (amplitude[number] - components.prior[number]) / spread
        slope = square - freedom - prior
        curvature = 2 * max(square, 0.5 * freedom, 1e-3) + 1 / spread
        amplitude[number] += np.clip(slope / curvature, -_LONGEST_STEP, _LONGEST_STEP)
    amplitude = np.maximum(amplitude, components.least)
    return replace(
        variances,
        within=(within[0], within[1]),
        between=(between[0], between[1]),
        amplitude=amplitude,
    )


def _with_likeliest_noise(components: Components, products: Products, fit: MixedFit) -> Variances:
    """Return the variances with the likeliest noise model of the pair means of each channel.

    The base is fitted anew under every noise model; the other coefficients stay.
    """
    base = components.base
    left = np.append(-fit.coefficients[base:], 1.0)
    noise, scales = [], []
    for channel in (0, 1):
        products_with_left = products.between[channel][:, :, base:] @ left
        own = products.between[channel][:, :base, :base]
        whole = products_with_left[:, base:] @ left
        size = np.sqrt(np.maximum(np.diagonal(own, axis1=1, axis2=2), 0.0))
        most = np.sqrt(max(size.max(initial=0.0) ** 2, whole.max(initial=0.0)))
        size = np.where(size > 1e-12 * (1 + most), size, np.inf)
        scaled = own / (size[:, :, np.newaxis] * size[:, np.newaxis, :])
        values, vectors = np.linalg.eigh(scaled)
        kept = values > 1e-8
        right = products_with_left[:, :base] / size
        projected = np.einsum("nij,ni->nj", vectors, right)
        explained = np.sum(np.where(kept, projected**2 / np.where(kept, values, 1.0), 0.0), axis=1)
        square = np.maximum(whole - explained, 1e-300)
        freedom = max(components.pairs - int(kept.sum(axis=1).max(initial=0)), 1)
        finite = np.where(np.isfinite(size), size, 1.0)
        determinant = np.sum(np.where(kept, np.log(np.where(kept, values, 1.0)), 0.0), axis=1)
        determinant = determinant + 2 * np.sum(np.log(finite), axis=1)
        cost = freedom * np.log(square) + components.determinants[channel] + determinant
        drift = components.drifts[channel] * square / freedom
        best = int(np.argmin(np.where(drift > components.most_drift[channel], np.inf, cost)))
        noise.append(best)
        scales.append(max(float(square[best]) / freedom, LEAST_VARIANCE))
    return replace(fit.variances, noise=(noise[0], noise[1]), between=(scales[0], scales[1]))
