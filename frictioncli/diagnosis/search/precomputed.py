"""What is worked out once for all steps of a search: columns, and the noises of both channels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import (
    RANK,
    Hypothesis,
    ModelColumns,
    base_columns,
    joined,
    left_of_base,
    misfit_column,
)
from frictioncli.diagnosis.noise.orthonormal_groups import Groups
from frictioncli.diagnosis.noise.spectra import Modes, Spectra, spectra_of
from frictioncli.effects.base import Basis
from frictioncli.linear_algebra import least_squares_residual


@dataclass(frozen=True, slots=True, kw_only=True)
class Precomputed:
    """One joint's data and noises.

    Attributes
    ----------
    problem : Problem
        The data.
    base : ModelColumns
        Columns of the base model.
    misfit : ModelColumns
        The misfit of the simulated torque, one column.
    spectra : (Spectra, Spectra)
        Noises of friction and load.
    """

    problem: Problem
    base: ModelColumns
    misfit: ModelColumns
    spectra: tuple[Spectra, Spectra]

    @classmethod
    def of(cls, problem: Problem) -> "Precomputed":
        """Return the bench of a problem."""
        layout = problem.layout
        base, misfit = base_columns(problem), misfit_column(problem)
        extra = (problem.temperature_variance, np.zeros_like(layout.time))
        friction, load = (
            spectra_of(
                layout,
                point,
                known,
                least_squares_residual(part.means, own.means[:, 0], tolerance=RANK),
            )
            for point, known, part, own in zip(
                point_noise(problem), extra, base.channels, misfit.channels, strict=True
            )
        )
        return cls(problem=problem, base=base, misfit=misfit, spectra=(friction, load))


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """Hypotheses with their columns ready for every step.

    Attributes
    ----------
    hypotheses : tuple of Hypothesis
        In order.
    columns : ModelColumns
        Theirs, side by side.
    groups : Groups
        Which columns belong to one shape of one hypothesis.
    modes : (Modes, Modes)
        Of friction and load: the columns in the eigenvectors of each correlation time.
    """

    hypotheses: tuple[Hypothesis, ...]
    columns: ModelColumns
    groups: Groups
    modes: tuple[Modes, Modes]

    @classmethod
    def of(cls, bench: Precomputed, hypotheses: Sequence[Hypothesis]) -> "Catalogue":
        """Return the catalogue of these hypotheses."""
        nothing = bench.base.take(slice(0, 0))
        columns = joined([nothing, *(one.columns for one in hypotheses)])
        friction, load = (
            spectra.all_modes(part.means)
            for spectra, part in zip(bench.spectra, columns.channels, strict=True)
        )
        return cls(
            hypotheses=tuple(hypotheses),
            columns=columns,
            groups=_groups(hypotheses),
            modes=(friction, load),
        )

    def without(self, names: set[str]) -> "Catalogue":
        """Return the catalogue without some of its hypotheses."""
        stays = [one.name not in names for one in self.hypotheses]
        if all(stays):
            return self
        chosen = np.flatnonzero(np.repeat(stays, [one.columns.count for one in self.hypotheses]))
        kept = [one for one, wanted in zip(self.hypotheses, stays, strict=True) if wanted]
        friction, load = (
            tuple(np.take(part, chosen, axis=1) for part in channel) for channel in self.modes
        )
        return Catalogue(
            hypotheses=tuple(kept),
            columns=self.columns.take(chosen),
            groups=_groups(kept),
            modes=(friction, load),
        )


def _groups(hypotheses: Sequence[Hypothesis]) -> Groups:
    return Groups.of([one.width for one in hypotheses for _ in one.shapes])


def point_noise(problem: Problem, accepted: Sequence[Basis] = ()) -> tuple[float, float]:
    """Return the noise of a row about its pair in friction and load. [N·m].

    Parameters
    ----------
    problem : Problem
        The data; their base is taken out.
    accepted : sequence of Basis
        Columns of accepted effects, taken out too.
    """
    friction = left_of_base(problem, problem.friction_misfit, "friction", accepted)
    load = left_of_base(problem, problem.load_misfit, "load", accepted)
    return _about_pair(problem.layout, friction), _about_pair(problem.layout, load)


def _about_pair(layout: PairLayout, residual: Array) -> float:
    """Return the standard deviation of rows about their pair's mean. [N·m]."""
    inside = residual - layout.means(residual[:, np.newaxis])[:, 0][layout.row_pair]
    freedom = max(len(inside) - len(layout.bins), 1)
    return max(float(np.sqrt(inside @ inside / freedom)), 1e-9)
