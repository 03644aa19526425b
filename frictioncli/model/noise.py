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

import math
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import inverse_and_determinant
from frictioncli.model.drift import (
    LEAST_DRIFT,
    Drift,
    correlated,
    inverse_diagonal,
    posterior_factor,
    solved,
    whitened,
)
from frictioncli.model.likeliest_noise import NoiseLikelihood, likeliest

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

    def unpredictable(self, distance: float) -> float:
        """Return the RMS of what no model can predict: what is new with each pair [N·m].

        Of the drift that is next to nothing, unless it changes from pair to pair, as pair noise.

        Parameters
        ----------
        distance : float
            Time from pair to pair. [s]
        """
        renewed = -math.expm1(-2 * distance / self.drift_time) if self.drift_time > 0 else 1.0
        return math.sqrt(self.point**2 + self.pair**2 + renewed * self.drift**2)


@dataclass(frozen=True, slots=True)
class PairCovariance:
    """Covariance of pair means: ``diag(white) + drift² exp(-|Δt|/θ)`` within each run.

    Attributes
    ----------
    white : ndarray, shape (pairs,)
        Variance that is independent between pairs. [(N·m)²]
    factor : ndarray, shape (2, pairs)
        Factors of the drift's precision plus ``1/white``.
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
        return solved(self.factor, self.white, right)

    def inverse_diagonal(self) -> Array:
        """Return the diagonal of the inverse covariance, shape (pairs,) [1/(N·m)²]."""
        return inverse_diagonal(self.factor, self.white)

    def times(self, right: Array) -> Array:
        """Return the covariance times ``right``, shape (pairs, columns)."""
        drift = self.drift**2 * correlated(self.correlation, right)
        return (right.T * self.white).T + drift

    def whitened(self, right: Array) -> Array:
        """Return columns made white by the covariance, shape (pairs, columns) [-]."""
        return whitened(self.correlation, self.drift, self.white, right)

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
    return _covariance(noise, Drift.of(time, run, noise.drift_time), bins, extra)


def _covariance(noise: Noise, drift: Drift, bins: Array, extra: Array | float) -> PairCovariance:
    """Return the covariance of pair means whose drift is correlated as given."""
    white = noise.pair**2 + noise.point**2 / bins + extra
    # a drift of zero would have an infinite precision: it is replaced by a negligible one
    variance = max(noise.drift**2, LEAST_DRIFT * float(np.mean(white)))
    factor = posterior_factor(drift.diagonal / variance, drift.beside / variance, white)
    log_determinant = (
        np.sum(np.log(factor[0]))
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
    solved_design = covariance.solve(design)
    inverse, determinant = inverse_and_determinant(design.T @ solved_design)
    projected = residual @ solved_design
    quadratic = residual @ covariance.solve(residual) - projected @ inverse @ projected
    return float(-0.5 * (covariance.log_determinant + determinant + quadratic))


def orthonormal_basis(design: Array) -> Array:
    """Return an orthonormal basis of columns that may be collinear and differ widely in unit.

    Parameters
    ----------
    design : ndarray, shape (pairs, parameters)
        The columns.
    """
    length = np.linalg.norm(design, axis=0)
    basis, size, _ = np.linalg.svd(design / np.where(length > 0, length, 1.0), full_matrices=False)
    return np.asarray(basis[:, size > 1e-9 * size[0]])


def plausible_noise(
    *,
    residual: Array,
    design: Array,
    time: Array,
    run: Indices,
    bins: Array,
    point: float,
    extra: Array | float = 0.0,
    shared: Array | None = None,
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
    shared : ndarray, shape (components, pairs), optional
        Standard deviations of what all pairs of a run share, each component on its own. [N·m]

    Returns
    -------
    list of (Noise, float)
        The weights sum to 1.
    """
    columns = np.column_stack([orthonormal_basis(design), residual])
    scale = max(float(np.std(residual)), 1e-9)
    gaps = np.diff(time)[np.diff(run) == 0]
    shortest = max(float(np.median(gaps)), 1e-3) if gaps.size else 1.0
    # a drift slower than the run is an offset of the run, as tau_c is
    longest = max(max(np.ptp(time[run == number]) for number in np.unique(run)), 2 * shortest)

    bounds = float(np.log(scale * 1e-3)), float(np.log(scale * 10))
    durations = np.geomspace(shortest, longest, _DRIFT_TIMES).tolist()
    drifts = [Drift.of(time, run, duration) for duration in durations]
    common = np.zeros((0, len(time))) if shared is None else shared
    likelihood = NoiseLikelihood.of(columns, point**2 / bins + extra, drifts, run, common)
    logs, values = likeliest(likelihood, np.log([scale / 2, scale / 2]), bounds)
    weights = np.exp(values - values.max())
    weights /= weights.sum()
    found = [
        (Noise(point=point, pair=pair, drift=drift, drift_time=duration), weight)
        for (pair, drift), duration, weight in zip(
            np.exp(logs).tolist(), durations, weights.tolist(), strict=True
        )
    ]
    return sorted(found, key=lambda entry: -entry[1])
