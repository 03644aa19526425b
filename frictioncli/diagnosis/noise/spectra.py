r"""Covariance spectrum of pair means: white noise plus drift, over a grid of noise models.

The covariance of a channel's pair means is

.. math:: V = a\,(H + \rho\,R_\theta)

with a known diagonal :math:`H` of the white part, the drift's correlation
:math:`R_\theta = e^{-|t_i - t_j| / \theta}` within each run (an Ornstein-Uhlenbeck process), its
variance :math:`\rho` relative to the white part and the scale :math:`a`. One eigendecomposition

.. math:: H^{-1/2} R_\theta H^{-1/2} = U \Lambda U^\mathsf{T}

for each :math:`\theta` makes every :math:`V` diagonal,
:math:`U^\mathsf{T} H^{-1/2} V H^{-1/2} U = a (I + \rho \Lambda)`, so that many noise models can be
tried on many candidate explanations at little cost. The inverse :math:`T` of
:math:`H^{-1/2} R_\theta H^{-1/2}` is tridiagonal, so that a single column takes less time yet with

.. math:: (I + \rho T^{-1})^{-1} = I - \rho (T + \rho I)^{-1} .
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh_tridiagonal, lapack

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout

NoiseIndex = tuple[int, int]
"""Index of a noise model in the grid: of its correlation time and of its drift's strength."""

_DECIMALS = 9
"""Of the profile, so that those of one form are equal whatever their scale was."""

_SHORTEST, _LONGEST = 1e-6, 30.0
"""Distances of neighbouring pairs relative to the correlation time that are told from none, and
from any longer one. Beyond these, denormal numbers would slow the decomposition down."""

_TIMES = 6
"""Number of correlation times, from the distance of the pairs to the length of the run."""

STRENGTHS = np.array([0.0, 0.1, 0.4, 1.6, 6.0, 25.0, 100.0, 1000.0])
"""Variances of the drift relative to the white part."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Eigendecomposition of the drift's correlation at one correlation time.

    Attributes
    ----------
    time : float
        Correlation time. [s]
    values : ndarray, shape (pairs,)
        Eigenvalues, run after run.
    vectors : tuple of ndarray
        Eigenvectors of each run, shape (pairs of the run, pairs of the run).
    within : float
        Mean square of the drift about its mean over a run, as a share of its variance.
    diagonal, beside : ndarray, shape (pairs,)
        The inverse that is tridiagonal: its diagonal, and what stands beside it, the last of each
        run zero.
    """

    time: float
    values: Array
    vectors: tuple[Array, ...]
    within: float
    diagonal: Array
    beside: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectra:
    """Noise models of the pair means of one channel, at all correlation times.

    Attributes
    ----------
    profile : ndarray, shape (pairs,)
        Diagonal of H: white variance of each pair relative to the mean one.
    known : float
        Mean of the variance that is known beforehand. [(N·m)²]
    white : float
        Mean of the white variance of the pair means. [(N·m)²]
    runs : tuple of slice
        Pairs of each run.
    spectra : tuple of Spectrum
        One for each correlation time.
    """

    profile: Array
    known: float
    white: float
    runs: tuple[slice, ...]
    spectra: tuple[Spectrum, ...]

    def scaled(self, means: Array) -> Array:
        """Return pair means divided by the profile's root, shape (pairs, ...)."""
        return (means.T / np.sqrt(self.profile)).T

    def modes(self, spectrum: Spectrum, scaled: Array) -> Array:
        """Return scaled pair means in the eigenvectors of a spectrum, shape (pairs, ...)."""
        return np.concatenate(
            [
                vectors.T @ scaled[part]
                for part, vectors in zip(self.runs, spectrum.vectors, strict=True)
            ]
        )

    def modes_at(self, time: int, means: Array) -> Array:
        """Return pair means in the eigenvectors of one correlation time, shape (pairs, ...)."""
        return self.modes(self.spectra[time], self.scaled(means))

    def from_modes(self, spectrum: Spectrum, modes: Array) -> Array:
        """Return scaled pair means from their modes, the inverse of :meth:`modes`."""
        return np.concatenate(
            [
                vectors @ modes[part]
                for part, vectors in zip(self.runs, spectrum.vectors, strict=True)
            ]
        )


@dataclass(frozen=True, slots=True)
class InverseCovariances:
    r"""Inverse covariances of scaled pair means under several noise models at scale 1.

    Attributes
    ----------
    strengths : ndarray, shape (noise models,)
        Variance of the drift of each, relative to the white part.
    factor : (ndarray, ndarray), shape (noise models * pairs,) and one less
        Cholesky factor of :math:`T + \rho I`, noise model after noise model.
    """

    strengths: Array
    factor: tuple[Array, Array]

    @classmethod
    def of(cls, spectra: Spectra, indices: Iterable[NoiseIndex]) -> "InverseCovariances":
        """Return those of the noise models of a channel."""
        times, numbers = zip(*indices, strict=True)
        strengths = STRENGTHS[list(numbers)]
        diagonal = np.array([spectra.spectra[time].diagonal for time in times])
        beside = np.concatenate([spectra.spectra[time].beside for time in times])
        shifted = diagonal + strengths[:, np.newaxis]
        factor, coupling, _ = lapack.dpttrf(shifted.ravel(), beside[:-1])
        return cls(strengths, (factor, coupling))

    def times(self, scaled: Array) -> Array:
        """Return each times a column of scaled pair means, shape (noise models, pairs)."""
        count = len(self.strengths)
        solved, _ = lapack.dpttrs(*self.factor, np.tile(scaled, count))
        return np.asarray(scaled - self.strengths[:, np.newaxis] * solved.reshape(count, -1))


def spectra_of(
    layout: PairLayout,
    point: float,
    extra: Array,
    residual: Array,
    before: Iterable[Spectra] = (),
) -> Spectra:
    """Return the covariance spectra of the pair means of a channel.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    point : float
        Standard deviation of an angle bin about the mean of its pair. [N·m]
    extra : ndarray, shape (pairs,)
        Further variance that is known beforehand, as of an uncertain temperature. [(N·m)²]
    residual : ndarray, shape (pairs,)
        Pair means of the residual of the base model. [N·m]
    before : iterable of Spectra, optional
        Spectra of the same pairs, of which one may have the same profile.

    Notes
    -----
    The scale is fitted later; the white variance beyond what is known only shapes the profile. It
    is estimated from differences of neighbouring pairs at one speed, in which slow causes cancel.
    """
    known = point**2 / layout.bins + extra
    pair = max(_difference_variance(layout, residual) - float(np.mean(known)), 0.0)
    white = known + max(pair, 0.05 * float(np.mean(known)))
    profile: Array = (white / np.mean(white)).round(_DECIMALS)
    heads = np.flatnonzero(np.diff(layout.run, prepend=-1))
    ends = [*heads[1:], len(layout.run)]
    runs = tuple(slice(int(a), int(b)) for a, b in zip(heads, ends, strict=True))
    shortest = layout.distance
    longest = max(float(np.ptp(layout.time[part])) for part in runs)
    times = np.geomspace(shortest, max(longest, 2 * shortest), _TIMES)
    alike = (one.spectra for one in before if np.array_equal(one.profile, profile))
    spectra = next(alike, None) or tuple(
        _spectrum(layout.time, float(time), profile, runs) for time in times
    )
    return Spectra(
        profile=profile,
        known=float(np.mean(known)),
        white=float(np.mean(white)),
        runs=runs,
        spectra=spectra,
    )


def _spectrum(
    time: Array, correlation_time: float, profile: Array, runs: tuple[slice, ...]
) -> Spectrum:
    values, vectors, squares = [], [], 0.0
    inverses: list[Array] = []
    couplings: list[Array] = []
    for part in runs:
        root = np.sqrt(profile[part])
        step = np.clip(np.diff(time[part]) / correlation_time, _SHORTEST, _LONGEST)
        # the drift is a Markov process: the inverse of its correlation is tridiagonal
        diagonal, beside = np.ones(len(root)), 1.0 / np.expm1(2 * step)
        diagonal[1:] += beside
        diagonal[:-1] += beside
        coupling = -np.exp(step) * beside * root[1:] * root[:-1]
        inverses.append(diagonal * profile[part])
        couplings.append(np.append(coupling, 0.0))
        inverse, eigenvectors = eigh_tridiagonal(inverses[-1], coupling, check_finite=False)
        values.append(1.0 / inverse)
        vectors.append(eigenvectors)
        correlation = values[-1] @ np.square(root @ eigenvectors)
        squares += len(root) - float(correlation) / len(root)
    return Spectrum(
        time=correlation_time,
        values=np.concatenate(values),
        vectors=tuple(vectors),
        within=squares / len(profile),
        diagonal=np.concatenate(inverses),
        beside=np.concatenate(couplings),
    )


def _difference_variance(layout: PairLayout, residual: Array) -> float:
    """Return the variance of pair means from the differences of neighbours at one speed. [(N·m)²].

    Half the squared median absolute difference, scaled to that of a normal distribution.
    """
    order = np.lexsort((layout.time, layout.level, layout.run))
    same = (np.diff(layout.level[order]) == 0) & (np.diff(layout.run[order]) == 0)
    differences = np.diff(residual[order])[same]
    if not differences.size:
        return float(np.var(residual))
    return float((1.4826 * np.median(np.abs(differences))) ** 2 / 2)
