r"""Generalised least squares of base and candidate in both channels, with the scales of the noise.

The deviations within pairs have a known white noise, so that their inner products are already in
units of it. The pair means of channel *c* have the covariance :math:`a_c V_c` with a fixed
:math:`V_c` and an unknown scale :math:`a_c`. Coefficients and scales are fitted in turn,

.. math::
    \hat\beta = \Big(G_0 + \sum_c G_c / a_c\Big)^{+} \Big(g_0 + \sum_c g_c / a_c\Big), \qquad
    a_c = s_c(\hat\beta) / f_c ,

with inner products *G* of the columns, *g* of columns and misfit, the weighted sum of squared
residuals :math:`s_c` and the degrees of freedom :math:`f_c`. The restricted log likelihood is

.. math::
    \ell = -\tfrac12 s_0 - \tfrac12 \sum_c \left(f_c \ln a_c + s_c / a_c + \ln |V_c|_r\right)

with the restricted log determinant of the base, up to a constant.
"""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.noise.spectra import STRENGTHS, NoiseIndex, Spectra
from frictioncli.linear_algebra import scaled_gram_inverse, schur_complement
from frictioncli.model.noise import Noise

_ROUNDS = 4
"""Rounds of fitting coefficients and noise scales in turn."""

_TOLERANCE = 1e-11
"""Directions of unit columns with less than this share of the squared length are undetermined."""

_ABSENT = 1e-200
"""A column of less squared length counts as zero: dividing by it would overflow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoChannelFit:
    """Base and candidate fitted together to both channels.

    Attributes
    ----------
    likelihood : float
        Restricted log likelihood.
    coefficients : ndarray, shape (columns,)
        Of the base's columns, then of the candidate's.
    covariance : ndarray, shape (columns, columns)
        Their covariance.
    scales : (float, float)
        Variance of the white part of pair means in friction and load. [(N·m)²]
    visible : ndarray, shape (columns of the candidate,)
        Whitened length of what the base leaves of the candidate's columns.
    freedom : int
        Number of the candidate's coefficients that the data determine.
    """

    likelihood: float
    coefficients: Array
    covariance: Array
    scales: tuple[float, float]
    visible: Array
    freedom: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalEquations:
    """Inner products of all columns in one channel: the base's, the candidate's, the misfit last.

    Attributes
    ----------
    within : ndarray, shape (columns, columns), or (candidates, columns, columns)
        Of the deviations within pairs, in units of their noise.
    between : ndarray, of the same shape
        Of the pair means, under a noise of scale 1.
    determinant : float
        Restricted log determinant of that noise.
    freedom : int
        Degrees of freedom: number of pairs less the rank of the base's pair means.
    """

    within: Array
    between: Array
    determinant: float
    freedom: int


def fit_channels(channels: tuple[NormalEquations, NormalEquations], base: int) -> TwoChannelFit:
    """Fit all columns but the last, which is the misfit, to both channels together.

    Parameters
    ----------
    channels : (NormalEquations, NormalEquations)
        Of friction and load.
    base : int
        Number of the base's columns.
    """
    friction, load = (
        replace(one, within=one.within[np.newaxis], between=one.between[np.newaxis])
        for one in channels
    )
    return fit_candidates((friction, load), base)[0]


def fit_candidates(
    channels: tuple[NormalEquations, NormalEquations], base: int
) -> list[TwoChannelFit]:
    """Fit each of many candidates with the same number of columns, as :func:`fit_channels`.

    Parameters
    ----------
    channels : (NormalEquations, NormalEquations)
        Of friction and load, their inner products of shape (candidates, columns, columns).
    base : int
        Number of the base's columns.
    """
    friction, load = channels
    within = friction.within + load.within
    freedom = [max(one.freedom, 1) for one in channels]
    scales = [
        np.maximum(one.between[:, -1, -1], 1e-12) / free
        for one, free in zip(channels, freedom, strict=True)
    ]
    for _ in range(_ROUNDS):
        gram = within + (friction.between.T / scales[0]).T + (load.between.T / scales[1]).T
        columns = gram[:, :-1, :-1]
        inverse = scaled_gram_inverse(columns, tolerance=_TOLERANCE, absent=_ABSENT)
        coefficients = np.einsum("rij,rj->ri", inverse, gram[:, :-1, -1])
        residual = np.append(-coefficients, np.ones((len(gram), 1)), axis=1)
        squares = [np.maximum(_squared_length(one.between, residual), 1e-300) for one in channels]
        scales = [
            np.maximum(square / free, 1e-12) for square, free in zip(squares, freedom, strict=True)
        ]
    likelihood = -0.5 * _squared_length(within, residual)
    for one, square, scale in zip(channels, squares, scales, strict=True):
        likelihood -= 0.5 * (one.freedom * np.log(scale) + square / scale + one.determinant)
    visible, rank = _visible(columns, base)
    return [
        TwoChannelFit(
            likelihood=float(likelihood[i]),
            coefficients=coefficients[i],
            covariance=inverse[i],
            scales=(float(scales[0][i]), float(scales[1][i])),
            visible=visible[i],
            freedom=int(rank[i]),
        )
        for i in range(len(gram))
    ]


def _squared_length(gram: Array, combination: Array) -> Array:
    """Return squared lengths of a combination of each candidate's columns, shape (candidates,)."""
    return np.asarray(np.einsum("ri,rij,rj->r", combination, gram, combination))


def _visible(gram: Array, base: int) -> tuple[Array, Indices]:
    """Return the lengths that the base leaves of each candidate's columns, and their ranks.

    Parameters
    ----------
    gram : ndarray, shape (candidates, columns, columns)
        Inner products, the base's columns first.
    base : int
        Number of the base's columns.

    Returns
    -------
    ndarray, shape (candidates, columns - base), and ndarray of int, shape (candidates,)
        Lengths, 0 where next to nothing is left, and ranks.
    """
    if gram.shape[1] == base:
        return np.empty((len(gram), 0)), np.zeros(len(gram), dtype=np.intp)
    left, size = schur_complement(gram, base, tolerance=_TOLERANCE)
    share = np.maximum(np.diagonal(left, axis1=1, axis2=2), 0.0)
    visible = (share > 1e-6) & (size > 1e-6)
    both = np.where(visible[:, :, np.newaxis] & visible[:, np.newaxis, :], left, 0.0)
    rank = np.linalg.matrix_rank(both, tol=1e-7, hermitian=True)
    return np.where(visible, np.sqrt(share) * size, 0.0), rank


def noise_of(spectra: Spectra, index: NoiseIndex, scale: float, point: float) -> Noise:
    """Return a noise model in torque units.

    Parameters
    ----------
    spectra : Spectra
        The channel's noise models.
    index : (int, int)
        Index of the noise model.
    scale : float
        Its scale. [(N·m)²]
    point : float
        Standard deviation of an angle bin about the mean of its pair. [N·m]
    """
    strength = float(STRENGTHS[index[1]])
    return Noise(
        point=point,
        pair=float(np.sqrt(max(scale - spectra.known, 0.0))),
        drift=float(np.sqrt(scale * strength)),
        drift_time=spectra.spectra[index[0]].time,
    )
