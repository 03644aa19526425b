r"""Noise of friction measurements: per point, per pair, and a slow drift over time.

The mean friction torque of pair *i* with :math:`n_i` angle bins is disturbed by

.. math:: \bar e_i + p_i + d(t_i), \quad
    \operatorname{var} = \sigma_e^2 / n_i + \sigma_p^2 + \sigma_d^2

with white :math:`p` and an Ornstein-Uhlenbeck drift :math:`d`, independent between runs, with the
correlation :math:`\exp(-|t_i - t_j| / \theta)`. Treating such data as independent would make
confidence intervals several times too narrow. The drift is a Markov process: its inverse covariance
is tridiagonal [2]_, so that every operation here costs O(pairs).

References
----------
.. [1] H. D. Patterson and R. Thompson, "Recovery of inter-block information when block sizes are
   unequal," Biometrika 58(3), 1971, doi:10.1093/biomet/58.3.545 (restricted likelihood).
.. [2] H. Rue and L. Held, Gaussian Markov Random Fields, 2005, doi:10.1201/9780203492024.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.optimize import minimize

from frictioncli.arrays import Array, Indices

_DRIFT_TIMES = 12
"""Number of correlation times tried, from the distance of the pairs to the length of the run."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """Standard deviations of point noise, pair noise and drift, and its correlation time.

    Attributes
    ----------
    point : float
        Standard deviation of an angle bin about the mean of its pair. [N·m]
    pair : float
        Standard deviation that all bins of a pair share, independent between pairs. [N·m]
    drift : float
        Standard deviation of the slow drift. [N·m]
    drift_time : float
        Correlation time of the drift. [s]
    """

    point: float
    pair: float
    drift: float
    drift_time: float


@dataclass(frozen=True, slots=True)
class PairCovariance:
    """Covariance of pair means: ``diag(white) + drift² exp(-|Δt|/θ)`` within each run.

    Attributes
    ----------
    white : ndarray, shape (pairs,)
        Variance that is independent between pairs. [(N·m)²]
    factor : ndarray, shape (2, pairs)
        Banded Cholesky factor of the drift's precision plus ``1/white``.
    log_determinant : float
        Logarithm of the covariance's determinant.
    correlation : ndarray, shape (pairs,)
        Correlation of each pair's drift with that of the pair before it; 0 where a run starts.
    drift : float
        Standard deviation of the drift. [N·m]
    """

    white: Array
    factor: Array
    log_determinant: float
    correlation: Array
    drift: float

    def solve(self, right: Array) -> Array:
        """Return the inverse covariance times ``right``, shape (pairs, ...)."""
        weighted = (right.T / self.white).T
        smooth = cho_solve_banded((self.factor, False), weighted)
        return weighted - (smooth.T / self.white).T

    def times(self, right: Array) -> Array:
        """Return the covariance times ``right``, shape (pairs, columns)."""
        # the product with exp(-|Δt|/θ), as a first-order recursion forwards and one backwards
        forward, backward = np.array(right), np.array(right)
        for i in range(1, len(right)):
            forward[i] += self.correlation[i] * forward[i - 1]
        for i in range(len(right) - 2, -1, -1):
            backward[i] += self.correlation[i + 1] * backward[i + 1]
        drift = self.drift**2 * (forward + backward - right)
        return (right.T * self.white).T + drift

    def draw(self, generator: np.random.Generator) -> Array:
        """Return one random disturbance of the pair means, shape (pairs,) [N·m]."""
        drift = generator.standard_normal(len(self.white))
        for i in range(1, len(drift)):
            innovation = np.sqrt(1 - self.correlation[i] ** 2)
            drift[i] = self.correlation[i] * drift[i - 1] + innovation * drift[i]
        white = np.sqrt(self.white) * generator.standard_normal(len(self.white))
        return np.asarray(self.drift * drift + white)


def pair_covariance(
    noise: Noise,
    *,
    time: Array,
    run: Indices,
    bins: Array,
    extra: Array | float = 0.0,
) -> PairCovariance:
    """Return the covariance of pair means.

    Parameters
    ----------
    noise : Noise
        Standard deviations and correlation time.
    time : ndarray, shape (pairs,)
        Times, growing within each run. [s]
    run : ndarray of int, shape (pairs,)
        Run of each pair; pairs of a run stand together.
    bins : ndarray, shape (pairs,)
        Number of angle bins averaged in each pair.
    extra : ndarray, shape (pairs,), optional
        Further variance of the pair means, as of an uncertain temperature. [(N·m)²]
    """
    white = noise.pair**2 + noise.point**2 / bins + extra
    # a drift of zero would have an infinite precision: it is replaced by a negligible one
    variance = max(noise.drift**2, 1e-9 * float(np.mean(white)))
    step = np.where(np.diff(run) == 0, np.diff(time), np.inf)
    decay = np.exp(-np.maximum(step, 1e-3) / noise.drift_time)
    decay = np.minimum(decay, 1 - 1e-9)
    innovation = 1 - np.square(np.concatenate([[0.0], decay]))
    diagonal = 1 / innovation
    diagonal[:-1] += np.square(decay) / innovation[1:]
    banded = np.zeros((2, len(time)))
    banded[0, 1:] = -decay / innovation[1:] / variance
    banded[1] = diagonal / variance + 1 / white
    factor = cholesky_banded(banded)
    log_determinant = (
        2 * np.sum(np.log(factor[1]))
        + np.sum(np.log(white))
        + np.sum(np.log(innovation))
        + len(time) * np.log(variance)
    )
    return PairCovariance(
        white=white,
        factor=factor,
        log_determinant=float(log_determinant),
        correlation=np.concatenate([[0.0], decay]),
        drift=noise.drift,
    )


def restricted_log_likelihood(covariance: PairCovariance, residual: Array, design: Array) -> float:
    """Return the restricted log likelihood of pair residuals, up to a constant.

    Parameters
    ----------
    covariance : PairCovariance
        The assumed covariance.
    residual : ndarray, shape (pairs,)
        Residuals of any fit within the span of ``design``. [N·m]
    design : ndarray, shape (pairs, parameters)
        Derivatives of the model by the parameters that were fitted.
    """
    solved = covariance.solve(np.column_stack([design, residual]))
    information = design.T @ solved[:, :-1]
    projected = design.T @ solved[:, -1]
    explained = projected @ np.linalg.solve(information, projected)
    quadratic = residual @ solved[:, -1] - explained
    return float(
        -0.5 * (covariance.log_determinant + np.linalg.slogdet(information)[1] + quadratic)
    )


def plausible_noise(
    *,
    residual: Array,
    design: Array,
    time: Array,
    run: Indices,
    bins: Array,
    point: float,
    extra: Array | float = 0.0,
) -> list[tuple[Noise, float]]:
    """Return noise models with their posterior probabilities, the most probable first.

    One run holds little information on the correlation time of its drift. It is therefore scanned;
    the two standard deviations are fitted at each value by restricted maximum likelihood [1]_, and
    the likelihoods, with a uniform prior in the logarithm of time, become the weights.

    Parameters
    ----------
    residual : ndarray, shape (pairs,)
        Mean residual of each pair. [N·m]
    design : ndarray, shape (pairs, parameters)
        Derivatives of the model by the fitted parameters.
    time : ndarray, shape (pairs,)
        Times, growing within each run. [s]
    run : ndarray of int, shape (pairs,)
        Run of each pair.
    bins : ndarray, shape (pairs,)
        Angle bins of each pair.
    point : float
        Standard deviation of an angle bin, known from within the pairs. [N·m]
    extra : ndarray, shape (pairs,), optional
        Further variance of the pair means that is known beforehand. [(N·m)²]

    Returns
    -------
    list of (Noise, float)
        The weights sum to 1.
    """
    # an orthonormal basis, since columns may be collinear and their units differ widely
    length = np.linalg.norm(design, axis=0)
    basis, size, _ = np.linalg.svd(design / np.where(length > 0, length, 1.0), full_matrices=False)
    basis = basis[:, size > 1e-9 * size[0]]
    scale = max(float(np.std(residual)), 1e-9)
    gaps = np.diff(time)[np.diff(run) == 0]
    shortest = max(float(np.median(gaps)), 1e-3) if gaps.size else 1.0
    # a drift slower than the run is an offset of the run, as tau_c is
    longest = max(max(np.ptp(time[run == number]) for number in np.unique(run)), 2 * shortest)

    def of(logs: Array, duration: float) -> Noise:
        pair, drift = np.exp(logs)
        return Noise(point=point, pair=float(pair), drift=float(drift), drift_time=duration)

    def cost(logs: Array, duration: float) -> float:
        noise = of(logs, duration)
        covariance = pair_covariance(noise, time=time, run=run, bins=bins, extra=extra)
        return -restricted_log_likelihood(covariance, residual, basis)

    bounds = [(np.log(scale * 1e-3), np.log(scale * 10))] * 2
    start = np.log([scale / 2, scale / 2])
    found = []
    for duration in np.geomspace(shortest, longest, _DRIFT_TIMES):
        best = minimize(cost, start, args=(duration,), method="L-BFGS-B", bounds=bounds)
        found.append((of(best.x, float(duration)), -float(best.fun)))
    highest = max(likelihood for _, likelihood in found)
    weights = [np.exp(likelihood - highest) for _, likelihood in found]
    weighted = [
        (noise, float(weight / sum(weights)))
        for (noise, _), weight in zip(found, weights, strict=True)
    ]
    return sorted(weighted, key=lambda entry: -entry[1])
