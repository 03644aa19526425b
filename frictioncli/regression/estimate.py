"""Parameters of the equation of motion with their covariance, by a jackknife of blocks of time."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.distributions import t_quantile
from frictioncli.regression.equation import EquationTerms

TOLERANCE = 1e-11
"""Share of the greatest eigenvalue of inner products below which one counts as zero."""

_SIGNIFICANT = 3.0
"""Standard deviations from 0 from which a parameter is told from it."""

_LEAST_SIZE = 1e-100
"""Of a column that is no column of zeros: its square is a number, too."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RegressionEstimate:
    """Parameters of the equation of motion of one joint.

    Attributes
    ----------
    terms : EquationTerms
        The terms.
    parameters : dict of str to float
        Parameters by name: linear ones, delta, delay. [torque unit per unit of the column]
    covariance : ndarray, shape (names, names)
        Their covariance, in that order.
    blocks : int
        Blocks of time of the jackknife.
    residual : ndarray, shape (rows,)
        Measured minus modelled torque. [torque unit]
    held_out : float
        Root mean square of the error of each block, predicted from the others. [torque unit]
    squared_load : ndarray, shape (rows,)
        Square of the load in the friction. [(N·m)²]
    condition : float
        Condition number of the columns at unit length. [-]
    noise_order : int
        Order of the noise's autoregressive process.
    downweighted : int
        Rows with less than half of the weight of the others.
    """

    terms: EquationTerms
    parameters: dict[str, float]
    covariance: Array
    blocks: int
    residual: Array
    held_out: float
    squared_load: Array
    condition: float
    noise_order: int
    downweighted: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(self.parameters)

    @property
    def delay(self) -> float:
        """Delay of the torque [s]."""
        return self.parameters.get("delay", 0.0)

    @property
    def load_coefficients(self) -> Array:
        """Coefficients of :func:`~frictioncli.regression.equation.load_columns`."""
        return np.array([self.parameters[name] for name in self.terms.load_names])

    @property
    def rmse(self) -> float:
        """Root mean square of the residual [torque unit]."""
        return float(np.sqrt(np.mean(np.square(self.residual))))

    def deviation(self, name: str) -> float:
        """Return the standard deviation of a parameter."""
        index = self.names.index(name)
        return float(np.sqrt(max(self.covariance[index, index], 0.0)))

    def told(self, name: str) -> bool:
        """Return whether a parameter is told from zero."""
        return abs(self.parameters[name]) > _SIGNIFICANT * self.deviation(name)

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Return the confidence interval of a parameter."""
        half = self.quantile(level) * self.deviation(name)
        return self.parameters[name] - half, self.parameters[name] + half

    def quantile(self, level: float = 0.95) -> float:
        """Return Student's quantile for the blocks."""
        return t_quantile(0.5 + level / 2, max(self.blocks - 1, 1))


def left_out_changes(columns: Array, derivatives: Array, target: Array, block: Numbers) -> Array:
    """Return the change of the parameters where each block is left out, shape (blocks, names).

    Parameters
    ----------
    columns, derivatives : ndarray, shape (rows, names)
        The parameters solve ``columns.T @ residual = 0``; residuals change by ``derivatives``.
    target : ndarray, shape (rows,)
        The residuals, with their weights.
    block : ndarray of int, shape (rows,)
        Block of each row, from 0.
    """
    order = np.argsort(block, kind="stable")
    edges = np.searchsorted(block[order], np.arange(int(block.max()) + 2))
    columns, derivatives, target = columns[order], derivatives[order], target[order]
    grams, rights = [], []
    for begin, end in pairwise(edges.tolist()):
        part = columns[begin:end]
        grams.append(part.T @ derivatives[begin:end])
        rights.append(part.T @ target[begin:end])
    gram, right = np.sum(grams, axis=0), np.sum(rights, axis=0)
    size = np.linalg.norm(columns, axis=0)
    # a column of zeros, as of a torque that never changes, has no parameter to change
    size = np.where(size > _LEAST_SIZE, size, 1.0)
    scale = np.outer(size, size)
    return np.stack(
        [
            np.linalg.pinv((gram - one) / scale, rcond=TOLERANCE) @ ((right - own) / size) / size
            for one, own in zip(grams, rights, strict=True)
        ]
    )
