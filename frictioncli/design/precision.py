"""How narrow a programme makes intervals.

The gain is half the fall of the log determinant of the covariance of the parameters that matter
(D_s-optimality [1]_), in nats.

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
from frictioncli.linear_algebra import scaled_gram_inverse


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
    sight: Information,
    opening: OpenQuestions,
    prior: Array,
    names: Sequence[str],
    told: Sequence[str],
) -> Precision:
    """Return the covariance of parameters.

    Parameters
    ----------
    sight : Information
        Rows and noise.
    opening : OpenQuestions
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
    covariance = scaled_gram_inverse(total, tolerance=1e-13)
    chosen = [list(names).index(name) for name in told]
    return Precision(tuple(told), covariance[np.ix_(chosen, chosen)])


def _model(problem: Problem, opening: OpenQuestions) -> ModelColumns:
    """Return the columns of base and likeliest causes."""
    bases = (problem.basis(one.effect, one.shape) for one in opening.causes)
    return joined([base_columns(problem), *(basis_columns(problem, basis) for basis in bases)])
