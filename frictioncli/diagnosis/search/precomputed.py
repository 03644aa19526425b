"""What is computed once for all steps of a search: columns and covariance spectra."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import (
    RANK,
    ModelColumns,
    base_columns,
    joined,
    misfit_column,
    residual_of_base,
)
from frictioncli.diagnosis.fit.hypotheses import Hypothesis
from frictioncli.diagnosis.noise.orthonormal_groups import Groups
from frictioncli.diagnosis.noise.spectra import Modes, Spectra, spectra_of
from frictioncli.effects.base import Basis
from frictioncli.linear_algebra import least_squares_residual

_LEAST_NOISE = 1e-9
"""Least standard deviation, so that torques without noise can be weighted. [N·m]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Precomputed:
    """Data of one joint with the base's columns and the noise models of both channels.

    Attributes
    ----------
    problem : Problem
        The rows with the base model.
    base : ModelColumns
        Columns of the base model.
    misfit : ModelColumns
        The misfit of the simulated torque, one column.
    spectra : (Spectra, Spectra)
        Noise models of friction and load.
    """

    problem: Problem
    base: ModelColumns
    misfit: ModelColumns
    spectra: tuple[Spectra, Spectra]

    @classmethod
    def of(cls, problem: Problem) -> "Precomputed":
        """Return the columns and spectra of a problem."""
        layout = problem.layout
        base, misfit = base_columns(problem), misfit_column(problem)
        extra = (problem.temperature_variance, np.zeros_like(layout.time))
        friction, load = (
            spectra_of(
                layout,
                point,
                known,
                least_squares_residual(columns.means, one.means[:, 0], tolerance=RANK),
            )
            for point, known, columns, one in zip(
                point_noise(problem), extra, base.channels, misfit.channels, strict=True
            )
        )
        return cls(problem=problem, base=base, misfit=misfit, spectra=(friction, load))


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """Hypotheses with their columns in the eigenvectors of the noise.

    Attributes
    ----------
    hypotheses : tuple of Hypothesis
        The hypotheses.
    columns : ModelColumns
        Their columns, side by side.
    groups : Groups
        Division of the columns: one group for each shape of each hypothesis.
    modes : (Modes, Modes)
        Of friction and load: the columns in the eigenvectors of each correlation time.
    """

    hypotheses: tuple[Hypothesis, ...]
    columns: ModelColumns
    groups: Groups
    modes: tuple[Modes, Modes]

    @classmethod
    def of(cls, precomputed: Precomputed, hypotheses: Sequence[Hypothesis]) -> "Catalogue":
        """Return the catalogue of these hypotheses."""
        empty = precomputed.base.take(slice(0, 0))
        columns = joined([empty, *(one.columns for one in hypotheses)])
        friction, load = (
            spectra.all_modes(part.means)
            for spectra, part in zip(precomputed.spectra, columns.channels, strict=True)
        )
        return cls(
            hypotheses=tuple(hypotheses),
            columns=columns,
            groups=_groups(hypotheses),
            modes=(friction, load),
        )

    def without(self, names: set[str]) -> "Catalogue":
        """Return the catalogue without some of its hypotheses."""
        kept = [one.name not in names for one in self.hypotheses]
        if all(kept):
            return self
        chosen = np.flatnonzero(np.repeat(kept, [one.columns.count for one in self.hypotheses]))
        remaining = [one for one, wanted in zip(self.hypotheses, kept, strict=True) if wanted]
        friction, load = (
            tuple(np.take(part, chosen, axis=1) for part in channel) for channel in self.modes
        )
        return Catalogue(
            hypotheses=tuple(remaining),
            columns=self.columns.take(chosen),
            groups=_groups(remaining),
            modes=(friction, load),
        )


def _groups(hypotheses: Sequence[Hypothesis]) -> Groups:
    return Groups.of([one.width for one in hypotheses for _ in one.shapes])


def point_noise(problem: Problem, accepted: Sequence[Basis] = ()) -> tuple[float, float]:
    """Return the standard deviation of an angle bin about its pair in friction and load [N·m].

    Parameters
    ----------
    problem : Problem
        The rows; of their misfit the residual of the base is taken.
    accepted : sequence of Basis
        Columns of accepted effects, fitted beside the base.
    """
    friction = residual_of_base(problem, problem.friction_misfit, "friction", accepted)
    load = residual_of_base(problem, problem.load_misfit, "load", accepted)
    return (
        max(problem.layout.point_deviation(friction), _LEAST_NOISE),
        max(problem.layout.point_deviation(load), _LEAST_NOISE),
    )
