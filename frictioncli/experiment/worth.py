r"""How surely a programme names the cause.

All of it follows from inner products :math:`G = C' V^{-1} C` of columns under the noise :math:`V`
that the data at hand show, taken over the rows at hand and those to come.

If rival A is at work, its torque :math:`s_A` is there. B with any
coefficients, and the base refitted, leaves the noncentrality

.. math::
    \lambda_{AB} = -2 \ln \operatorname{mean}_\theta
    \exp\left(-\tfrac12 \min_c \lVert s_A - X_B(\theta) c \rVert^2_{V^{-1}}\right)

of it [1]_, the likelihood averaged over B's shapes :math:`\theta`. New rows add :math:`\delta` to
:math:`\lambda_{AB} - \lambda_{AA}`. The logarithm of the odds of A against B, :math:`D` by the data
at hand, becomes normal with mean :math:`D + \delta/2` and variance :math:`\delta`; A is named where
it exceeds ln 19, a credible set of 95 %.

References
----------
.. [1] A. C. Atkinson and V. V. Fedorov, "The design of experiments for discriminating between two
   rival models," Biometrika 62(1), 1975, doi:10.1093/biomet/62.1.57.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from frictioncli.diagnosis.columns import (
    Columns,
    base_columns,
    basis_columns,
    joined,
    reduced,
)
from frictioncli.diagnosis.judged import Score
from frictioncli.diagnosis.problem import Problem
from frictioncli.effects.base import EffectTable
from frictioncli.experiment.rivals import Question
from frictioncli.model.noise import Noise, pair_covariance

Array = NDArray[np.float64]

NAMED = float(np.log(19.0))
"""Logarithm of the odds at which a credible set of 95 % has one name."""

_LEAST_SHARE = 0.25
"""What is left, at the least, of a squared size when noise is taken off."""

_LEAST_ADDED = 1e-9
"""Noncentrality of rows that tell nothing."""

_NODES = ((-(3**0.5), 1 / 6), (0.0, 2 / 3), (3**0.5, 1 / 6))
"""Places and weights of a mean over a normal distribution (Gauss and Hermite, three points)."""

_SHAPES = 12
"""Shapes of a rival that are tried on the rows to come, at most."""


@dataclass(frozen=True, slots=True)
class Sight:
    """Rows with the noise that they have, to take inner products of columns in.

    Attributes
    ----------
    problem : Problem
        The rows.
    noise : (Noise, Noise)
        Noise of friction and load. [N·m]
    gone : EffectTable
        The rows of all runs with the way that the joint really travels in a planned run. A
        diagnosis guesses the way of moves that are not recorded, and a cause that goes with the
        way may look as if it went with another.
    at_hand : float
        Share of the pairs at hand in all: where they end, something may have happened.
    """

    problem: Problem
    noise: tuple[Noise, Noise]
    gone: EffectTable
    at_hand: float = 1.0

    def gram(self, columns: Columns) -> Array:
        """Return inner products of columns under the noise of both channels."""
        layout = self.problem.layout
        extra = (self.problem.temperature_variance, np.zeros_like(layout.time))
        total = np.zeros((columns.count, columns.count))
        for part, noise, more in zip(columns.channels, self.noise, extra, strict=True):
            covariance = pair_covariance(
                noise, time=layout.time, run=layout.run, bins=layout.bins, extra=more
            )
            total += part.inside.T @ part.inside / noise.point**2
            total += part.means.T @ covariance.solve(part.means)
        return total


def _off(gram: Array, known: int) -> Array:
    """Return inner products of what the first columns leave of the others."""
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    unit = gram / np.outer(size, size)
    inner = np.linalg.pinv(unit[:known, :known], rcond=1e-9, hermitian=True)
    across = unit[:known, known:]
    left = unit[known:, known:] - across.T @ inner @ across
    return np.asarray(left * np.outer(size[known:], size[known:]))


def _left(gram: Array, columns: NDArray[np.intp], target: int) -> float:
    """Return the squared length of a column that others leave, by their inner products."""
    size = np.sqrt(np.maximum(np.diag(gram)[columns], 1e-300))
    inner = gram[np.ix_(columns, columns)] / np.outer(size, size)
    across = gram[columns, target] / size
    # what the base leaves next to nothing of explains nothing
    taken = across @ np.linalg.solve(inner + 1e-9 * np.eye(len(columns)), across)
    return max(float(gram[target, target] - taken), 0.0)


def noncentralities(sight: Sight, question: Question, others: Sequence[Score]) -> Array:
    """Return the noncentrality of each rival against each, shape (rivals, rivals + others + 1).

    Entry (i, j): how far rival i, if it is at work, is from all that rival j can do. The question's
    other effects follow the rivals. The last column is the base alone: a cause that better data
    leave to the base loses its name, too.

    Parameters
    ----------
    sight : Sight
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
        places.append(own)
    signals = []
    for rival in question.rivals:
        basis = rival.score.effect.evaluate(sight.gone, _kept(rival.score, sight.at_hand))
        coefficients = _shrunk(rival.score)
        torque = [(part @ coefficients)[:, np.newaxis] for part in basis]
        signals.append(reduced(problem.layout, *torque))
    gram = _off(sight.gram(joined([*parts, *signals])), known.count)
    found = np.zeros((len(question.rivals), len(places) + 1))
    for i in range(len(found)):
        found[i, -1] = max(float(gram[first + i, first + i]), 0.0)
        for j, shapes in enumerate(places):
            left = np.array([_left(gram, own, first + i) for own in shapes])
            found[i, j] = -2 * (np.logaddexp.reduce(-left / 2) - np.log(len(left)))
    return found


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


def tried_shapes(score: Score, sight: Sight) -> list[dict[str, float]]:
    """Return the shapes of a rival that are tried on rows to come, the fitted one among them."""
    grid = score.effect.shapes(sight.problem.whole)
    if len(grid) > _SHAPES:
        chosen = np.unique(np.linspace(0, len(grid) - 1, _SHAPES).round().astype(int))
        grid = [grid[place] for place in chosen]
    if score.effect.moments is not None and sight.at_hand < 1:
        grid.append({"moment": sight.at_hand})
    return [_kept(score, sight.at_hand), *grid]


def chances(question: Question, before: Array, after: Array, pairs: int) -> Array:
    """Return the probability that i, if it is at work, leaves j behind.

    Shape (rivals, rivals + others + 1); the last column is the base alone. The size of what is at
    work is as uncertain as the data at hand leave it.

    Parameters
    ----------
    question : Question
        The rivals with what the data at hand say.
    before, after : ndarray, shape (rivals, rivals + others + 1)
        Noncentralities of the rows at hand, and of those with the programme's.
    pairs : int
        Pairs in all: the scale of the noise is estimated from them, so that a likelihood ratio
        grows with their logarithm only.
    """
    found = np.zeros_like(after)
    odds, error = _odds(question), _size_error(question)
    for place, weight in _NODES:
        square = np.square(np.maximum(1 + place * error, 0.0))[:, np.newaxis]
        added = _added(square * before, square * after, pairs)
        scatter = np.sqrt(np.maximum(np.abs(added), _LEAST_ADDED))
        found += weight * norm.cdf((odds + added / 2 - NAMED) / scatter)
    np.fill_diagonal(found, 1.0)
    return found


def margins(question: Question, before: Array, after: Array, pairs: int, enough: float) -> Array:
    """Return by how much odds exceed what a name needs, in the mean over all rivals.

    Logarithms, for each rival as the one at work; beyond ``enough`` they count no more. Other
    parameters are as of :func:`chances`.
    """
    margin = _odds(question) + _added(before, after, pairs) / 2 - NAMED
    np.fill_diagonal(margin, np.nan)
    return np.asarray(np.nanmean(np.clip(margin, -enough, enough), axis=1))


def _odds(question: Question) -> Array:
    """Return logarithms of the odds by the data at hand, shape (rivals, rivals + others + 1)."""
    evidence = [rival.evidence for rival in (*question.rivals, *question.others)]
    own = np.array(evidence[: len(question.rivals)])
    return np.asarray(own[:, np.newaxis] - np.array([*evidence, 0.0]))


def _added(before: Array, after: Array, pairs: int) -> Array:
    """Return what rows add to the odds, doubled, where the noise's scale is estimated, too.

    What is at work has to find its own shape among many, as its rivals have.
    """
    gained = pairs * (np.log1p(after / pairs) - np.log1p(before / pairs))
    return np.asarray(gained - np.diag(gained)[:, np.newaxis])


def _size_error(question: Question) -> Array:
    """Return the relative standard error of each rival's size."""
    statistic = np.array([max(rival.score.statistic, 1.0) for rival in question.rivals])
    return np.asarray(1 / np.sqrt(statistic))


def decided(question: Question, chance: Array) -> float:
    """Return the probability that the question ends with the right name alone."""
    share = question.probabilities
    weight = np.array([share[rival.name] for rival in question.rivals])
    return float(weight @ np.prod(chance, axis=1))
