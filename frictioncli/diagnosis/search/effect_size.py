"""Sizes of fitted effects: their torque, and what the base leaves of it, with intervals."""

from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, visible_size
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.effects import BASE_MEASUREMENT


def sizes_of(known: Precomputed, fit: EffectFit) -> dict[str, Any]:
    """Return the sizes of an effect by the names of the fields of a cause."""
    left, low, high = left_size(known, fit)
    return {"size": rms_size(known, fit), "visible": left, "visible_interval": (low, high)}


def rms_size(known: Precomputed, fit: EffectFit) -> float:
    """Return the RMS torque of an effect in the channel where it shows most [N·m].

    Several columns of an effect may cancel each other and leave the rest to the base; so only what
    the base leaves counts, unless the effect has a single column.
    """
    if len(fit.coefficients) > 1:
        return left_size(known, fit)[0]
    basis = known.problem.basis(fit.effect, fit.shape)
    torque = basis.friction if fit.effect.channel == "friction" else basis.load
    return float(np.sqrt(np.mean(np.square(torque @ fit.coefficients))))


def left_size(known: Precomputed, fit: EffectFit) -> tuple[float, float, float]:
    """Return the RMS that the base leaves of an effect, and its 95 % interval [N·m].

    The interval contains what discrepancy and drift of the same form would contribute.
    """
    left = _left(known, fit)
    size, low, high = visible_size(left, fit.coefficients, fit.covariance)
    if fit.effect in BASE_MEASUREMENT:
        return size, low, high
    below, above = np.hypot([size - low, high - size], Z95 * random_part(known, fit))
    return size, max(float(size - below), 0.0), float(size + above)


def random_part(known: Precomputed, fit: EffectFit) -> float:
    """Return the standard deviation of discrepancy and drift along an effect [N·m].

    It is the RMS that a part of them with the form of the effect would have: what the base leaves
    of the effect cannot be known better than that.
    """
    left = _left(known, fit)
    torque = left @ fit.coefficients if fit.coefficients.any() else left.sum(axis=1)
    variances = known.start if fit.variances is None else fit.variances
    row_pair = known.problem.layout.row_pair
    drift = [
        known.noises.drift_along(
            channel,
            variances.noise[channel],
            variances.between[channel],
            np.bincount(row_pair, weights=values).astype(float),
        )
        for channel, values in enumerate(np.split(torque, 2))
    ]
    length = max(float(np.linalg.norm(torque)), 1e-300)
    drifting = float(np.hypot(drift[0], drift[1])) / length / float(np.sqrt(len(torque) / 2))
    return float(np.hypot(known.discrepancy.along(torque, variances.amplitude), drifting))


def _left(known: Precomputed, fit: EffectFit) -> Array:
    """Return what the base leaves of an effect's columns, shape (2 * rows, width).

    Of an effect of the measurement that stands beside the base, what the base alone leaves.
    """
    basis = known.problem.basis(fit.effect, fit.shape)
    span = known.span_of_base if fit.effect in BASE_MEASUREMENT else known.span
    return left_by(span, basis)
