"""Base and a rival fitted together to both channels, with the scale of the noise among them."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.noise.likelihood_scan import Setting
from frictioncli.diagnosis.noise.spectra import STRENGTHS, Spectra
from frictioncli.linear_algebra import scaled_gram_inverse, schur_complement
from frictioncli.model.noise import Noise

_ROUNDS = 4
"""Rounds of fitting coefficients and noise scale in turn."""

_TOLERANCE = 1e-11
"""Directions of unit columns with less than this share of the squared length are undetermined."""

_ABSENT = 1e-200
"""A column of less squared length is not there: its share of the torque is no number any more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoChannelFit:
    """Base and rival fitted together.

    Attributes
    ----------
    likelihood : float
        Restricted log likelihood.
    coefficients : ndarray
        Of the base's columns, then of the rival's.
    covariance : ndarray
        Their covariance.
    scales : (float, float)
        Variance of the white part of pair means in friction and load. [(N·m)²]
    visible : ndarray, shape (columns of the rival,)
        White length of the rival's columns that the base leaves.
    freedom : int
        Coefficients of the rival that the data can tell.
    """

    likelihood: float
    coefficients: Array
    covariance: Array
    scales: tuple[float, float]
    visible: Array
    freedom: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalEquations:
    """One channel's inner products of all columns; the last column is the misfit.

    Attributes
    ----------
    inside : ndarray, shape (columns, columns), or (rivals, columns, columns)
        Of the columns' deviations inside pairs, in units of their noise. Columns are the base's,
        the rival's, and the misfit.
    between : ndarray, of the same shape
        Of their pair means, under a noise of scale 1.
    determinant : float
        Restricted log determinant of that noise.
    freedom : int
        Pairs less what the base fits of their means.
    """

    inside: Array
    between: Array
    determinant: float
    freedom: int


def solved(channels: tuple[NormalEquations, NormalEquations], base: int) -> TwoChannelFit:
    """Fit all columns but the last, which is the misfit, to both channels together.

    Parameters
    ----------
    channels : (NormalEquations, Equations)
        Of friction and load.
    base : int
        Number of the base's columns.
    """
    friction, load = (
        replace(one, inside=one.inside[np.newaxis], between=one.between[np.newaxis])
        for one in channels
    )
    return solved_each((friction, load), base)[0]


def solved_each(
    channels: tuple[NormalEquations, NormalEquations], base: int
) -> list[TwoChannelFit]:
    """Fit each of many rivals with as many columns, as :func:`solved`.

    Parameters
    ----------
    channels : (NormalEquations, Equations)
        Of friction and load, their inner products of shape (rivals, columns, columns).
    base : int
        Number of the base's columns.
    """
    friction, load = channels
    inside = friction.inside + load.inside
    freedom = [max(one.freedom, 1) for one in channels]
    scales = [
        np.maximum(one.between[:, -1, -1], 1e-12) / free
        for one, free in zip(channels, freedom, strict=True)
    ]
    for _ in range(_ROUNDS):
        gram = inside + (friction.between.T / scales[0]).T + (load.between.T / scales[1]).T
        own = gram[:, :-1, :-1]
        inverse = scaled_gram_inverse(own, tolerance=_TOLERANCE, absent=_ABSENT)
        coefficients = np.einsum("rij,rj->ri", inverse, gram[:, :-1, -1])
        rest = np.append(-coefficients, np.ones((len(gram), 1)), axis=1)
        squares = [np.maximum(_square(one.between, rest), 1e-300) for one in channels]
        scales = [
            np.maximum(square / free, 1e-12) for square, free in zip(squares, freedom, strict=True)
        ]
    likelihood = -0.5 * _square(inside, rest)
    for one, square, scale in zip(channels, squares, scales, strict=True):
        likelihood -= 0.5 * (one.freedom * np.log(scale) + square / scale + one.determinant)
    left, rank = _left(own, base)
    return [
        TwoChannelFit(
            likelihood=float(likelihood[i]),
            coefficients=coefficients[i],
            covariance=inverse[i],
            scales=(float(scales[0][i]), float(scales[1][i])),
            visible=left[i],
            freedom=int(rank[i]),
        )
        for i in range(len(gram))
    ]


def _square(gram: Array, combination: Array) -> Array:
    """Return squared lengths of a combination of each rival's columns, shape (rivals,)."""
    return np.asarray(np.einsum("ri,rij,rj->r", combination, gram, combination))


def _left(gram: Array, base: int) -> tuple[Array, Indices]:
    """Return the lengths that the base leaves of each rival's columns, and their ranks."""
    if gram.shape[1] == base:
        return np.empty((len(gram), 0)), np.zeros(len(gram), dtype=np.intp)
    rest, size = schur_complement(gram, base, tolerance=_TOLERANCE)
    own = np.maximum(np.diagonal(rest, axis1=1, axis2=2), 0.0)
    seen = (own > 1e-6) & (size > 1e-6)
    told = np.where(seen[:, :, np.newaxis] & seen[:, np.newaxis, :], rest, 0.0)
    rank = np.linalg.matrix_rank(told, tol=1e-7, hermitian=True)
    return np.where(seen, np.sqrt(own) * size, 0.0), rank


def noise_of(spectra: Spectra, setting: Setting, scale: float, point: float) -> Noise:
    """Return a noise in torque units from its place and scale."""
    strength = float(STRENGTHS[setting[1]])
    return Noise(
        point=point,
        pair=float(np.sqrt(max(scale - spectra.known, 0.0))),
        drift=float(np.sqrt(scale * strength)),
        drift_time=spectra.spectra[setting[0]].time,
    )
