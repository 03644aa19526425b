r"""Restricted likelihood of one channel's pair means over a grid of noise models.

A cause that changes slowly looks like drift. If the noise is estimated under the null hypothesis
alone, such causes disappear in it; if it is estimated with each candidate in place, they are found
everywhere. Therefore the likelihood of the null hypothesis and that of each candidate are both
maximised over the noise models :math:`V = a (H + \rho R_\theta)`, and the distribution of their
ratio under the null hypothesis is simulated.

With weights :math:`W = (I + \rho \Lambda)^{-1/2}` in the eigenvectors of the covariance spectrum,
*n* pairs, *p* columns *X* of the null hypothesis and the sum of squares *s* of the weighted
residual, the restricted log likelihood [1]_ at the best scale :math:`a = s / (n - p)` is, up to a
constant,

.. math:: \ell = -\tfrac12 \left[(n - p) \ln s + \ln |W^{-2}| + \ln |X^\mathsf{T} W^2 X| \right] .

A candidate reduces *s*; the determinants stay those of the null hypothesis.

References
----------
.. [1] D. A. Harville, "Maximum likelihood approaches to variance component estimation and to
   related problems," J. Am. Stat. Assoc. 72(358), 1977, doi:10.1080/01621459.1977.10480998.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.noise.orthonormal_groups import Groups, gram_schmidt
from frictioncli.diagnosis.noise.spectra import STRENGTHS, NoiseIndex, Spectra
from frictioncli.linear_algebra import orthonormal_basis

_RANK = 1e-7
"""Singular values of unit columns below this share of the greatest count as zero."""


@dataclass(frozen=True, slots=True)
class Scan:
    """Candidates against the null hypothesis in the pair means of one channel.

    Attributes
    ----------
    best : ndarray of int, shape (groups, 2)
        Index of the noise model that suits each group best.
    drawn : ndarray, shape (groups, draws)
        Twice the log likelihood ratio of each group in simulated noise.
    """

    best: Indices
    drawn: Array

    @property
    def noises(self) -> list[NoiseIndex]:
        """The noise model that suits each group best."""
        return [(int(time), int(strength)) for time, strength in self.best]


@dataclass(frozen=True, slots=True, kw_only=True)
class NullFit:
    """The null hypothesis, base and accepted effects alone, under every noise model.

    Attributes
    ----------
    freedom : int
        Degrees of freedom: number of pairs less the rank of the base's pair means.
    basis : ndarray, shape (pairs, rank)
        Orthonormal basis of the base's scaled pair means.
    misfit : ndarray, shape (pairs, 1)
        Scaled pair means of the misfit.
    likelihood, scale, determinant : ndarray, shape (times, strengths)
        Restricted log likelihood, the scale of each noise model, and its restricted log
        determinant at scale 1. [-], [(N·m)²], [-]
    best : (int, int)
        The most likely noise model.
    fits : tuple of tuple of _WeightedBasis
        The base under each noise model: correlation times, then strengths as :func:`_strengths`
        has them.
    """

    freedom: int
    basis: Array
    misfit: Array
    likelihood: Array
    scale: Array
    determinant: Array
    best: NoiseIndex
    fits: tuple[tuple["_WeightedBasis", ...], ...]


def fit_null(spectra: Spectra, base: Array, misfit: Array) -> NullFit:
    """Fit the base alone under every noise model.

    Parameters
    ----------
    spectra : Spectra
        The channel's noise models.
    base : ndarray, shape (pairs, parameters)
        Pair means of the base's columns.
    misfit : ndarray, shape (pairs, 1)
        Pair means of the misfit. [N·m]
    """
    basis = orthonormal_basis(spectra.scaled(base), tolerance=_RANK)
    scaled = spectra.scaled(misfit)
    freedom = len(scaled) - basis.shape[1]
    likelihood = np.full((len(spectra.spectra), len(STRENGTHS)), -np.inf)
    scale, determinant = np.ones_like(likelihood), np.zeros_like(likelihood)
    fits = []
    for t, spectrum in enumerate(spectra.spectra):
        base_modes, misfit_modes = spectra.modes(spectrum, basis), spectra.modes(spectrum, scaled)
        at_time = [
            _WeightedBasis.of(spectrum.values, float(STRENGTHS[s]), base_modes)
            for s in _strengths(t)
        ]
        fits.append(tuple(at_time))
        for s, fit in zip(_strengths(t), at_time, strict=True):
            square = max(float(np.sum(np.square(fit.residual(misfit_modes)))), 1e-300)
            likelihood[t, s] = -0.5 * (freedom * np.log(square) + fit.determinant)
            scale[t, s], determinant[t, s] = square / freedom, fit.determinant
    at = np.unravel_index(int(np.argmax(likelihood)), likelihood.shape)
    return NullFit(
        freedom=freedom,
        basis=basis,
        misfit=scaled,
        likelihood=likelihood,
        scale=scale,
        determinant=determinant,
        best=(int(at[0]), int(at[1])),
        fits=tuple(fits),
    )


def _strengths(time: int) -> range:
    """Return the strengths to try at a correlation time; without drift all times are the same."""
    return range(0 if time == 0 else 1, len(STRENGTHS))


def scan(
    spectra: Spectra,
    null: NullFit,
    candidates: Sequence[Array],
    groups: Groups,
    draws: int,
    generator: np.random.Generator,
) -> Scan:
    """Compare every group of columns with the null hypothesis under every noise model.

    Parameters
    ----------
    spectra : Spectra
        The channel's noise models.
    null : NullFit
        The base alone.
    candidates : sequence of ndarray, shape (pairs, columns)
        Modes of the candidates' columns at each correlation time.
    groups : Groups
        Division of the columns into candidates.
    draws : int
        Number of draws of noise; none where no p-value is wanted.
    generator : Generator
        Their source.
    """
    data = np.hstack([null.misfit, _drawn_noise(spectra, null, draws, generator)])
    # most candidates show in one channel only; where all columns are zero the null stands alone
    present = groups.sums(np.any(candidates[0], axis=0)[:, np.newaxis].astype(np.intp))[:, 0] > 0
    kept, columns = groups.select(present)
    best_of_all = np.tile(np.array(null.best, dtype=np.intp), (len(present), 1))
    drawn = np.zeros((len(present), draws))
    if not present.any():
        return Scan(best_of_all, drawn)
    with_candidate = np.full((len(kept.start), data.shape[1]), -np.inf)
    without = np.full(data.shape[1], -np.inf)
    best = np.zeros((len(kept.start), 2), dtype=np.intp)
    for t, spectrum in enumerate(spectra.spectra):
        base_modes = spectra.modes(spectrum, null.basis)
        data_modes = spectra.modes(spectrum, data)
        modes = candidates[t][:, columns]
        # taking out what the base explains without drift leaves little to cancel under any noise
        off_base = modes - base_modes @ (base_modes.T @ modes)
        transformations = _transformations(null.fits[t], modes, off_base, kept)
        for number, (s, fit) in enumerate(zip(_strengths(t), null.fits[t], strict=True)):
            residual = fit.residual(data_modes)
            square = np.maximum(np.einsum("ij,ij->j", residual, residual), 1e-300)
            explained = kept.explained(
                [one[number] for one in transformations], off_base.T @ fit.weighted(residual)
            )
            rest = np.maximum(square - explained, 1e-12 * square)
            likelihood = -0.5 * (null.freedom * np.log(rest) + fit.determinant)
            best[likelihood[:, 0] > with_candidate[:, 0]] = (t, s)
            np.maximum(with_candidate, likelihood, out=with_candidate)
            alone = -0.5 * (null.freedom * np.log(square) + fit.determinant)
            np.maximum(without, alone, out=without)
    best_of_all[present] = best
    drawn[present] = np.maximum(2 * (with_candidate - without)[:, 1:], 0.0)
    return Scan(best_of_all, drawn)


def _transformations(
    fits: Sequence["_WeightedBasis"], modes: Array, off_base: Array, groups: Groups
) -> list[Array]:
    r"""Return the Gram-Schmidt transformations of the groups' residuals under each noise model.

    With weights :math:`W` and the base's orthonormal basis :math:`B` the inner products of the
    residuals of columns :math:`C` are :math:`C^\mathsf{T} W^2 C - (B^\mathsf{T} W C)^\mathsf{T}
    (B^\mathsf{T} W C)`.

    Parameters
    ----------
    fits : sequence of _WeightedBasis
        The base under each noise model.
    modes, off_base : ndarray, shape (pairs, columns)
        Modes of the columns, and the same less their projection on the base without drift.
    groups : Groups
        Division of the columns.

    Returns
    -------
    list of ndarray, shape (noise models, groups, width, width)
        In the order of :meth:`Groups.by_width`.
    """
    precision = np.array([np.square(fit.weight) for fit in fits])
    squared_length = precision @ np.square(modes)
    base = np.array([fit.weighted(fit.basis).T @ off_base for fit in fits])
    found = []
    for _, columns in groups.by_width():
        part, share = off_base[:, columns], base[..., columns]
        products = part[..., :, np.newaxis] * part[..., np.newaxis, :]
        inner = np.tensordot(precision, products, 1)
        inner -= np.einsum("sbgi,sbgj->sgij", share, share)
        found.append(gram_schmidt(inner, squared_length[:, columns]))
    return found


def _drawn_noise(
    spectra: Spectra, null: NullFit, draws: int, generator: np.random.Generator
) -> Array:
    """Return draws of scaled noise, each of a noise model drawn by its likelihood."""
    weight = np.exp(null.likelihood - np.max(null.likelihood)).ravel()
    which = generator.choice(len(weight), size=draws, p=weight / weight.sum())
    pairs = len(spectra.profile)
    noise = np.empty((pairs, draws))
    for index in np.unique(which):
        t, s = np.unravel_index(int(index), null.likelihood.shape)
        spectrum = spectra.spectra[t]
        chosen = which == index
        deviation = np.sqrt(null.scale[t, s] * (1 + STRENGTHS[s] * spectrum.values))
        white = generator.standard_normal((pairs, int(chosen.sum())))
        noise[:, chosen] = spectra.from_modes(spectrum, deviation[:, np.newaxis] * white)
    return noise


@dataclass(frozen=True, slots=True)
class _WeightedBasis:
    """The base's columns under one noise model, in its modes.

    Attributes
    ----------
    weight : ndarray, shape (pairs,)
        Inverse standard deviation of each mode at scale 1.
    basis : ndarray, shape (pairs, rank)
        Orthonormal basis of the weighted columns.
    determinant : float
        Restricted log determinant of the noise at scale 1.
    """

    weight: Array
    basis: Array
    determinant: float

    @classmethod
    def of(cls, eigenvalues: Array, strength: float, base: Array) -> "_WeightedBasis":
        variance = 1 + strength * eigenvalues
        weight = 1 / np.sqrt(variance)
        basis, triangle = np.linalg.qr(weight[:, np.newaxis] * base)
        within = 2 * np.sum(np.log(np.abs(np.diag(triangle)))) if base.shape[1] else 0.0
        return cls(weight, basis, float(np.sum(np.log(variance)) + within))

    def weighted(self, columns: Array) -> Array:
        return self.weight[:, np.newaxis] * columns

    def residual(self, columns: Array) -> Array:
        """Return weighted columns less their projection on the basis, of the same shape."""
        weighted = self.weighted(columns)
        return weighted - self.basis @ (self.basis.T @ weighted)


def drawn_within(
    base: Array, candidates: Array, groups: Groups, draws: int, generator: np.random.Generator
) -> Array:
    """Return the sum of squares that each group explains of white noise within pairs.

    Parameters
    ----------
    base, candidates : ndarray, shape (contrasts, columns)
        Deviations from the pair means, in units of their noise.
    groups : Groups
        Division of the candidates' columns.
    draws : int
        Number of draws.
    generator : Generator
        Their source.

    Returns
    -------
    ndarray, shape (groups, draws)
        Contribution to twice the log likelihood ratio.
    """
    basis = orthonormal_basis(base, tolerance=_RANK)
    residuals = candidates - basis @ (basis.T @ candidates)
    unit = groups.orthonormal(candidates, residuals)
    noise = generator.standard_normal((len(unit), draws))
    return groups.sums(np.square(unit.T @ noise))
