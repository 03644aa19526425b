r"""Amplitude of one more random function under the variance components of a fit without it.

With the eigenvalues :math:`q_k` of the inner products of what the fit leaves of the function's
columns, and with :math:`v_k` of these with the misfit along their eigenvectors, the amplitude
:math:`\omega` changes minus twice the log likelihood by

.. math:: \sum_k \ln(1 + \omega^2 q_k) - \frac{\omega^2 v_k^2}{1 + \omega^2 q_k} .
"""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.mixed_model import Components, MixedFit
from frictioncli.diagnosis.fit.products import Products

_TRIED = 241
"""Number of amplitudes that are tried, of which the middle one is expected."""

_ALIKE = 2.0
"""Twice the log likelihood by which the likeliest amplitude must be above the expected one: with
other variance components a less likely one may be the likeliest."""


def likely_amplitudes(
    components: Components, products: Products, without: Sequence[MixedFit]
) -> list[float]:
    """Return the logarithm of the likeliest amplitude of the last random function beside each fit.

    The expected one where that is about as likely beside one of them.

    Parameters
    ----------
    components : Components
        What the variance components belong to.
    products : Products
        Inner products of all columns, those of the function behind the columns of the fits.
    without : sequence of MixedFit
        Fits without the function.
    """
    expected, least = float(components.prior[-1]), float(components.least[-1])
    tried = np.linspace(least, 2 * expected - least, _TRIED)
    precision = np.exp(-2 * tried)[:, np.newaxis]
    found = []
    for one in without:
        right, inner = _left(products, components.functions[-1], one)
        values, vectors = np.linalg.eigh(inner)
        both = precision + np.maximum(values, 0.0)
        cost = np.sum(np.log(both / precision) - np.square(right @ vectors) / both, axis=1)
        if cost[_TRIED // 2] < cost.min() + _ALIKE:
            return [expected] * len(without)
        found.append(float(tried[np.argmin(cost)]))
    return found


def _left(products: Products, place: slice, beside: MixedFit) -> tuple[Array, Array]:
    """Return inner products of what a fit leaves of columns: with the misfit, with each other."""
    variances = beside.variances
    chosen = products.chosen(variances.noise)
    places = chosen.places
    weighted = np.zeros((places.count, place.stop - place.start))
    parts = zip(chosen.within, variances.within, chosen.between, variances.between, strict=True)
    for channel, (within, of_within, between, of_between) in enumerate(parts):
        shown = places.shown(channel)
        at = np.flatnonzero((shown >= place.start) & (shown < place.stop))
        weighted[shown] += within[:, at] / of_within + between[:, at] / of_between
    across = weighted[: place.start]
    right = weighted[-1] - beside.coefficients @ across
    return right, weighted[place] - across.T @ (beside.covariance @ across)
