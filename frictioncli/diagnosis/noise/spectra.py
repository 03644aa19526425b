r"""Covariance spectrum of pair means: white noise plus drift, over a grid of noise models.

The covariance of a channel's pair means is

.. math:: V = a\,(H + \rho\,R_\theta)

with a known diagonal :math:`H` of the white part, the drift's correlation
:math:`R_\theta = e^{-|t_i - t_j| / \theta}` within each run (an Ornstein-Uhlenbeck process), its
variance :math:`\rho` relative to the white part and the scale :math:`a`. The inverse :math:`T` of
:math:`H^{-1/2} R_\theta H^{-1/2}` is tridiagonal, so that many noise models can be tried at little
cost with

.. math:: (I + \rho T^{-1})^{-1} = I - \rho (T + \rho I)^{-1} .

One eigendecomposition :math:`T^{-1} = U \Lambda U^\mathsf{T}` for a :math:`\theta` that is chosen
makes every :math:`V` diagonal,
:math:`U^\mathsf{T} H^{-1/2} V H^{-1/2} U = a (I + \rho \Lambda)`, so that many candidate
explanations can be tried.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

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


@dataclass(frozen=True, kw_only=True)
class Spectrum:
    """The drift's correlation at one correlation time, by its inverse that is tridiagonal.

    Attributes
    ----------
    time : float
        Correlation time. [s]
    runs : tuple of slice
        Pairs of each run.
    diagonal, beside : ndarray, shape (pairs,)
        The inverse: its diagonal, and what stands beside it, the last of each run zero.
    factor : (ndarray, ndarray), shape (pairs,) and one less
        Its Cholesky factor.
    within : float
        Mean square of the drift about its mean over a run, as a share of its variance.
    """

    time: float
    runs: tuple[slice, ...]
    diagonal: Array
    beside: Array
    factor: tuple[Array, Array]
    within: float

    @classmethod
    def of(
        cls, time: Array, correlation_time: float, profile: Array, runs: tuple[slice, ...]
    ) -> "Spectrum":
        """Return the correlation of a Markov process at the times of the pairs."""
        diagonal, beside = np.ones(len(time)), np.zeros(len(time))
        root = np.sqrt(profile)
        for part in runs:
            step = np.clip(np.diff(time[part]) / correlation_time, _SHORTEST, _LONGEST)
            both = 1.0 / np.expm1(2 * step)
            diagonal[part][1:] += both
            diagonal[part][:-1] += both
            beside[part][:-1] = -np.exp(step) * both * root[part][1:] * root[part][:-1]
        diagonal *= profile
        factor = _factor(diagonal, beside)
        solved, _ = lapack.dpttrs(*factor, root)
        means = [float(root[part] @ solved[part]) / len(root[part]) for part in runs]
        within = 1.0 - sum(means) / len(root)
        return cls(
            time=correlation_time,
            runs=runs,
            diagonal=diagonal,
            beside=beside,
            factor=factor,
            within=within,
        )

    @property
    def values(self) -> Array:
        """Eigenvalues of the correlation, run after run, shape (pairs,)."""
        return self._eigen[0]

    @property
    def vectors(self) -> tuple[Array, ...]:
        """Eigenvectors of each run, shape (pairs of the run, pairs of the run)."""
        return self._eigen[1]

    @cached_property
    def _eigen(self) -> tuple[Array, tuple[Array, ...]]:
        decomposed = [
            eigh_tridiagonal(self.diagonal[part], self.beside[part][:-1], check_finite=False)
            for part in self.runs
        ]
        inverses, vectors = zip(*decomposed, strict=True)
        return 1.0 / np.concatenate(inverses), vectors


def _factor(diagonal: Array, beside: Array) -> tuple[Array, Array]:
    """Return the Cholesky factor of a matrix that is tridiagonal."""
    factor, coupling, _ = lapack.dpttrf(diagonal, beside[:-1])
    return factor, coupling


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
    determinants : ndarray, shape (noise models,)
        Logarithm of the determinant of each covariance.
    """

    strengths: Array
    factor: tuple[Array, Array]
    determinants: Array

    @classmethod
    def of(cls, spectra: Spectra, indices: Iterable[NoiseIndex]) -> "InverseCovariances":
        """Return those of the noise models of a channel."""
        times, numbers = zip(*indices, strict=True)
        strengths, chosen = STRENGTHS[list(numbers)], [spectra.spectra[time] for time in times]
        shifted = np.array([one.diagonal for one in chosen]) + strengths[:, np.newaxis]
        factor = _factor(shifted.ravel(), np.concatenate([one.beside for one in chosen]))
        pivots = factor[0].reshape(shifted.shape) / np.array([one.factor[0] for one in chosen])
        return cls(strengths, factor, np.sum(np.log(pivots), axis=1))

    def times(self, scaled: Array) -> Array:
        """Return each times columns of scaled pair means.

        Parameters
        ----------
        scaled : ndarray, shape (pairs, columns)
            The columns.

        Returns
        -------
        ndarray, shape (noise models, pairs, columns)
        """
        count = len(self.strengths)
        solved, _ = lapack.dpttrs(*self.factor, np.tile(scaled, (count, 1)))
        drift = self.strengths[:, np.newaxis, np.newaxis] * solved.reshape(count, *scaled.shape)
        return np.asarray(scaled - drift)


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
        Spectrum.of(layout.time, float(time), profile, runs) for time in times
    )
    return Spectra(
        profile=profile,
        known=float(np.mean(known)),
        white=float(np.mean(white)),
        runs=runs,
        spectra=spectra,
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
