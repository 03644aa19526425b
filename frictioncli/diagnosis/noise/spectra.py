r"""Noise of pair means as a set of spectra: white noise plus a drift of any strength and pace.

The covariance of a channel's pair means is

.. math:: V = a\,(H + \rho\,R_\theta)

with a known profile :math:`H` of the white part, the drift's correlation
:math:`R_\theta = e^{-|t_i - t_j| / \theta}` within each run, its strength :math:`\rho` relative to
the white part and the scale :math:`a`. One eigendecomposition of
:math:`H^{-1/2} R_\theta H^{-1/2}` for each :math:`\theta` makes every :math:`V` diagonal, so that
many noises can be asked what they say to many explanations.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout

Modes = tuple[Array, ...]
"""Pair means in the eigenvectors of each correlation time."""

_TIMES = 6
"""Number of correlation times, from the pairs' distance to the run's length."""

STRENGTHS = np.array([0.0, 0.1, 0.4, 1.6, 6.0, 25.0, 100.0, 1000.0])
"""Variances of the drift relative to the white part."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """The drift at one correlation time.

    Attributes
    ----------
    time : float
        Correlation time. [s]
    values : ndarray, shape (pairs,)
        Eigenvalues, run after run.
    vectors : tuple of ndarray
        Eigenvectors of each run.
    """

    time: float
    values: Array
    vectors: tuple[Array, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectra:
    """One channel's noise of pair means at all correlation times.

    Attributes
    ----------
    profile : ndarray, shape (pairs,)
        White variance of each pair relative to the mean one.
    known : float
        Mean of the variance that is known beforehand. [(N·m)²]
    runs : tuple of slice
        Pairs of each run.
    spectra : tuple of Spectrum
        One for each correlation time.
    """

    profile: Array
    known: float
    runs: tuple[slice, ...]
    spectra: tuple[Spectrum, ...]

    def scaled(self, means: Array) -> Array:
        """Return pair means divided by the profile of their white noise."""
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

    def all_modes(self, means: Array) -> Modes:
        """Return pair means in the eigenvectors of each correlation time."""
        return tuple(self.modes_at(time, means) for time in range(len(self.spectra)))

    def unmoded(self, spectrum: Spectrum, modes: Array) -> Array:
        """Return scaled pair means from their modes."""
        return np.concatenate(
            [
                vectors @ modes[part]
                for part, vectors in zip(self.runs, spectrum.vectors, strict=True)
            ]
        )


def spectra_of(layout: PairLayout, point: float, extra: Array, residual: Array) -> Spectra:
    """Return a channel's spectra.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    point : float
        Standard deviation of a row about its pair. [N·m]
    extra : ndarray, shape (pairs,)
        Variance that is known beforehand, as of an uncertain temperature. [(N·m)²]
    residual : ndarray, shape (pairs,)
        Pair means of the misfit off the base. [N·m]

    Notes
    -----
    The white part's size beyond what is known only shapes the profile. It is taken from
    differences of neighbouring pairs at one speed, in which slow causes cancel.
    """
    known = point**2 / layout.bins + extra
    pair = max(_difference_variance(layout, residual) - float(np.mean(known)), 0.0)
    white = known + max(pair, 0.05 * float(np.mean(known)))
    profile = white / np.mean(white)
    heads = np.flatnonzero(np.diff(layout.run, prepend=-1))
    ends = [*heads[1:], len(layout.run)]
    runs = tuple(slice(int(a), int(b)) for a, b in zip(heads, ends, strict=True))
    gaps = np.diff(layout.time)[np.diff(layout.run) == 0]
    shortest = max(float(np.median(gaps)), 1e-3) if gaps.size else 1.0
    longest = max(float(np.ptp(layout.time[part])) for part in runs)
    times = np.geomspace(shortest, max(longest, 2 * shortest), _TIMES)
    return Spectra(
        profile=profile,
        known=float(np.mean(known)),
        runs=runs,
        spectra=tuple(_spectrum(layout.time, float(time), profile, runs) for time in times),
    )


def _spectrum(time: Array, pace: float, profile: Array, runs: tuple[slice, ...]) -> Spectrum:
    values, vectors = [], []
    for part in runs:
        apart = np.abs(time[part, np.newaxis] - time[np.newaxis, part])
        root = np.sqrt(profile[part])
        # numbers next to zero would slow the decomposition down a hundredfold
        alike = np.where(apart < 30 * pace, np.exp(-np.minimum(apart / pace, 30.0)), 0.0)
        strength, directions = np.linalg.eigh(alike / np.outer(root, root))
        values.append(np.maximum(strength, 0.0))
        vectors.append(directions)
    return Spectrum(pace, np.concatenate(values), tuple(vectors))


def _difference_variance(layout: PairLayout, residual: Array) -> float:
    """Return the variance of pair means from neighbours at one speed, robustly."""
    order = np.lexsort((layout.time, layout.level, layout.run))
    same = (np.diff(layout.level[order]) == 0) & (np.diff(layout.run[order]) == 0)
    steps = np.diff(residual[order])[same]
    if not steps.size:
        return float(np.var(residual))
    return float((1.4826 * np.median(np.abs(steps))) ** 2 / 2)
