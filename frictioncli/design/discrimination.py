r"""How far apart rivals are in some rows.

All of it follows from inner products :math:`G = C' V^{-1} C` of columns under a noise :math:`V`. If
rival A is at work, its torque :math:`s_A` is there. B with any coefficients, and the base refitted,
leaves the noncentrality

.. math::
    \lambda_{AB} = -2 \ln \operatorname{mean}_\theta
    \exp\left(-\tfrac12 \min_c \lVert s_A - X_B(\theta) c \rVert^2_{V^{-1}}\right)

of it [1]_, the likelihood averaged over B's shapes :math:`\theta`.

References
----------
.. [1] A. C. Atkinson and V. V. Fedorov, "The design of experiments for discriminating between two
   rival models," Biometrika 62(1), 1975, doi:10.1093/biomet/62.1.57.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.design.expected_evidence import Noises, noises_of
from frictioncli.design.information import Information
from frictioncli.design.rivals import Question
from frictioncli.diagnosis.fit.columns import base_columns, basis_columns, joined, reduced
from frictioncli.diagnosis.fit.judgement import Score
from frictioncli.linear_algebra import schur_complement

_NOTHING = 1e-9
"""Noncentrality of rows that tell nothing."""

_LEAST_SHARE = 0.25
"""What is left, at the least, of a squared size when noise is taken off."""

_SHAPES = 12
"""Shapes of a rival that are tried on the rows to come, at most."""


@dataclass(frozen=True, slots=True)
class Discrimination:
    """How far apart rivals are in some rows.

    Attributes
    ----------
    left : ndarray, shape (noises, rivals, rivals + others + 1)
        Noncentrality of each rival against each, under each noise that a diagnosis may find.
    noises : Noises
        These noises.
    """

    left: Array
    noises: Noises

    def evidence(self, size: Array | float = 1.0) -> tuple[Array, Array]:
        """Return the evidence of each rival against each, in the mean, doubled, and its variance.

        Parameters
        ----------
        size : float or ndarray, shape (rivals,)
            Size of what is at work, relative to the fitted one.
        """
        square = np.square(np.broadcast_to(size, self.left.shape[1:2]))
        return self.noises.fall(square[:, np.newaxis] * self.left)

    def share_of(self, before: "Discrimination") -> Array:
        """Return the share of the noncentralities that the rows before have."""
        return np.asarray(np.clip(before.left[0] / np.maximum(self.left[0], _NOTHING), 0.0, 1.0))


def discriminations(
    sight: Information, question: Question, others: Sequence[Score]
) -> Discrimination:
    """Return how far apart the rivals of a question are in some rows.

    Entry (i, j): how far rival i, if it is at work, is from all that rival j can do. The question's
    other effects follow the rivals. The last column is the base alone: a cause that better data
    leave to the base loses its name, too.

    Parameters
    ----------
    sight : Information
        Rows and noise.
    question : Question
        The rivals.
    others : sequence of Score
        Causes beside them.
    """
    problem = sight.problem
    known = joined(
        [
            base_columns(problem),
            *(basis_columns(problem, problem.basis(one.effect, one.shape)) for one in others),
        ]
    )
    parts, places = [known], []
    first = 0
    for rival in (*question.rivals, *question.others):
        own = []
        for shape in tried_shapes(rival.score, sight):
            columns = basis_columns(problem, problem.basis(rival.score.effect, shape))
            own.append(np.arange(first, first + columns.count))
            parts.append(columns)
            first += columns.count
        places.append(np.array(own))
    for rival in question.rivals:
        basis = rival.score.effect.evaluate(sight.gone, _kept(rival.score, sight.at_hand))
        coefficients = _shrunk(rival.score)
        torque = [(part @ coefficients)[:, np.newaxis] for part in basis]
        parts.append(reduced(problem.layout, *torque))
    columns = joined(parts)
    noises = noises_of(
        problem.layout, sight.noise[0], problem.temperature_variance, known.friction.means
    )
    grams = [_off(gram, known.count) for gram in sight.grams(columns, noises.friction)]
    return Discrimination(_noncentralities(np.array(grams), places), noises)


def tried_shapes(score: Score, sight: Information) -> list[dict[str, float]]:
    """Return the shapes of a rival that are tried on rows to come, the fitted one among them."""
    grid = score.effect.shapes(sight.problem.whole)
    if len(grid) > _SHAPES:
        chosen = np.unique(np.linspace(0, len(grid) - 1, _SHAPES).round().astype(int))
        grid = [grid[place] for place in chosen]
    if score.effect.moments is not None and sight.at_hand < 1:
        grid.append({"moment": sight.at_hand})
    return [_kept(score, sight.at_hand), *grid]


def _noncentralities(gram: Array, places: Sequence[Indices]) -> Array:
    """Return noncentralities from inner products of what the base leaves.

    Parameters
    ----------
    gram : ndarray, shape (noises, columns, columns)
        Inner products of the columns of all shapes, then of each rival's torque.
    places : sequence of ndarray, shape (shapes, width)
        Where the columns of each rival's shapes are.
    """
    targets = np.arange(1 + places[-1].max(), gram.shape[1])
    alone = np.maximum(gram[:, targets, targets], 0.0)
    found = np.empty((*alone.shape, len(places) + 1))
    found[..., -1] = alone
    for j, shapes in enumerate(places):
        left = _left(gram, shapes, targets)
        found[..., j] = -2 * (np.logaddexp.reduce(-left / 2, axis=1) - np.log(len(shapes)))
    return found


def _off(gram: Array, known: int) -> Array:
    """Return inner products of what the first columns leave of the others."""
    left, size = schur_complement(gram, known, tolerance=1e-9)
    return np.asarray(left * np.outer(size, size))


def _left(gram: Array, columns: Indices, targets: Indices) -> Array:
    """Return squared lengths of columns that others leave, by their inner products.

    Parameters
    ----------
    gram : ndarray, shape (noises, columns, columns)
        Inner products.
    columns : ndarray of int, shape (shapes, width)
        The others, shape by shape.
    targets : ndarray of int, shape (targets,)
        The columns.

    Returns
    -------
    ndarray, shape (noises, shapes, targets)
        Squared lengths.
    """
    rows = columns[:, :, np.newaxis]
    size = np.sqrt(np.maximum(gram[:, columns, columns], 1e-300))[..., np.newaxis]
    inner = gram[:, rows, columns[:, np.newaxis]] / (size * size.swapaxes(-1, -2))
    across = gram[:, rows, targets] / size
    # what the base leaves next to nothing of explains nothing
    taken = np.linalg.solve(inner + 1e-9 * np.eye(columns.shape[1]), across)
    alone = gram[:, np.newaxis, targets, targets]
    return np.asarray(np.maximum(alone - np.sum(across * taken, axis=-2), 0.0))


def _shrunk(score: Score) -> Array:
    """Return coefficients less what noise adds to them in the mean.

    A statistic is expected to be its noncentrality plus the number of coefficients: an effect that
    was chosen because it stands out is smaller than it looks.
    """
    count = len(score.coefficients)
    share = max(score.statistic - count, 0.0) / max(score.statistic, 1e-9)
    return np.asarray(score.coefficients * np.sqrt(max(share, _LEAST_SHARE)))


def _kept(score: Score, at_hand: float) -> dict[str, float]:
    """Return a fitted shape among all rows: moments are shares of the pairs, which are more now."""
    if score.effect.moments is None:
        return score.shape
    return {name: value * at_hand for name, value in score.shape.items()}
