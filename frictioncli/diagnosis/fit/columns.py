r"""Columns of a linear model, split into deviations within pairs and means of pairs.

The rows of a channel split exactly into deviations from the mean of their pair, whose noise is
white, and the pair means, whose noise is correlated. The likelihood depends on the columns of a
model only through these two parts.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.base import Basis, Effect
from frictioncli.linear_algebra import least_squares_residual

RANK = 1e-9
"""Singular values of unit columns below this share of the greatest count as zero."""


@dataclass(frozen=True, slots=True)
class ChannelColumns:
    """Columns of a model in one channel.

    Attributes
    ----------
    within : ndarray, shape (contrasts, columns)
        Deviations from the pair means, pooled as :meth:`PairLayout.contrasts` does. [N·m]
    means : ndarray, shape (pairs, columns)
        Pair means. [N·m]
    """

    within: Array
    means: Array

    @property
    def count(self) -> int:
        """Number of columns."""
        return self.means.shape[1]


@dataclass(frozen=True, slots=True)
class ModelColumns:
    """Columns of a model in both channels.

    Attributes
    ----------
    friction, load : ChannelColumns
        The same columns in the friction and in the load channel.
    """

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

    def plus(self, other: "ModelColumns") -> "ModelColumns":
        """Return the columns, each with one of others added."""
        return ModelColumns(
            *(
                ChannelColumns(one.within + two.within, one.means + two.means)
                for one, two in zip(self.channels, other.channels, strict=True)
            )
        )

    def take(self, chosen: slice | Sequence[int] | Indices) -> "ModelColumns":
        """Return some of the columns."""
        return ModelColumns(
            *(
                ChannelColumns(part.within[:, chosen], part.means[:, chosen])
                for part in self.channels
            )
        )


def reduced(layout: PairLayout, friction: Array, load: Array) -> ModelColumns:
    """Return columns given row by row, split into deviations within pairs and pair means.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    friction, load : ndarray, shape (rows, columns)
        The columns in both channels. [N·m]
    """
    return ModelColumns(
        *(ChannelColumns(*layout.contrasts_and_means(rows)) for rows in (friction, load))
    )


def joined(parts: Sequence[ModelColumns]) -> ModelColumns:
    """Return several sets of columns side by side."""
    if len(parts) == 1:
        return parts[0]
    return ModelColumns(
        *(
            ChannelColumns(
                np.hstack([getattr(part, name).within for part in parts]),
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
    zeros = np.zeros_like(problem.friction_base)
    return (
        np.hstack([problem.friction_base, problem.friction_by_gravity]),
        np.hstack([zeros, problem.load_base]),
    )


def misfit_column(problem: Problem) -> ModelColumns:
    """Return the misfit of the simulated torque as one column."""
    return reduced(
        problem.layout, problem.friction_misfit[:, np.newaxis], problem.load_misfit[:, np.newaxis]
    )


def basis_columns(problem: Problem, basis: Basis) -> ModelColumns:
    """Return the columns of an effect's basis."""
    return reduced(problem.layout, basis.friction, basis.load)


def main_channel(basis: Basis, effect: Effect) -> Array:
    """Return an effect's columns in the channel where it shows most."""
    return basis.friction if effect.channel == "friction" else basis.load


def residual_of_base(
    problem: Problem, torque: Array, channel: str, accepted: Sequence[Basis] = ()
) -> Array:
    """Return what the base, and effects beside it, leave of a torque by least squares.

    Parameters
    ----------
    problem : Problem
        The rows with their base.
    torque : ndarray, shape (rows,)
        A torque in one channel. [N·m]
    channel : {"friction", "load"}
        The channel.
    accepted : sequence of Basis
        Columns of effects beside the base.

    Returns
    -------
    ndarray, shape (rows,)
        The residual. [N·m]
    """
    number = ("friction", "load").index(channel)
    base = [base_rows(problem)[number], *(basis[number] for basis in accepted)]
    # LAPACK works on columns that are contiguous in memory
    return least_squares_residual(np.asfortranarray(np.hstack(base)), torque, tolerance=RANK)
