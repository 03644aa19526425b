r"""Noise of pairs and drift that is likeliest, at all correlation times of the drift at once.

With the residuals *y*, an orthonormal basis *X* of the design and the covariance *V* of the pair
means, minus the restricted log likelihood [1]_ is

.. math:: \tfrac12 (\ln |V| + \ln |X^\mathsf{T} V^{-1} X| + y^\mathsf{T} P y) , \quad
    P = V^{-1} - V^{-1} X (X^\mathsf{T} V^{-1} X)^{-1} X^\mathsf{T} V^{-1} .

Its derivatives by the logarithms of the two standard deviations, with
:math:`V_i = \partial V / \partial \ln \sigma_i`, are
:math:`\tfrac12 (\operatorname{tr} P V_i - y^\mathsf{T} P V_i P y)`; for the second ones stands
the average information [2]_, :math:`\tfrac12 y^\mathsf{T} P V_i P V_j P y`. The correlation times
do not know of each other: their pairs stand one below the other in one tridiagonal system. What all
pairs of a run share adds :math:`Z Z^\mathsf{T}` to *V*, by Woodbury's identity in each run.

References
----------
.. [1] H. D. Patterson and R. Thompson, "Recovery of inter-block information when block sizes are
   unequal," Biometrika 58(3), 1971, doi:10.1093/biomet/58.3.545.
.. [2] A. R. Gilmour, R. Thompson and B. R. Cullis, "Average information REML: an efficient
   algorithm for variance parameter estimation in linear mixed models," Biometrics 51(4), 1995,
   doi:10.2307/2533274.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.model.drift import (
    LEAST_DRIFT,
    Drift,
    inverse_diagonal,
    posterior_factor,
    run_starts,
    solved,
)

_FARTHEST = 2.0
"""Greatest change of a logarithm in one round."""

_ROUNDS = 100
"""Greatest number of rounds."""

_CLOSE = 1e-9
"""Gain in log likelihood, relative to it, that is not worth another round."""

_LEAST_DAMPING = 1e-6
"""Least damping, as a share of the curvature; where a step fails it is 1, then grows tenfold."""


@dataclass(frozen=True, slots=True)
class Costs:
    """Minus the restricted log likelihoods at some correlation times, with their derivatives.

    Attributes
    ----------
    value : ndarray, shape (times,)
        The costs.
    gradient : ndarray, shape (times, 2)
        Derivatives by the logarithms of pair noise and drift.
    curvature : ndarray, shape (times, 2, 2)
        Average information.
    """

    value: Array
    gradient: Array
    curvature: Array


@dataclass(frozen=True, slots=True)
class NoiseLikelihood:
    """Restricted likelihood of the noise of pair means, for drifts of several correlation times.

    Attributes
    ----------
    columns : ndarray, shape (pairs, columns)
        Orthonormal basis of the design and, last, the residuals. [N·m]
    known : ndarray, shape (pairs,)
        Variance that is independent between pairs, without the noise of pairs. [(N·m)²]
    diagonal, beside : ndarray, shape (times, pairs)
        Precision of the drifts of variance 1.
    log_determinants : ndarray, shape (times,)
        Of their covariances.
    run : ndarray of int, shape (pairs,)
        Run of each pair, from 0; pairs of a run stand together.
    shared : ndarray, shape (components, pairs)
        Standard deviations of what all pairs of a run share, each component on its own. [N·m]
    """

    columns: Array
    known: Array
    diagonal: Array
    beside: Array
    log_determinants: Array
    run: Indices
    shared: Array

    @classmethod
    def of(
        cls,
        columns: Array,
        known: Array,
        drifts: Sequence[Drift],
        run: Indices,
        shared: Array,
    ) -> "NoiseLikelihood":
        """Return the likelihood of drifts.

        Parameters
        ----------
        columns : ndarray, shape (pairs, columns)
            Orthonormal basis of the design and, last, the residuals. [N·m]
        known : ndarray, shape (pairs,)
            Variance that is independent between pairs, without the noise of pairs. [(N·m)²]
        drifts : sequence of Drift
            The drifts.
        run : ndarray of int, shape (pairs,)
            Run of each pair; pairs of a run stand together.
        shared : ndarray, shape (components, pairs)
            Standard deviations of what all pairs of a run share. [N·m]
        """
        return cls(
            columns,
            known,
            np.array([one.diagonal for one in drifts]),
            np.array([one.beside for one in drifts]),
            np.array([one.log_determinant for one in drifts]),
            np.cumsum(np.diff(run, prepend=run[0]) != 0),
            shared,
        )

    def costs(self, logs: Array, times: Indices) -> Costs:
        """Return minus the restricted log likelihoods.

        Parameters
        ----------
        logs : ndarray, shape (times, 2)
            Logarithms of the standard deviations of pairs and drift.
        times : ndarray of int, shape (times,)
            Numbers of the drifts to which they belong.
        """
        pair, drift = np.exp(2 * logs).T
        white = self.known + pair[:, np.newaxis]
        mean = LEAST_DRIFT * np.mean(white, axis=1)
        variance = np.maximum(drift, mean)[:, np.newaxis]
        factor = posterior_factor(
            (self.diagonal[times] / variance).ravel(),
            (self.beside[times] / variance).ravel(),
            white.ravel(),
        )

        def solve_within(columns: Array) -> Array:
            """Return the inverse covariances without what runs share times columns."""
            right = np.broadcast_to(columns, (len(columns), *white.shape))
            flat = right.reshape(len(columns), white.size)
            return solved(factor, white.ravel(), flat.T).T.reshape(right.shape)

        alone = solve_within(self.shared[:, np.newaxis])
        products = np.moveaxis(self._by_run(alone), 0, 3)
        together = np.linalg.inv(np.eye(len(alone)) + products)
        spread = np.einsum("tpij,jtp->itp", together[:, self.run], alone)

        def solve(columns: Array) -> Array:
            """Return the inverse covariances times columns, shape (columns, times, pairs)."""
            inner = solve_within(columns)
            return inner - np.einsum("itp,ctpi->ctp", spread, self._by_run(inner)[:, :, self.run])

        design, residual = self.columns[:, :-1].T, self.columns[:, -1]
        inner = solve(self.columns.T[:, np.newaxis])
        across = inner[:-1].swapaxes(0, 1)
        products = inner.swapaxes(0, 1) @ self.columns
        inverse = np.linalg.inv(products[:, :-1, :-1])
        coefficients = (inverse @ products[:, :-1, -1:])[:, :, 0]
        quadratic = products[:, -1, -1] - np.sum(products[:, -1, :-1] * coefficients, axis=1)
        determinant = (
            np.sum(np.log(factor[0].reshape(white.shape) * white), axis=1)
            + self.log_determinants[times]
            + len(residual) * np.log(variance[:, 0])
            - np.linalg.slogdet(inverse)[1]
            - np.sum(np.linalg.slogdet(together)[1], axis=1)
        )
        left = inner[-1] - (coefficients[:, np.newaxis] @ across)[:, 0]
        taken = np.sum((inverse @ across) * across, axis=1)
        diagonal = inverse_diagonal(factor, white.ravel()).reshape(white.shape) - taken
        diagonal -= np.sum(spread * alone, axis=0)
        # the drift's share of the covariance is what is neither white nor shared by runs
        common = self._by_run(left)
        slow = residual - coefficients @ design - white * left
        slow -= np.einsum("tpi,ip->tp", common[:, self.run], self.shared)
        by_pair = pair * (np.sum(diagonal, axis=1) - np.sum(np.square(left), axis=1))
        by_drift = len(residual) - len(design) - np.sum(diagonal * white + residual * left, axis=1)
        by_drift += np.sum(white * np.square(left), axis=1) + np.sum(np.square(common), axis=(1, 2))
        # the trace of P Z Z'
        by_drift -= np.sum(len(alone) - np.trace(together, axis1=2, axis2=3), axis=1)
        shares = self._by_run(across.swapaxes(0, 1)).transpose(1, 2, 3, 0)
        by_drift += np.sum((shares @ inverse[:, np.newaxis]) * shares, axis=(1, 2, 3))
        # q_i = V_i P y / 2
        halves = np.array([pair[:, np.newaxis] * left, slow])
        halves[1, drift < mean], by_drift = 0.0, np.where(drift < mean, 0.0, by_drift)
        projected = across @ halves.transpose(1, 2, 0)
        curvature = halves.swapaxes(0, 1) @ solve(halves).transpose(1, 2, 0)
        curvature -= projected.swapaxes(1, 2) @ inverse @ projected
        return Costs(
            (determinant + quadratic) / 2, np.column_stack([by_pair, by_drift]), 2 * curvature
        )

    def _by_run(self, columns: Array) -> Array:
        """Return the products of what runs share with columns, shape (..., runs, components)."""
        products = columns[..., np.newaxis, :] * self.shared
        return np.add.reduceat(products, run_starts(self.run), axis=-1).swapaxes(-1, -2)


def likeliest(
    likelihood: NoiseLikelihood, start: Array, bounds: tuple[float, float]
) -> tuple[Array, Array]:
    """Return the likeliest noise at each correlation time, by damped Newton steps.

    Parameters
    ----------
    likelihood : NoiseLikelihood
        The likelihood.
    start : ndarray, shape (2,)
        Logarithms of the standard deviations of pairs and drift.
    bounds : (float, float)
        Bounds of both.

    Returns
    -------
    logs : ndarray, shape (times, 2)
        The logarithms.
    value : ndarray, shape (times,)
        The restricted log likelihoods.
    """
    times = np.arange(len(likelihood.diagonal))
    logs = np.tile(start, (len(times), 1))
    best = likelihood.costs(logs, times)
    damping = np.full(len(times), _LEAST_DAMPING)
    for _ in range(_ROUNDS):
        step = _steps(best, logs, damping, bounds)
        gain = -np.sum(best.gradient * step, axis=1)
        going = np.flatnonzero(gain > _CLOSE * np.maximum(np.abs(best.value), 1.0))
        if not going.size:
            break
        tried = logs[going] + step[going]
        found = likelihood.costs(tried, times[going])
        better = found.value <= best.value[going]
        less, more = damping[going] / 10, damping[going] * 10
        damping[going] = np.where(better, np.maximum(less, _LEAST_DAMPING), np.maximum(more, 1.0))
        taken = going[better]
        logs[taken] = tried[better]
        best.value[taken] = found.value[better]
        best.gradient[taken] = found.gradient[better]
        best.curvature[taken] = found.curvature[better]
    return logs, -best.value


def _steps(costs: Costs, logs: Array, damping: Array, bounds: tuple[float, float]) -> Array:
    """Return damped Newton steps, the best ones within bounds, shape (times, 2)."""
    lower = np.maximum(bounds[0] - logs, -_FARTHEST)
    upper = np.minimum(bounds[1] - logs, _FARTHEST)
    gradient, matrix = costs.gradient, costs.curvature.copy()
    diagonal = np.einsum("kii->ki", matrix)
    diagonal += damping[:, np.newaxis] * (1 + diagonal)
    step = np.clip(-np.linalg.solve(matrix, gradient[:, :, np.newaxis])[:, :, 0], lower, upper)
    # where one of both is at a bound, the other suits it; else that changes nothing
    slope = gradient + step[:, ::-1] * matrix[:, :1, 1]
    tried = np.array([step, step])
    for one, other in ((0, 1), (1, 0)):
        suited = -slope[:, one] / diagonal[:, one]
        tried[other, :, one] = np.clip(suited, lower[:, one], upper[:, one])
    curved = (tried[:, :, np.newaxis] @ matrix @ tried[:, :, :, np.newaxis])[:, :, 0, 0]
    first, second = np.sum(tried * gradient, axis=2) + curved / 2
    return np.where((first <= second)[:, np.newaxis], *tried)
