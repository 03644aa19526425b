"""Columns of a model, reduced to what noise tells apart: inside pairs and between them.

A channel's rows split exactly into deviations from their pair's mean, whose noise is white, and
the pair means, whose noise is correlated. Inference needs nothing else of an effect's columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.base import Basis, Effect
from frictioncli.effects.pair_series import measured_share
from frictioncli.linear_algebra import least_squares_residual
from frictioncli.quantities import TORQUE

RANK = 1e-9
"""Singular values of unit columns below this share of the greatest count as zero."""

_USUAL_FRICTION = 20.0
"""Mean friction torque up to which the catalogue's bounds in units of torque hold; those of a
stronger joint grow with it. [N·m]"""

_TOLERANCE = 2.0
"""A coefficient may miss its physical bound by as many standard errors."""


@dataclass(frozen=True, slots=True)
class ChannelColumns:
    """Columns in one channel.

    Attributes
    ----------
    inside : ndarray, shape (contrasts, columns)
        Pooled deviations from the pair means. [N·m]
    means : ndarray, shape (pairs, columns)
        Pair means. [N·m]
    """

    inside: Array
    means: Array

    @property
    def count(self) -> int:
        """Number of columns."""
        return self.means.shape[1]


@dataclass(frozen=True, slots=True)
class ModelColumns:
    """The same columns in both channels."""

    friction: ChannelColumns
    load: ChannelColumns

    @property
    def channels(self) -> tuple[ChannelColumns, ChannelColumns]:
        """Friction and load."""
        return self.friction, self.load

    @property
    def count(self) -> int:
        """Number of columns."""
        return self.friction.count

    def take(self, chosen: slice | Sequence[int] | Indices) -> "ModelColumns":
        """Return some of the columns."""
        return ModelColumns(
            *(
                ChannelColumns(part.inside[:, chosen], part.means[:, chosen])
                for part in self.channels
            )
        )


def reduced(layout: PairLayout, friction: Array, load: Array) -> ModelColumns:
    """Return the columns of rows of both channels, shape (rows, columns) each."""
    return ModelColumns(
        *(ChannelColumns(layout.contrasts(rows), layout.means(rows)) for rows in (friction, load))
    )


def joined(parts: Sequence[ModelColumns]) -> ModelColumns:
    """Return the columns of several, side by side."""
    return ModelColumns(
        *(
            ChannelColumns(
                np.hstack([getattr(part, name).inside for part in parts]),
                np.hstack([getattr(part, name).means for part in parts]),
            )
            for name in ("friction", "load")
        )
    )


def base_columns(problem: Problem) -> ModelColumns:
    """Return the columns of the base model: friction's parameters, then gravity's."""
    friction, load = base_rows(problem)
    return reduced(problem.layout, friction, load)


def base_rows(problem: Problem) -> tuple[Array, Array]:
    """Return the base's columns in friction and load, shape (rows, parameters) each."""
    nothing = np.zeros_like(problem.friction_base)
    return (
        np.hstack([problem.friction_base, problem.friction_by_gravity]),
        np.hstack([nothing, problem.load_base]),
    )


def misfit_column(problem: Problem) -> ModelColumns:
    """Return the misfit of the simulated torque as one column."""
    return reduced(
        problem.layout, problem.friction_misfit[:, np.newaxis], problem.load_misfit[:, np.newaxis]
    )


def basis_columns(problem: Problem, basis: Basis) -> ModelColumns:
    """Return the columns of an effect's basis."""
    return reduced(problem.layout, basis.friction, basis.load)


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """Something that may explain the misfit: columns, perhaps over a grid of shapes.

    Attributes
    ----------
    name : str
        Its name.
    shapes : tuple of dict
        Shape parameters of each group of columns.
    width : int
        Columns of each group.
    columns : ModelColumns
        The groups side by side, ``len(shapes) * width`` columns.
    raw : ndarray, shape (shapes, width)
        RMS of each column in the channel where the hypothesis shows most. [N·m]
    lower, upper : ndarray, shape (width,)
        Physical bounds of the coefficients.
    """

    name: str
    shapes: tuple[dict[str, float], ...]
    width: int
    columns: ModelColumns
    raw: Array
    lower: Array
    upper: Array

    def allows(self, coefficients: Array, covariance: Array) -> bool:
        """Return whether coefficients lie within their physical bounds, but for their error."""
        margin = _TOLERANCE * np.sqrt(np.maximum(np.diag(covariance), 0.0))
        above = coefficients >= self.lower - margin
        return bool(np.all(above & (coefficients <= self.upper + margin)))


def hypothesis_of(
    effect: Effect, problem: Problem, shapes: Sequence[dict[str, float]] | None = None
) -> Hypothesis:
    """Return an effect as a hypothesis over its grid of shapes, or over given ones."""
    tried = _telling(effect, problem) if shapes is None else list(shapes)
    bases = [problem.basis(effect, shape) for shape in tried]
    raw = [np.sqrt(np.mean(np.square(main_channel(basis, effect)), axis=0)) for basis in bases]
    columns = reduced(
        problem.layout,
        np.hstack([basis.friction for basis in bases]),
        np.hstack([basis.load for basis in bases]),
    )
    width = len(effect.coefficients)
    strength = max(float(np.mean(np.abs(problem.friction))) / _USUAL_FRICTION, 1.0)
    reach = np.array([strength if TORQUE in one.unit else 1.0 for one in effect.coefficients])
    return Hypothesis(
        name=effect.name,
        shapes=tuple(tried),
        width=width,
        columns=columns,
        raw=np.array(raw),
        lower=np.array([parameter.lower for parameter in effect.coefficients]) * reach,
        upper=np.array([parameter.upper for parameter in effect.coefficients]) * reach,
    )


def _telling(effect: Effect, problem: Problem) -> list[dict[str, float]]:
    """Return the shapes to try first; moments that leave all rows on one side say nothing."""
    tried = effect.shapes(problem.whole)
    if effect.moments is None:
        return tried
    share = measured_share(problem.whole)[problem.rows]
    return [one for one in tried if share.min() < one["moment"] <= share.max()] or tried[:1]


def main_channel(basis: Basis, effect: Effect) -> Array:
    """Return an effect's columns in the channel where it shows most."""
    return basis.friction if effect.channel == "friction" else basis.load


def left_of_base(
    problem: Problem, torque: Array, channel: str, accepted: Sequence[Basis] = ()
) -> Array:
    """Return what the base, and effects beside it, cannot take of a torque. [N·m].

    Parameters
    ----------
    problem : Problem
        The rows with their base.
    torque : ndarray, shape (rows,)
        A torque in one channel. [N·m]
    channel : {"friction", "load"}
        Which channel.
    accepted : sequence of Basis
        Columns of effects beside the base.
    """
    number = ("friction", "load").index(channel)
    base = [base_rows(problem)[number], *(basis[number] for basis in accepted)]
    # column after column in memory, as least squares works
    return least_squares_residual(np.asfortranarray(np.hstack(base)), torque, tolerance=RANK)
