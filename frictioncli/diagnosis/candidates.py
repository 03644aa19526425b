"""Effects as columns: every effect at a grid of its shape parameters, white, off the base.

All inference needs only inner products, so the columns are reduced to one Gram matrix. A candidate
is what is left of its columns after the base model, and the effects already accepted, have taken
their share.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from frictioncli.diagnosis.problem import Problem
from frictioncli.diagnosis.whitening import Whitener
from frictioncli.effects.base import Effect, Parameter

Array = NDArray[np.float64]

_VISIBLE = 1e-3
"""A column of which the base leaves less than this share says nothing of its own."""

_NOTHING = 1e-6
"""A white column shorter than this is zero: effects' columns are of order 1 to 100."""


@dataclass(frozen=True, slots=True)
class Channels:
    """Both channels' whiteners; a basis becomes one tall white matrix."""

    friction: Whitener
    load: Whitener

    def whiten(self, friction: Array, load: Array) -> Array:
        """Return the white columns of a basis, friction above load."""
        return np.concatenate([self.friction.whiten(friction), self.load.whiten(load)])

    def visible_size(self, white: Array, channel: str) -> float:
        """Return the RMS torque of one channel's part of a white vector. [N·m]."""
        split = self.friction.length
        if channel == "friction":
            return self.friction.size(white[:split])
        return self.load.size(white[split:])


@dataclass(frozen=True, slots=True)
class Score:
    """How much of the white misfit an effect explains.

    Attributes
    ----------
    effect : Effect
        The effect.
    shape : dict of str to float
        Shape parameters at which it explains most.
    coefficients : ndarray, shape (coefficients,)
        Its coefficients there, the base refitted.
    covariance : ndarray, shape (coefficients, coefficients)
        Their covariance for this shape.
    statistic : float
        Reduction of the white sum of squares; chi-squared under the null for a fixed shape.
    grid : ndarray, shape (shapes,)
        The statistic over the grid of shapes.
    """

    effect: Effect
    shape: dict[str, float]
    coefficients: Array
    covariance: Array
    statistic: float
    grid: Array


def shapes_of(effect: Effect) -> list[dict[str, float]]:
    """Return the grid of shape parameters over which an effect is searched first."""
    axes = [
        [(parameter.name, float(value)) for value in parameter.grid()] for parameter in effect.shape
    ]
    return [dict(values) for values in product(*axes)]


@dataclass(frozen=True, slots=True)
class Projector:
    """Takes the span of the base columns out of white columns."""

    basis: Array

    @classmethod
    def of(cls, columns: Array) -> "Projector":
        """Return the projector off the span of white columns."""
        size = np.linalg.norm(columns, axis=0)
        left, strength, _ = np.linalg.svd(
            columns[:, size > 0] / size[size > 0], full_matrices=False
        )
        return cls(left[:, strength > 1e-9 * strength[0]])

    def off(self, columns: Array) -> Array:
        """Return what the base leaves of white columns."""
        return columns - self.basis @ (self.basis.T @ columns)


def base_columns(problem: Problem, channels: Channels, accepted: Sequence[Array] = ()) -> Array:
    """Return the white columns of the base model and of the effects already accepted."""
    rows = len(problem.friction)
    friction, load = problem.friction_base, problem.load_base
    base = channels.whiten(
        np.hstack([friction, np.zeros((rows, load.shape[1]))]),
        np.hstack([np.zeros((rows, friction.shape[1])), load]),
    )
    return np.hstack([base, *accepted])


def effect_columns(
    effect: Effect, problem: Problem, channels: Channels, shape: dict[str, float]
) -> Array:
    """Return the white columns of an effect."""
    basis = problem.basis(effect, shape)
    return channels.whiten(basis.friction, basis.load)


def explained(columns: Array, misfit: Array) -> tuple[float, Array, Array]:
    """Return the statistic of projected columns, their coefficients and covariance."""
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0, size, 1.0)
    scaled = columns / size
    gram = scaled.T @ scaled
    inverse = np.asarray(np.linalg.pinv(gram, rcond=1e-9, hermitian=True), dtype=float)
    coefficients = inverse @ (scaled.T @ misfit)
    statistic = float(coefficients @ gram @ coefficients)
    return statistic, coefficients / size, inverse / np.outer(size, size)


def score(
    effect: Effect, problem: Problem, channels: Channels, projector: Projector, misfit: Array
) -> tuple[Score, Array]:
    """Return an effect's best score over its grid of shapes, and its projected columns there.

    Parameters
    ----------
    effect : Effect
        The candidate.
    problem, channels : Problem, Channels
        Data and whiteners.
    projector : Projector
        Takes out the base.
    misfit : ndarray
        White misfit off the base.

    Returns
    -------
    Score, ndarray
        The columns have shape (white rows, shapes, coefficients).
    """
    shapes = shapes_of(effect)
    bases = [problem.basis(effect, shape) for shape in shapes]
    whole = channels.whiten(
        np.hstack([basis.friction for basis in bases]), np.hstack([basis.load for basis in bases])
    )
    part = visible(whole, projector)
    columns = part.reshape(len(part), len(shapes), -1)
    grid = np.array([explained(columns[:, i], misfit)[0] for i in range(len(shapes))])
    best = int(np.argmax(grid))
    statistic, coefficients, covariance = explained(columns[:, best], misfit)
    return Score(effect, shapes[best], coefficients, covariance, statistic, grid), columns


def visible(whole: Array, projector: Projector) -> Array:
    """Return what the base leaves of white columns; those of which it leaves nothing are zero."""
    part = projector.off(whole)
    left = np.linalg.norm(part, axis=0)
    part[:, (left < _VISIBLE * np.linalg.norm(whole, axis=0)) | (left < _NOTHING)] = 0.0
    return part


def refined(
    found: Score, problem: Problem, channels: Channels, projector: Projector, misfit: Array
) -> Score:
    """Return the score with its shape searched off the grid."""
    effect = found.effect
    if not effect.shape:
        return found
    scales = [_Scale(parameter) for parameter in effect.shape]
    step = np.array([0.5 / scale.parameter.points for scale in scales])

    def at(unit: Array) -> tuple[dict[str, float], tuple[float, Array, Array]]:
        shape = {
            scale.parameter.name: scale.value(float(u))
            for scale, u in zip(scales, unit, strict=True)
        }
        part = visible(effect_columns(effect, problem, channels, shape), projector)
        return shape, explained(part, misfit)

    middle = np.array([scale.unit(found.shape[scale.parameter.name]) for scale in scales])
    inward = np.where(middle > 0.5, -step, step)
    search = minimize(
        lambda unit: -at(unit)[1][0],
        middle,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(scales),
        options={
            "initial_simplex": np.vstack([middle, middle + np.diag(inward)]),
            "maxfev": 30 * len(scales),
            "xatol": 1e-3,
            "fatol": 1e-2,
        },
    )
    shape, (statistic, coefficients, covariance) = at(search.x)
    if statistic <= found.statistic:
        return found
    return replace(
        found,
        shape=shape,
        coefficients=coefficients,
        covariance=covariance,
        statistic=statistic,
    )


@dataclass(frozen=True, slots=True)
class _Scale:
    """Maps a shape parameter to 0..1, linearly or by its logarithm as the catalogue says."""

    parameter: Parameter

    @property
    def _logarithmic(self) -> bool:
        return self.parameter.search == "logarithmic"

    def value(self, unit: float) -> float:
        low, high = self.parameter.lower, self.parameter.upper
        if self._logarithmic:
            return float(low * (high / low) ** unit)
        return float(low + unit * (high - low))

    def unit(self, value: float) -> float:
        low, high = self.parameter.lower, self.parameter.upper
        if self._logarithmic:
            return float(np.log(value / low) / np.log(high / low))
        return float((value - low) / (high - low))
