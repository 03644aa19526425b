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
from scipy.linalg.lapack import dpbtrf, dpbtrs
from scipy.optimize import minimize

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import inverse_and_determinant

_LEAST_DRIFT = 1e-9
"""Least variance of the drift, relative to the mean of what is independent between pairs."""

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
        smooth, _ = dpbtrs(self.factor, weighted)
        return weighted - (smooth.T / self.white).T

    def inverse_diagonal(self) -> Array:
        """Return the diagonal of the inverse covariance, shape (pairs,) [1/(N·m)²]."""
        # pivots of the tridiagonal matrix from its start and from its end
        pivots = np.square(self.factor[1])
        diagonal = pivots.copy()
        diagonal[1:] += np.square(self.factor[0, 1:])
        reverse = np.zeros_like(self.factor)
        reverse[0, 1:] = (self.factor[0, 1:] * self.factor[1, :-1])[::-1]
        reverse[1] = diagonal[::-1]
        backward, _ = dpbtrf(reverse)
        smooth = 1 / (pivots + np.square(backward[1, ::-1]) - diagonal)
        return np.asarray((1 - smooth / self.white) / self.white)

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
    return _covariance(noise, _Drift.of(time, run, noise.drift_time), bins, extra)


@dataclass(frozen=True, slots=True)
class _Drift:
    """Drift of variance 1 with one correlation time: its tridiagonal precision."""

    correlation: Array
    diagonal: Array
    beside: Array
    log_determinant: float

    @classmethod
    def of(cls, time: Array, run: Indices, duration: float) -> "_Drift":
        step = np.where(np.diff(run) == 0, np.diff(time), np.inf)
        decay = np.exp(-np.maximum(step, 1e-3) / duration)
        decay = np.minimum(decay, 1 - 1e-9)
        correlation = np.concatenate([[0.0], decay])
        innovation = 1 - np.square(correlation)
        diagonal = 1 / innovation
        diagonal[:-1] += np.square(decay) / innovation[1:]
        determinant = float(np.sum(np.log(innovation)))
        return cls(correlation, diagonal, -decay / innovation[1:], determinant)


def _covariance(noise: Noise, drift: _Drift, bins: Array, extra: Array | float) -> PairCovariance:
    """Return the covariance of pair means whose drift is correlated as given."""
    white = noise.pair**2 + noise.point**2 / bins + extra
    # a drift of zero would have an infinite precision: it is replaced by a negligible one
    variance = max(noise.drift**2, _LEAST_DRIFT * float(np.mean(white)))
    banded = np.zeros((2, len(white)))
    banded[0, 1:] = drift.beside / variance
    banded[1] = drift.diagonal / variance + 1 / white
    factor, fault = dpbtrf(banded)
    if fault:
        raise np.linalg.LinAlgError("the covariance of the pair means is not positive definite")
    log_determinant = (
        2 * np.sum(np.log(factor[1]))
        + np.sum(np.log(white))
        + drift.log_determinant
        + len(white) * np.log(variance)
    )
    return PairCovariance(
        white=white,
        factor=factor,
        log_determinant=float(log_determinant),
        correlation=drift.correlation,
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
    return _restricted(covariance, np.column_stack([design, residual]))[0]


def _restricted(covariance: PairCovariance, columns: Array) -> tuple[float, Array, Array, Array]:
    """Return the restricted log likelihood, and what its derivatives need.

    The columns are those of the design and the residuals. The inverse covariance times the design,
    the covariance of its parameters, and the inverse covariance times what they leave come second.
    """
    solved = covariance.solve(columns)
    own = solved[:, -1]
    products = columns.T @ solved
    information, projected = products[:-1, :-1], products[:-1, -1]
    inverse, determinant = inverse_and_determinant(information)
    coefficients = inverse @ projected
    quadratic = products[-1, -1] - projected @ coefficients
    likelihood = covariance.log_determinant + determinant + quadratic
    left = own - solved[:, :-1] @ coefficients
    return float(-0.5 * likelihood), solved[:, :-1], inverse, left


def _cost(noise: Noise, covariance: PairCovariance, columns: Array) -> tuple[float, Array]:
    """Return minus the restricted log likelihood and its derivatives by ln(pair), ln(drift)."""
    likelihood, solved, inverse, left = _restricted(covariance, columns)
    residual, white = columns[:, -1], covariance.white
    taken = np.sum((solved @ inverse) * solved, axis=1)
    diagonal = covariance.inverse_diagonal() - taken
    pair = noise.pair**2 * (np.sum(diagonal) - left @ left)
    if noise.drift**2 < _LEAST_DRIFT * float(np.mean(white)):
        return -likelihood, np.array([pair, 0.0])
    # the drift's share of the covariance is what is not white
    square = residual @ left - left @ (white * left)
    freedom = len(residual) - len(inverse) - diagonal @ white
    return -likelihood, np.array([pair, freedom - square])


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
    columns = np.column_stack([basis[:, size > 1e-9 * size[0]], residual])
    scale = max(float(np.std(residual)), 1e-9)
    gaps = np.diff(time)[np.diff(run) == 0]
    shortest = max(float(np.median(gaps)), 1e-3) if gaps.size else 1.0
    # a drift slower than the run is an offset of the run, as tau_c is
    longest = max(max(np.ptp(time[run == number]) for number in np.unique(run)), 2 * shortest)

    def of(logs: Array, duration: float) -> Noise:
        pair, drift = np.exp(logs)
        return Noise(point=point, pair=float(pair), drift=float(drift), drift_time=duration)

    def cost(logs: Array, drift: _Drift, duration: float) -> tuple[float, Array]:
        noise = of(logs, duration)
        return _cost(noise, _covariance(noise, drift, bins, extra), columns)

    bounds = [(np.log(scale * 1e-3), np.log(scale * 10))] * 2
    start = np.log([scale / 2, scale / 2])
    found = []
    for duration in np.geomspace(shortest, longest, _DRIFT_TIMES):
        drift = _Drift.of(time, run, float(duration))
        best = minimize(
            cost, start, args=(drift, duration), jac=True, method="L-BFGS-B", bounds=bounds
        )
        found.append((of(best.x, float(duration)), -float(best.fun)))
    highest = max(likelihood for _, likelihood in found)
    weights = [np.exp(likelihood - highest) for _, likelihood in found]
    weighted = [
        (noise, float(weight / sum(weights)))
        for (noise, _), weight in zip(found, weights, strict=True)
    ]
    return sorted(weighted, key=lambda entry: -entry[1])
