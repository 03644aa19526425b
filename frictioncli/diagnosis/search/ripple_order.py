"""The order of a ripple that consists of its second harmonic alone.

A sine of order *N* is also the second harmonic of a ripple of order *N*/2, and explained as well by
that: which of the two orders explains more is decided by what noise adds to the harmonic that is
not there. Where the first harmonic may be zero, the ripple has twice the order.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.fit.bounded import pseudo_inverse
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.distributions import chi2_tail

_MAY_BE_ZERO = 0.01
"""Probability of a first harmonic as large, or of a gain as large, by noise alone."""

_WAVE = 2
"""Number of coefficients of a harmonic: sine and cosine."""


def at_twice_the_order(found: EffectFit, refined: Callable[[EffectFit], EffectFit]) -> EffectFit:
    """Return a ripple at twice its order if its first harmonic may be zero; other effects as found.

    Parameters
    ----------
    found : EffectFit
        An effect with its shape optimised.
    refined : callable
        Optimises the shape of an effect near the one that it has.
    """
    effect = found.effect
    if effect.orders is None or _chance(found) < _MAY_BE_ZERO:
        return found
    shape = {axis.name: 2 * found.shape[axis.name] for axis in effect.shape}
    if any(shape[axis.name] > axis.upper for axis in effect.shape):
        return found
    finer = refined(replace(found, shape=shape))
    less = max(found.statistic - finer.statistic, 0.0)
    return finer if chi2_tail(less, _WAVE) >= _MAY_BE_ZERO else found


def _chance(fit: EffectFit) -> float:
    """Return the probability of a first harmonic as large by noise alone."""
    first, covariance = fit.coefficients[:_WAVE], fit.covariance[:_WAVE, :_WAVE]
    if not np.any(np.diag(covariance) > 0):
        return 0.0
    return chi2_tail(float(first @ pseudo_inverse(covariance[np.newaxis])[0] @ first), _WAVE)
