"""D-optimality of a programme: for parameters of interest, and for a general response surface.

The gain in precision is half the fall of the log determinant of the covariance of the parameters
of interest (D_s-optimality [1]_), in nats.

References
----------
.. [1] A. C. Atkinson, A. N. Donev and R. D. Tobias, Optimum Experimental Designs, with SAS, 2007.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.design.information import Information
from frictioncli.design.rivals import OpenQuestions
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import ModelColumns, base_columns, basis_columns, joined
from frictioncli.effects.base import Basis, EffectTable
from frictioncli.linear_algebra import scaled_gram_inverse


@dataclass(frozen=True, slots=True)
class Precision:
    """Covariance of parameters.

    Attributes
    ----------
    names : tuple of str
        Names of the parameters.
    covariance : ndarray, shape (parameters, parameters)
        Their covariance; each in its own unit.
    """

    names: tuple[str, ...]
    covariance: Array

    def subset(self, names: Sequence[str]) -> "Precision":
        """Return the covariance of some of the parameters."""
        chosen = [self.names.index(name) for name in names]
        return Precision(tuple(names), self.covariance[np.ix_(chosen, chosen)])

    @property
    def half_widths(self) -> dict[str, float]:
        """Half-widths of the 95 % intervals by parameter name."""
        errors = 1.96 * np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return dict(zip(self.names, map(float, errors), strict=True))

    @property
    def log_volume(self) -> float:
        """Half the log determinant: log volume of the confidence ellipsoid, but for a constant."""
        return 0.5 * float(np.linalg.slogdet(self.covariance)[1])


def precision(
    information: Information,
    open_questions: OpenQuestions,
    prior: Array,
    names: Sequence[str],
    reported: Sequence[str],
) -> Precision:
    """Return the covariance of parameters: the inverse of information and prior.

    Parameters
    ----------
    information : Information
        Rows and noise.
    open_questions : OpenQuestions
        Causes that are fitted together with the base model.
    prior : ndarray, shape (columns,)
        Prior precision of the coefficients of base model and causes.
    names : sequence of str
        Names of these coefficients.
    reported : sequence of str
        Coefficients to report; the others are nuisance parameters.
    """
    gram = information.matrix(_model(information.problem, open_questions))
    total = gram + np.diag(prior)
    covariance = scaled_gram_inverse(total, tolerance=1e-13)
    chosen = [list(names).index(name) for name in reported]
    return Precision(tuple(reported), covariance[np.ix_(chosen, chosen)])


def information_on(
    information: Information, open_questions: OpenQuestions, prior: Array, further: Basis
) -> float:
    """Return what rows tell of further columns beside base and causes [nat].

    Parameters
    ----------
    information : Information
        Rows and noise.
    open_questions : OpenQuestions
        Causes that are fitted together with the base model.
    prior : ndarray, shape (columns,)
        Prior precision of the coefficients of base model and causes.
    further : Basis
        The further columns, with coefficients of variance 1 beforehand. [N·m]
    """
    problem = information.problem
    model = _model(problem, open_questions)
    gram = information.matrix(joined([model, basis_columns(problem, further)]))
    total = gram + np.diag(np.append(prior, np.ones(gram.shape[0] - len(prior))))
    # columns of unlike units
    scale = 1 / np.sqrt(np.diag(total))
    total = total * np.outer(scale, scale)
    known = slice(0, len(prior))
    whole, part = (float(np.linalg.slogdet(one)[1]) for one in (total, total[known, known]))
    return 0.5 * (whole - part) - float(np.sum(np.log(scale[len(prior) :])))


def _model(problem: Problem, open_questions: OpenQuestions) -> ModelColumns:
    """Return the columns of the base model and of the likeliest causes."""
    bases = (problem.basis(one.effect, one.shape) for one in open_questions.causes)
    return joined([base_columns(problem), *(basis_columns(problem, basis) for basis in bases)])


def response_surface_log_determinants(tables: Sequence[EffectTable]) -> list[float]:
    """Return half the log determinant of the information on a quadratic response surface.

    It measures how well rows cover all inputs, where no model of the cause is known. Each input is
    scaled to -1 ... 1 by the range of all tables together; the identity is added as a prior.

    Parameters
    ----------
    tables : sequence of EffectTable
        Tables to compare.

    Returns
    -------
    list of float
        One value per table. [nat]
    """
    inputs = [_inputs(table) for table in tables]
    stacked = np.vstack(inputs)
    low, high = stacked.min(axis=0), stacked.max(axis=0)
    varies = high > low
    values = []
    for one in inputs:
        unit = 2 * (one[:, varies] - low[varies]) / (high - low)[varies] - 1
        rows, columns = np.triu_indices(unit.shape[1])
        quadratic = np.column_stack([np.ones(len(unit)), unit, unit[:, rows] * unit[:, columns]])
        information = quadratic.T @ quadratic + np.eye(quadratic.shape[1])
        values.append(0.5 * float(np.linalg.slogdet(information)[1]))
    return values


def _inputs(table: EffectTable) -> Array:
    """Return √speed, temperature, angle, load, √travel, √time and log rest, shape (rows, 7)."""
    columns = (
        np.sqrt(table.speed),
        table.temperature,
        table.position,
        table.load,
        np.sqrt(table.travel),
        np.sqrt(table.time),
        np.log1p(np.minimum(table.rest, 12 * 3600.0)),
    )
    return np.column_stack(columns)
