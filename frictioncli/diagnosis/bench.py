"""What is worked out once for all steps of a search: columns, and the noises of both channels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.columns import (
    Columns,
    Hypothesis,
    base_columns,
    base_rows,
    joined,
    misfit_column,
)
from frictioncli.diagnosis.problem import Problem
from frictioncli.diagnosis.scan import Groups
from frictioncli.diagnosis.spectra import Spectra, spectra_of

Array = NDArray[np.float64]
Modes = tuple[Array, ...]
"""Pair means in the eigenvectors of each correlation time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bench:
    """One joint's data and noises.

    Attributes
    ----------
    problem : Problem
        The data.
    base : Columns
        Columns of the base model.
    misfit : Columns
        The misfit of the simulated torque, one column.
    spectra : (Spectra, Spectra)
        Noises of friction and load.
    """

    problem: Problem
    base: Columns
    misfit: Columns
    spectra: tuple[Spectra, Spectra]

    @classmethod
    def of(cls, problem: Problem) -> "Bench":
        """Return the bench of a problem."""
        layout = problem.layout
        base, misfit = base_columns(problem), misfit_column(problem)
        extra = (problem.temperature_variance, np.zeros_like(layout.time))
        points = (
            point_noise(problem, problem.friction_misfit, [], "friction"),
            point_noise(problem, problem.load_misfit, [], "load"),
        )
        friction, load = (
            spectra_of(layout, point, known, _left(part.means, own.means))
            for point, known, part, own in zip(
                points, extra, base.channels, misfit.channels, strict=True
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
    columns : Columns
        Theirs, side by side.
    groups : Groups
        Which columns belong to one shape of one hypothesis.
    modes : (Modes, Modes)
        Of friction and load: the columns in the eigenvectors of each correlation time.
    """

    hypotheses: tuple[Hypothesis, ...]
    columns: Columns
    groups: Groups
    modes: tuple[Modes, Modes]

    @classmethod
    def of(cls, bench: Bench, hypotheses: Sequence[Hypothesis]) -> "Catalogue":
        """Return the catalogue of these hypotheses."""
        nothing = bench.base.take(slice(0, 0))
        columns = joined([nothing, *(one.columns for one in hypotheses)])
        return cls(
            hypotheses=tuple(hypotheses),
            columns=columns,
            groups=Groups.of([one.width for one in hypotheses for _ in one.shapes]),
            modes=modes_of(bench, columns),
        )

    def without(self, bench: Bench, names: set[str]) -> "Catalogue":
        """Return the catalogue without some of its hypotheses."""
        if not names:
            return self
        return Catalogue.of(bench, [one for one in self.hypotheses if one.name not in names])


def modes_of(bench: Bench, columns: Columns) -> tuple[Modes, Modes]:
    """Return the modes of columns in friction and load."""
    friction, load = (
        tuple(spectra.modes(one, spectra.scaled(part.means)) for one in spectra.spectra)
        for spectra, part in zip(bench.spectra, columns.channels, strict=True)
    )
    return friction, load


def point_noise(problem: Problem, misfit: Array, added: Sequence[Array], channel: str) -> float:
    """Return the noise of a row about its pair, base and added columns taken out. [N·m].

    Parameters
    ----------
    problem : Problem
        The data.
    misfit : ndarray, shape (rows,)
        Misfit of the channel. [N·m]
    added : sequence of ndarray, shape (rows, columns)
        Columns of accepted effects in the channel.
    channel : {"friction", "load"}
        Which channel.
    """
    layout = problem.layout
    base = base_rows(problem)[channel == "load"]
    design = np.hstack([base, *added])
    design = design[:, np.linalg.norm(design, axis=0) > 0]
    residual = _left(design, misfit[:, np.newaxis])
    inside = residual - layout.means(residual[:, np.newaxis])[:, 0][layout.row_pair]
    freedom = max(len(inside) - len(layout.bins), 1)
    return max(float(np.sqrt(inside @ inside / freedom)), 1e-9)


def _left(base: Array, misfit: Array) -> Array:
    """Return what columns leave of a single one, shape (rows,)."""
    size = np.linalg.norm(base, axis=0)
    unit = base[:, size > 0] / size[size > 0]
    return np.asarray(misfit[:, 0] - unit @ np.linalg.lstsq(unit, misfit[:, 0], rcond=1e-9)[0])
