"""Sizes of fitted effects: their torque, and what the base leaves of it, with intervals."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, visible_size_of
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.effects.base import Basis, Effect

_OTHER_FORM = 0.5
"""Share of the discrepancy along an effect that the assumed covariance does not account for."""

FORM = 0.05
"""Standard deviation of what the form of an effect misses, relative to its size: no joint follows
the equation of an entry exactly, nor does the base take as much of it as of that."""

_LEAST_IN_CHANNEL = 0.1
"""Least share of what the base leaves of an effect, as mean square, that is in its own channel. Of
a linear spring that is relaxed far from the middle of a quarter turn, a sixth is."""

TAKEN_BY_BASE = "cannot be distinguished from the base model with these data"
"""Reason why an effect has no detectable size: with half of all friction it would not be named."""

LACKING = "these data lack a quantity that it needs"
"""Reason why an effect has no detectable size: a column is missing, or does not vary."""


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

    Noise and discrepancy count with the covariance that is assumed of them, and so do not count
    where the effect stands out of them by its form. Real discrepancy has not exactly the assumed
    form; so a part of what it would contribute with the form of the effect counts besides.
    So does what the form of its entry misses of an effect.
    """
    inner, crossed = _left_products(known, fit)
    size, low, high = visible_size_of(inner, fit.coefficients, fit.covariance)
    if fit.effect.measurement:
        return size, low, high
    beyond = Z95 * float(np.hypot(_other_form(known, fit, inner, crossed), FORM * size))
    below, above = np.hypot([size - low, high - size], beyond)
    return size, max(float(size - below), 0.0), float(size + above)


def left_shares(known: Precomputed, torques: Sequence[Basis]) -> Array:
    """Return the share of each torque that the base leaves, shape (torques,) [-].

    Parameters
    ----------
    known : Precomputed
        The data.
    torques : sequence of Basis
        The torques, a column in both channels.
    """
    together = _together(torques)
    whole = np.linalg.norm(np.vstack(together), axis=0)
    left = np.linalg.norm(left_by(known.span, together), axis=0)
    return np.asarray(np.divide(left, whole, where=whole > 0, out=np.zeros_like(whole)))


def elsewhere(known: Precomputed, fit: EffectFit) -> str:
    """Return why an effect is not what the residuals show; empty if it may be.

    Of what the base leaves of it a part must be in its own channel. A spring beside a gravity that
    is smaller by nearly as much leaves the load as it is and unloads the gear: friction that such a
    spring explains is no spring's.

    Parameters
    ----------
    known : Precomputed
        The data.
    fit : EffectFit
        The effect.
    """
    columns = known.problem.basis(fit.effect, fit.shape)
    squares = np.square(_left(known, fit.effect, columns) @ fit.coefficients)
    own, other = (float(np.sum(one)) for one in np.split(squares, 2))
    where = "load"
    if fit.effect.channel == "load":
        own, other, where = other, own, "friction"
    if own >= _LEAST_IN_CHANNEL * (own + other):
        return ""
    return f"it would show in the {where} rather than in the {fit.effect.channel}"


def _other_form(known: Precomputed, fit: EffectFit, inner: Array, crossed: Array) -> float:
    """Return the standard deviation of discrepancy of another form than assumed [N·m].

    Along an effect, as the RMS of what the base leaves of it.
    """
    some = fit.coefficients if fit.coefficients.any() else np.ones(len(inner))
    variances = known.start if fit.variances is None else fit.variances
    mean_square = float(some @ inner @ some)
    return _OTHER_FORM * known.discrepancy.along_products(
        some @ crossed, mean_square, variances.amplitude
    )


def _left_products(known: Precomputed, fit: EffectFit) -> tuple[Array, Array]:
    """Return mean products of what the base leaves of an effect's columns.

    With each other, shape (width, width), and with the columns of the discrepancy, shape (width,
    columns).
    """
    key = _key(fit.effect, fit.shape)
    if key not in known.left:
        remember_left(known, fit.effect, [fit.shape], [known.problem.basis(fit.effect, fit.shape)])
    return known.left[key][1:]


def remember_left(
    known: Precomputed,
    effect: Effect,
    shapes: Sequence[Mapping[str, float]],
    columns: Sequence[Basis],
) -> None:
    """Work out the products of what the base leaves of an effect's columns in several shapes.

    All at once: to read the columns of the discrepancy takes longer than to multiply them.

    Parameters
    ----------
    known : Precomputed
        The data; it remembers them.
    effect : Effect
        The effect.
    shapes : sequence of mapping of str to float
        Its shapes.
    columns : sequence of Basis
        Its columns in each.
    """
    left = _left(known, effect, _together(columns))
    rows, width = len(left) / 2, len(effect.coefficients)
    crossed = known.discrepancy.crossed(left) / rows
    for number, shape in enumerate(shapes):
        own = slice(number * width, (number + 1) * width)
        inner = left[:, own].T @ left[:, own] / rows
        known.left[_key(effect, shape)] = effect, inner, crossed[own]


def _together(bases: Sequence[Basis]) -> Basis:
    """Return columns beside each other."""
    friction, load = (np.hstack(channel) for channel in zip(*bases, strict=True))
    return Basis(friction, load)


def _key(effect: Effect, shape: Mapping[str, float]) -> tuple[object, ...]:
    return (id(effect), *shape.items())


def _left(known: Precomputed, effect: Effect, columns: Basis) -> Array:
    """Return what the base leaves of an effect's columns, shape (2 * rows, columns).

    Of an effect of the measurement that stands beside the base, what the base alone leaves.
    """
    span = known.span_of_base if effect.measurement else known.span
    return shown_of(known.problem, effect, left_by(span, columns))


def shown_of(problem: Problem, effect: Effect, both: Array) -> Array:
    """Return torque in the channels that count for the size of an effect, others zero.

    The channels may have different units: only the one in which the effect shows counts.

    Parameters
    ----------
    problem : Problem
        The rows.
    effect : Effect
        The effect.
    both : ndarray, shape (2 * rows, columns)
        Torque, friction above load.
    """
    if not problem.has_load_channel:
        return both
    friction, load = np.split(both, 2)
    parts = (friction, 0.0 * load) if effect.channel == "friction" else (0.0 * friction, load)
    return np.vstack(parts)
