"""One channel's pair means under every noise: which noise fits the base, and which each rival.

A cause that changes slowly looks like drift. Estimating the noise with the base alone therefore
hides such causes, and estimating it with each rival in place finds them everywhere. Here every
rival is set against the base with the noise that suits either best, and what chance makes of that
is drawn from the base's own noise.

References
----------
.. [1] D. A. Harville, "Maximum likelihood approaches to variance component estimation and to
   related problems," J. Am. Stat. Assoc. 72(358), 1977, doi:10.1080/01621459.1977.10480998.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.noise.orthonormal_groups import Groups, unmixing
from frictioncli.diagnosis.noise.spectra import STRENGTHS, Spectra
from frictioncli.linear_algebra import orthonormal_basis

Setting = tuple[int, int]
"""Place of a noise: of its correlation time and of its strength."""

_RANK = 1e-7
"""Singular values of unit columns below this share of the greatest count as zero."""


@dataclass(frozen=True, slots=True)
class Scan:
    """What one channel's pair means say of rivals.

    Attributes
    ----------
    of_group : ndarray of int, shape (groups, 2)
        Noise that suits each group best.
    drawn : ndarray, shape (groups, draws)
        Twice the log likelihood ratio of each group in noise drawn from the base's.
    """

    of_group: Indices
    drawn: Array

    @property
    def settings(self) -> list[Setting]:
        """The noise that suits each group."""
        return [(int(time), int(strength)) for time, strength in self.of_group]


@dataclass(frozen=True, slots=True, kw_only=True)
class Null:
    """The base alone under every noise.

    Attributes
    ----------
    freedom : int
        Pairs less what the base fits of their means.
    known : ndarray, shape (pairs, rank)
        Orthonormal columns that span the base's scaled means.
    data : ndarray, shape (pairs, 1)
        Scaled means of the misfit.
    likelihood, scale, determinant : ndarray, shape (times, strengths)
        Restricted log likelihood, the scale of each noise, and its restricted log determinant at
        scale 1. [-], [(N·m)²], [-]
    best : (int, int)
        The noise that suits best.
    fits : tuple of tuple of _Fit
        The base under each noise: correlation times, then strengths as :func:`_strengths` has them.
    """

    freedom: int
    known: Array
    data: Array
    likelihood: Array
    scale: Array
    determinant: Array
    best: Setting
    fits: tuple[tuple["_Fit", ...], ...]


def null_of(spectra: Spectra, base: Array, misfit: Array) -> Null:
    """Fit the base alone under every noise.

    Parameters
    ----------
    spectra : Spectra
        The channel's noises.
    base : ndarray, shape (pairs, parameters)
        Pair means of the base's columns.
    misfit : ndarray, shape (pairs, 1)
        Pair means of the misfit.
    """
    known, data = orthonormal_basis(spectra.scaled(base), tolerance=_RANK), spectra.scaled(misfit)
    freedom = len(data) - known.shape[1]
    likelihood = np.full((len(spectra.spectra), len(STRENGTHS)), -np.inf)
    scale, determinant = np.ones_like(likelihood), np.zeros_like(likelihood)
    fits = []
    for t, spectrum in enumerate(spectra.spectra):
        turned, part = spectra.modes(spectrum, known), spectra.modes(spectrum, data)
        own = [_Fit.of(spectrum.values, float(STRENGTHS[s]), turned) for s in _strengths(t)]
        fits.append(tuple(own))
        for s, fit in zip(_strengths(t), own, strict=True):
            square = max(float(np.sum(np.square(fit.off(part)))), 1e-300)
            likelihood[t, s] = -0.5 * (freedom * np.log(square) + fit.determinant)
            scale[t, s], determinant[t, s] = square / freedom, fit.determinant
    at = np.unravel_index(int(np.argmax(likelihood)), likelihood.shape)
    return Null(
        freedom=freedom,
        known=known,
        data=data,
        likelihood=likelihood,
        scale=scale,
        determinant=determinant,
        best=(int(at[0]), int(at[1])),
        fits=tuple(fits),
    )


def _strengths(time: int) -> range:
    """Return the strengths to ask at a correlation time; without drift all times are one."""
    return range(0 if time == 0 else 1, len(STRENGTHS))


def scan(
    spectra: Spectra,
    null: Null,
    rivals: Sequence[Array],
    groups: Groups,
    draws: int,
    generator: np.random.Generator,
) -> Scan:
    """Set every group of columns against the base under every noise.

    Parameters
    ----------
    spectra : Spectra
        The channel's noises.
    null : Null
        The base alone.
    rivals : sequence of ndarray, shape (pairs, columns)
        Modes of the rivals' columns at each correlation time.
    groups : Groups
        Which columns make up which rival.
    draws : int
        Number of draws of noise; none where nothing is to be judged.
    generator : Generator
        Their source.
    """
    both = np.hstack([null.data, _drawn(spectra, null, draws, generator)])
    # most rivals show in one channel only; where all columns are zero the base stands alone
    shows = groups.sums(np.any(rivals[0], axis=0)[:, np.newaxis].astype(np.intp))[:, 0] > 0
    shown, columns = groups.chosen(shows)
    of_group = np.tile(np.array(null.best, dtype=np.intp), (len(shows), 1))
    drawn = np.zeros((len(shows), draws))
    if not shows.any():
        return Scan(of_group, drawn)
    found = np.full((len(shown.start), both.shape[1]), -np.inf)
    without = np.full(both.shape[1], -np.inf)
    best = np.zeros((len(shown.start), 2), dtype=np.intp)
    for t, spectrum in enumerate(spectra.spectra):
        turned, part = spectra.modes(spectrum, null.known), spectra.modes(spectrum, both)
        whole = rivals[t][:, columns]
        # what the base takes without drift it takes under any: so little is left to cancel
        own = whole - turned @ (turned.T @ whole)
        mixings = _mixings(null.fits[t], whole, own, shown)
        for number, (s, fit) in enumerate(zip(_strengths(t), null.fits[t], strict=True)):
            left = fit.off(part)
            square = np.maximum(np.einsum("ij,ij->j", left, left), 1e-300)
            taken = shown.taken([one[number] for one in mixings], own.T @ fit.weighted(left))
            rest = np.maximum(square - taken, 1e-12 * square)
            chance = -0.5 * (null.freedom * np.log(rest) + fit.determinant)
            best[chance[:, 0] > found[:, 0]] = (t, s)
            np.maximum(found, chance, out=found)
            alone = -0.5 * (null.freedom * np.log(square) + fit.determinant)
            np.maximum(without, alone, out=without)
    of_group[shows] = best
    drawn[shows] = np.maximum(2 * (found - without)[:, 1:], 0.0)
    return Scan(of_group, drawn)


def _mixings(fits: Sequence["_Fit"], whole: Array, own: Array, groups: Groups) -> list[Array]:
    r"""Return what makes the columns of each width orthonormal under each noise off the base.

    With weights :math:`W` and the base's basis :math:`B` the inner products of what is left of
    columns :math:`C` are :math:`C^\mathsf{T} W^2 C - (B^\mathsf{T} W C)^\mathsf{T}
    (B^\mathsf{T} W C)`.

    Parameters
    ----------
    fits : sequence of _Fit
        The base under each noise.
    whole, own : ndarray, shape (pairs, columns)
        Modes of the columns, and the same less any of the base's.
    groups : Groups
        Theirs.

    Returns
    -------
    list of ndarray, shape (noises, groups, width, width)
        In the order of :meth:`Groups.alike`.
    """
    precision = np.array([np.square(fit.weight) for fit in fits])
    before = precision @ np.square(whole)
    base = np.array([fit.weighted(fit.basis).T @ own for fit in fits])
    found = []
    for _, columns in groups.alike():
        part, share = own[:, columns], base[..., columns]
        products = part[..., :, np.newaxis] * part[..., np.newaxis, :]
        inner = np.tensordot(precision, products, 1)
        inner -= np.einsum("sbgi,sbgj->sgij", share, share)
        found.append(unmixing(inner, before[:, columns]))
    return found


def _drawn(spectra: Spectra, null: Null, draws: int, generator: np.random.Generator) -> Array:
    """Return draws of scaled noise, its setting drawn by the likelihood."""
    weight = np.exp(null.likelihood - np.max(null.likelihood)).ravel()
    which = generator.choice(len(weight), size=draws, p=weight / weight.sum())
    pairs = len(spectra.profile)
    noise = np.empty((pairs, draws))
    for setting in np.unique(which):
        t, s = np.unravel_index(int(setting), null.likelihood.shape)
        spectrum = spectra.spectra[t]
        chosen = which == setting
        deviation = np.sqrt(null.scale[t, s] * (1 + STRENGTHS[s] * spectrum.values))
        white = generator.standard_normal((pairs, int(chosen.sum())))
        noise[:, chosen] = spectra.unmoded(spectrum, deviation[:, np.newaxis] * white)
    return noise


@dataclass(frozen=True, slots=True)
class _Fit:
    """The base fitted under one noise, in its modes."""

    weight: Array
    basis: Array
    determinant: float

    @classmethod
    def of(cls, values: Array, strength: float, base: Array) -> "_Fit":
        variance = 1 + strength * values
        weight = 1 / np.sqrt(variance)
        basis, triangle = np.linalg.qr(weight[:, np.newaxis] * base)
        within = 2 * np.sum(np.log(np.abs(np.diag(triangle)))) if base.shape[1] else 0.0
        return cls(weight, basis, float(np.sum(np.log(variance)) + within))

    def weighted(self, columns: Array) -> Array:
        return self.weight[:, np.newaxis] * columns

    def off(self, columns: Array) -> Array:
        weighted = self.weighted(columns)
        return weighted - self.basis @ (self.basis.T @ weighted)


def weighted_gram(
    spectra: Spectra, setting: Setting, modes: Array, others: Array | None = None
) -> Array:
    """Return inner products of modes under a noise of scale 1, with each other or with others.

    Parameters
    ----------
    spectra : Spectra
        The channel's noises.
    setting : (int, int)
        Place of the noise.
    modes, others : ndarray, shape (..., pairs, columns)
        Modes of columns.
    """
    variance = 1 + STRENGTHS[setting[1]] * spectra.spectra[setting[0]].values
    second = modes if others is None else others
    return np.asarray(modes.swapaxes(-1, -2) @ (second / variance[:, np.newaxis]))


def drawn_inside(
    base: Array, rivals: Array, groups: Groups, draws: int, generator: np.random.Generator
) -> Array:
    """Return what each group takes of noise inside pairs, shape (groups, draws)."""
    known = orthonormal_basis(base, tolerance=_RANK)
    left = rivals - known @ (known.T @ rivals)
    unit = groups.orthonormal(rivals, left)
    noise = generator.standard_normal((len(unit), draws))
    return groups.sums(np.square(unit.T @ noise))
