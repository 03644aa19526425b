r"""Discrimination of rival models: noncentralities in observed or planned rows.

All follows from information matrices :math:`G = C' V^{-1} C` of columns :math:`C` under a noise
covariance :math:`V`. If rival A is the cause, the torque :math:`s_A` is present. A fit of the base
model and rival B leaves of it the noncentrality

.. math::
    \lambda_{AB} = -2 \ln \operatorname{mean}_\theta
    \exp\left(-\tfrac12 \min_c \lVert s_A - X_B(\theta) c \rVert^2_{V^{-1}}\right)

(the criterion of T-optimality [1]_), with the likelihood averaged over B's shapes :math:`\theta`.

References
----------
.. [1] A. C. Atkinson and V. V. Fedorov, "The design of experiments for discriminating between two
   rival models," Biometrika 62(1), 1975, doi:10.1093/biomet/62.1.57.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.design.expected_evidence import CandidateNoises, candidate_noises
from frictioncli.design.information import Information
from frictioncli.design.rivals import Question
from frictioncli.diagnosis.fit.columns import base_columns, basis_columns, joined, reduced
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.effects.history import history, rescaled
from frictioncli.linear_algebra import schur_complement

_NEGLIGIBLE = 1e-9
"""Noncentrality of rows without information."""

_LEAST_SHRINKAGE = 0.25
"""Least share of a squared size that remains when the contribution of noise is subtracted."""

_MOST_SHAPES = 12
"""Greatest number of shapes of a rival that are tried on planned rows."""


@dataclass(frozen=True, slots=True)
class Discrimination:
    """Noncentralities of rivals against each other in some rows.

    Attributes
    ----------
    noncentrality : ndarray, shape (noises, rivals, rivals + confounders + 1)
        Of each rival as the cause, against each alternative, under each candidate noise.
    noises : CandidateNoises
        The candidate noises.
    """

    noncentrality: Array
    noises: CandidateNoises

    def log_likelihood_ratio(self, size: Array | float = 1.0) -> tuple[Array, Array]:
        """Return twice the mean, and the variance, of the log likelihood ratio of each to each.

        Parameters
        ----------
        size : float or ndarray, shape (rivals,)
            Size of each rival as the cause, relative to the fitted one.

        Returns
        -------
        twice_mean, variance : ndarray, shape (rivals, rivals + confounders + 1)
            Row: the cause; column: the alternative.
        """
        square = np.square(np.broadcast_to(size, self.noncentrality.shape[1:2]))
        return self.noises.log_likelihood_ratio(square[:, np.newaxis] * self.noncentrality)

    def share_from(self, before: "Discrimination") -> Array:
        """Return the share of the noncentralities that the rows of ``before`` contribute."""
        total = np.maximum(self.noncentrality[0], _NEGLIGIBLE)
        return np.asarray(np.clip(before.noncentrality[0] / total, 0.0, 1.0))


def discrimination_of(
    information: Information, question: Question, other_causes: Sequence[EffectFit]
) -> Discrimination:
    """Return the noncentralities of the rivals of a question in some rows.

    Entry (i, j) is what rival j cannot fit of the torque of rival i. The confounders follow the
    rivals. The last column is the base model alone: a cause that it can fit in better data loses
    its name, too.

    Parameters
    ----------
    information : Information
        Rows and noise.
    question : Question
        The rivals.
    other_causes : sequence of EffectFit
        Causes that are fitted beside the rivals.

    Returns
    -------
    Discrimination
        Noncentralities under each candidate noise.
    """
    problem = information.problem
    nuisance = joined(
        [
            base_columns(problem),
            *(basis_columns(problem, problem.basis(one.effect, one.shape)) for one in other_causes),
        ]
    )
    parts, places = [nuisance], []
    first = 0
    for rival in (*question.rivals, *question.confounders):
        own = []
        for shape in tried_shapes(rival.fit, information):
            columns = basis_columns(problem, problem.basis(rival.fit.effect, shape))
            own.append(np.arange(first, first + columns.count))
            parts.append(columns)
            first += columns.count
        places.append(np.array(own))
    for rival in question.rivals:
        shape = _rescaled_shape(rival.fit, information.observed_share)
        basis = rival.fit.effect.evaluate(information.true_inputs, shape)
        coefficients = _shrunken_coefficients(rival.fit)
        torque = [(part @ coefficients)[:, np.newaxis] for part in basis]
        parts.append(reduced(problem.layout, *torque))
    columns = joined(parts)
    noises = candidate_noises(
        problem.layout, information.noise[0], problem.temperature_variance, nuisance.friction.means
    )
    matrices = [
        _eliminate(matrix, nuisance.count)
        for matrix in information.matrices(columns, noises.noises)
    ]
    return Discrimination(_noncentralities(np.array(matrices), places), noises)


def tried_shapes(fit: EffectFit, information: Information) -> list[dict[str, float]]:
    """Return the shapes of a rival that are tried on planned rows, the fitted one first."""
    grid = fit.effect.shapes(information.problem.all_runs)
    if len(grid) > _MOST_SHAPES:
        chosen = np.unique(np.linspace(0, len(grid) - 1, _MOST_SHAPES).round().astype(int))
        grid = [grid[place] for place in chosen]
    if fit.effect.moments is not None and information.observed_share < 1:
        grid.append(history([(information.observed_share, 1.0)]))
    return [_rescaled_shape(fit, information.observed_share), *grid]


def _noncentralities(matrices: Array, places: Sequence[Indices]) -> Array:
    """Return noncentralities from information matrices without the nuisance columns.

    Parameters
    ----------
    matrices : ndarray, shape (noises, columns, columns)
        Information on the columns of all shapes, then on each rival's torque.
    places : sequence of ndarray, shape (shapes, width)
        Columns of each rival's shapes.

    Returns
    -------
    ndarray, shape (noises, torques, rivals + confounders + 1)
        Noncentralities.
    """
    targets = np.arange(1 + places[-1].max(), matrices.shape[1])
    alone = np.maximum(matrices[:, targets, targets], 0.0)
    noncentrality = np.empty((*alone.shape, len(places) + 1))
    noncentrality[..., -1] = alone
    for j, shapes in enumerate(places):
        squares = _residual_squares(matrices, shapes, targets)
        likelihood = np.logaddexp.reduce(-squares / 2, axis=1)
        noncentrality[..., j] = -2 * (likelihood - np.log(len(shapes)))
    return noncentrality


def _eliminate(gram: Array, known: int) -> Array:
    """Return the information on the other columns when the first ones are nuisance columns."""
    left, size = schur_complement(gram, known, tolerance=1e-9)
    return np.asarray(left * np.outer(size, size))


def _residual_squares(matrices: Array, columns: Indices, targets: Indices) -> Array:
    """Return squared lengths of targets that a fit of each shape's columns leaves.

    Parameters
    ----------
    matrices : ndarray, shape (noises, columns, columns)
        Information matrices.
    columns : ndarray of int, shape (shapes, width)
        Columns of each shape.
    targets : ndarray of int, shape (targets,)
        Columns to be fitted.

    Returns
    -------
    ndarray, shape (noises, shapes, targets)
        Squared lengths.
    """
    rows = columns[:, :, np.newaxis]
    size = np.sqrt(np.maximum(matrices[:, columns, columns], 1e-300))[..., np.newaxis]
    inner = matrices[:, rows, columns[:, np.newaxis]] / (size * size.swapaxes(-1, -2))
    across = matrices[:, rows, targets] / size
    # the ridge removes columns of which the base model leaves next to nothing
    taken = np.linalg.solve(inner + 1e-9 * np.eye(columns.shape[1]), across)
    alone = matrices[:, np.newaxis, targets, targets]
    return np.asarray(np.maximum(alone - np.sum(across * taken, axis=-2), 0.0))


def _shrunken_coefficients(fit: EffectFit) -> Array:
    """Return coefficients without the mean contribution of noise.

    A statistic is expected to be its noncentrality plus the number of coefficients: an effect that
    was selected because it stands out is smaller than its estimate.
    """
    count = len(fit.coefficients)
    share = max(fit.statistic - count, 0.0) / max(fit.statistic, 1e-9)
    return np.asarray(fit.coefficients * np.sqrt(max(share, _LEAST_SHRINKAGE)))


def _rescaled_shape(fit: EffectFit, observed_share: float) -> dict[str, float]:
    """Return a fitted shape in terms of all rows: moments are shares of a greater number now."""
    if fit.effect.moments is None:
        return fit.shape
    return rescaled(fit.shape, observed_share)
