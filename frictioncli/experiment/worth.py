r"""What a programme is worth: how surely it names the cause, and how narrow it makes intervals.

All of it follows from inner products :math:`G = C' V^{-1} C` of columns under the noise :math:`V`
that the data at hand show, taken over the rows at hand and those to come.

**Discrimination.** If rival A is at work, its torque :math:`s_A` is there. B with any shape and
coefficients, and the base refitted, leaves the noncentrality

.. math:: \lambda_{AB} = \min_B \lVert s_A - X_B c \rVert^2_{V^{-1}}

of it [1]_. New rows add :math:`\delta` to it. The logarithm of the odds of A against B, :math:`D`
by the data at hand, becomes normal with mean :math:`D + \delta/2` and variance :math:`\delta`; A is
named where it exceeds ln 19, a credible set of 95 %.

**Precision.** The gain is half the fall of the log determinant of the covariance of the parameters
that matter (D_s-optimality [2]_), in nats.

References
----------
.. [1] A. C. Atkinson and V. V. Fedorov, "The design of experiments for discriminating between two
   rival models," Biometrika 62(1), 1975, doi:10.1093/biomet/62.1.57.
.. [2] A. C. Atkinson, A. N. Donev and R. D. Tobias, Optimum Experimental Designs, with SAS, 2007.
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
from frictioncli.effects.base import Effect, EffectTable
from frictioncli.experiment.rivals import Opening, Question
from frictioncli.model.noise import Noise, pair_covariance

Array = NDArray[np.float64]

NAMED = float(np.log(19.0))
"""Logarithm of the odds at which a credible set of 95 % has one name."""

_LEAST_SHARE = 0.25
"""What is left, at the least, of a squared size when noise is taken off."""

_SHAPES = 18
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
        The rows of all runs with the way that the joint really travels in a planned run, in units
        of the recorded way at hand. A diagnosis only knows the way that is recorded; where moves
        that heat were not, more of the planned way would be, and a cause that goes with the way
        would look as if it went with another.
    """

    problem: Problem
    noise: tuple[Noise, Noise]
    gone: EffectTable

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
    """Return the noncentrality of each rival against each, shape (rivals, rivals + 1).

    Entry (i, j): how far rival i, if it is at work, is from all that rival j can do. The last
    column is the base alone: a cause that better data leave to the base loses its name, too.

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
    for rival in question.rivals:
        own = []
        for shape in tried_shapes(rival.score.effect, problem, rival.score.shape):
            columns = basis_columns(problem, problem.basis(rival.score.effect, shape))
            own.append(np.arange(first, first + columns.count))
            parts.append(columns)
            first += columns.count
        places.append(own)
    signals = []
    for rival in question.rivals:
        basis = rival.score.effect.evaluate(sight.gone, rival.score.shape)
        coefficients = _shrunk(rival.score)
        torque = [(part @ coefficients)[:, np.newaxis] for part in basis]
        signals.append(reduced(problem.layout, *torque))
    gram = _off(sight.gram(joined([*parts, *signals])), known.count)
    count = len(question.rivals)
    found = np.zeros((count, count + 1))
    for i in range(count):
        found[i, count] = max(float(gram[first + i, first + i]), 0.0)
        for j in range(count):
            if i != j:
                found[i, j] = min(_left(gram, own, first + i) for own in places[j])
    return found


def _shrunk(score: Score) -> Array:
    """Return coefficients less what noise adds to them in the mean.

    A statistic is expected to be its noncentrality plus the number of coefficients: an effect that
    was chosen because it stands out is smaller than it looks.
    """
    count = len(score.coefficients)
    share = max(score.statistic - count, 0.0) / max(score.statistic, 1e-9)
    return np.asarray(score.coefficients * np.sqrt(max(share, _LEAST_SHARE)))


def tried_shapes(
    effect: Effect, problem: Problem, fitted: dict[str, float]
) -> list[dict[str, float]]:
    """Return the shapes of a rival that are tried on rows to come, the fitted one among them."""
    grid = effect.shapes(problem.whole)
    if len(grid) > _SHAPES:
        chosen = np.unique(np.linspace(0, len(grid) - 1, _SHAPES).round().astype(int))
        grid = [grid[place] for place in chosen]
    return [fitted, *grid]


def chances(question: Question, before: Array, after: Array, pairs: int) -> Array:
    """Return the probability that i, if it is at work, leaves j behind, shape (rivals, rivals + 1).

    The last column is the base alone.

    Parameters
    ----------
    question : Question
        The rivals with what the data at hand say.
    before, after : ndarray, shape (rivals, rivals + 1)
        Noncentralities of the rows at hand, and of those with the programme's.
    pairs : int
        Pairs in all: the scale of the noise is estimated from them, so that a likelihood ratio
        grows with their logarithm only.
    """
    evidence = np.array([rival.evidence for rival in question.rivals])
    odds = evidence[:, np.newaxis] - np.append(evidence, 0.0)
    added = pairs * (np.log1p(after / pairs) - np.log1p(before / pairs))
    added = np.maximum(added, 1e-9)
    found = norm.cdf((odds + added / 2 - NAMED) / np.sqrt(added))
    np.fill_diagonal(found, 1.0)
    return np.asarray(found)


def decided(question: Question, chance: Array) -> float:
    """Return the probability that the question ends with the right name alone."""
    share = question.probabilities
    weight = np.array([share[rival.name] for rival in question.rivals])
    return float(weight @ np.prod(chance, axis=1))


@dataclass(frozen=True, slots=True)
class Precision:
    """Covariance of parameters.

    Attributes
    ----------
    names : tuple of str
        Parameters.
    covariance : ndarray, shape (names, names)
        Their covariance by the noise at hand.
    """

    names: tuple[str, ...]
    covariance: Array

    def of(self, names: Sequence[str]) -> "Precision":
        """Return the same of some of the parameters."""
        chosen = [self.names.index(name) for name in names]
        return Precision(tuple(names), self.covariance[np.ix_(chosen, chosen)])

    @property
    def half_widths(self) -> dict[str, float]:
        """Half of each 95 % interval."""
        errors = 1.96 * np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return dict(zip(self.names, map(float, errors), strict=True))

    @property
    def volume(self) -> float:
        """Half the logarithm of the determinant."""
        return 0.5 * float(np.linalg.slogdet(self.covariance)[1])


def precision(
    sight: Sight, opening: Opening, prior: Array, names: Sequence[str], told: Sequence[str]
) -> Precision:
    """Return the covariance of parameters.

    Parameters
    ----------
    sight : Sight
        Rows and noise.
    opening : Opening
        Causes, which are fitted beside the base.
    prior : ndarray, shape (columns,)
        Weights of what is believed beforehand, of the base's and the causes' columns.
    names : sequence of str
        Names of these columns.
    told : sequence of str
        Those that are told; the others are fitted beside them.
    """
    gram = sight.gram(_model(sight.problem, opening))
    total = gram + np.diag(prior)
    size = np.sqrt(np.diag(total))
    inverse = np.linalg.pinv(total / np.outer(size, size), rcond=1e-13, hermitian=True)
    covariance = inverse / np.outer(size, size)
    chosen = [list(names).index(name) for name in told]
    return Precision(tuple(told), covariance[np.ix_(chosen, chosen)])


def _model(problem: Problem, opening: Opening) -> Columns:
    """Return the columns of base and likeliest causes."""
    bases = (problem.basis(one.effect, one.shape) for one in opening.causes)
    return joined([base_columns(problem), *(basis_columns(problem, basis) for basis in bases)])
