"""Base and a rival fitted together to both channels, with the scale of the noise among them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.scan import Setting
from frictioncli.diagnosis.spectra import STRENGTHS, Spectra
from frictioncli.model.noise import Noise

Array = NDArray[np.float64]

_ROUNDS = 4
"""Rounds of fitting coefficients and noise scale in turn."""

_ABSENT = 1e-200
"""A column of less squared length is not there: its share of the torque is no number any more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fitted:
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
class Equations:
    """One channel's inner products of all columns; the last column is the misfit.

    Attributes
    ----------
    inside : ndarray, shape (columns, columns)
        Of the columns' deviations inside pairs, in units of their noise. Columns are the base's,
        the rival's, and the misfit.
    between : ndarray, shape (columns, columns)
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


def solved(channels: tuple[Equations, Equations], base: int) -> Fitted:
    """Fit all columns but the last, which is the misfit, to both channels together.

    Parameters
    ----------
    channels : (Equations, Equations)
        Of friction and load.
    base : int
        Number of the base's columns.
    """
    friction, load = channels
    inside = friction.inside + load.inside
    scales = [max(float(one.between[-1, -1]), 1e-12) / max(one.freedom, 1) for one in channels]
    count = len(inside) - 1
    for _ in range(_ROUNDS):
        gram = inside + friction.between / scales[0] + load.between / scales[1]
        squared = np.diag(gram)[:count]
        size = np.where(squared > _ABSENT, np.sqrt(np.maximum(squared, 0.0)), np.inf)
        scaled = gram[:count, :count] / np.outer(size, size)
        inverse = np.linalg.pinv(scaled, rcond=1e-11, hermitian=True) / np.outer(size, size)
        coefficients = inverse @ gram[:count, count]
        rest = np.append(-coefficients, 1.0)
        squares = [max(float(rest @ one.between @ rest), 1e-300) for one in channels]
        scales = [
            max(square / max(one.freedom, 1), 1e-12)
            for one, square in zip(channels, squares, strict=True)
        ]
    likelihood = -0.5 * float(rest @ inside @ rest)
    for one, square, scale in zip(channels, squares, scales, strict=True):
        likelihood -= 0.5 * (one.freedom * np.log(scale) + square / scale + one.determinant)
    left, rank = _left(gram[:count, :count], base)
    return Fitted(
        likelihood=likelihood,
        coefficients=coefficients,
        covariance=np.asarray(inverse),
        scales=(scales[0], scales[1]),
        visible=left,
        freedom=rank,
    )


def _left(gram: Array, base: int) -> tuple[Array, int]:
    """Return the lengths that the base leaves of the rival's columns, and their rank."""
    if len(gram) == base:
        return np.empty(0), 0
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    scaled = gram / np.outer(size, size)
    inner = np.linalg.pinv(scaled[:base, :base], rcond=1e-11, hermitian=True)
    rest = scaled[base:, base:] - scaled[base:, :base] @ inner @ scaled[:base, base:]
    own = np.maximum(np.diag(rest), 0.0)
    seen = (own > 1e-6) & (size[base:] > 1e-6)
    rank = int(np.linalg.matrix_rank(rest[np.ix_(seen, seen)], tol=1e-7, hermitian=True))
    return np.where(seen, np.sqrt(own) * size[base:], 0.0), rank if seen.any() else 0


def noise_of(spectra: Spectra, setting: Setting, scale: float, point: float) -> Noise:
    """Return a noise in torque units from its place and scale."""
    strength = float(STRENGTHS[setting[1]])
    return Noise(
        point=point,
        pair=float(np.sqrt(max(scale - spectra.known, 0.0))),
        drift=float(np.sqrt(scale * strength)),
        drift_time=spectra.spectra[setting[0]].time,
    )
