r"""Least squares by which an extended model is fitted, with the covariance of its errors.

Rows may be weighted by their noise, as where causes are tested. Estimates that must predict are
made by ordinary least squares: all rows of a channel weigh the same. What a model of a joint misses
is mostly its own error, the same in all pairs of one kind. Under generalised least squares a slow
error is attributed to drift, and the deviations within pairs, whose noise averages out over many
pairs, decide alone about a coefficient, however much worse the means of the pairs are then
predicted. The covariance of the estimates accounts for the noise as it is,

.. math:: (X^\mathsf{T} X)^{-1} X^\mathsf{T} C X (X^\mathsf{T} X)^{-1}

with the weighted columns *X* and the correlation matrix *C* of the weighted noise (a sandwich
covariance).
"""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.linear_algebra import scaled_gram_inverse
from frictioncli.model.noise import Noise, PairCovariance, pair_covariance

_TOLERANCE = 1e-10
"""Directions of unit columns with less than this share of the squared length are undetermined."""


@dataclass(frozen=True, slots=True)
class Weights:
    """Weights of the rows of one channel.

    Attributes
    ----------
    layout : PairLayout
        The pairs.
    point : float
        Standard deviation of an angle bin about the mean of its pair. [N·m]
    deviation : ndarray, shape (pairs,)
        Standard deviation of each pair's mean by which it is weighted. [N·m]
    covariance : PairCovariance
        Covariance of the noise of the pair means.
    whitening : bool
        Whether the pair means are made white by this covariance, instead of divided by their
        deviations.
    """

    layout: PairLayout
    point: float
    deviation: Array
    covariance: PairCovariance
    whitening: bool = False

    @classmethod
    def of(cls, layout: PairLayout, noise: Noise, extra: Array) -> "Weights":
        """Return the weights of a channel.

        Parameters
        ----------
        layout : PairLayout
            The pairs.
        noise : Noise
            The channel's noise. [N·m]
        extra : ndarray, shape (pairs,)
            Further variance of the pair means, as of an uncertain temperature. [(N·m)²]
        """
        covariance = pair_covariance(
            noise, time=layout.time, run=layout.run, bins=layout.bins, extra=extra
        )
        deviation = np.sqrt(covariance.white + noise.drift**2)
        return cls(layout, noise.point, deviation, covariance)

    def alike(self) -> "Weights":
        """Return weights under which all rows weigh the same."""
        return replace(self, deviation=self.point / np.sqrt(self.layout.bins))

    def by_covariance(self) -> "Weights":
        """Return weights of generalised least squares, by the covariance of the noise."""
        return replace(self, whitening=True)

    def weighted(self, columns: Array) -> Array:
        """Return weighted deviations from the pair means and, below them, weighted pair means.

        Parameters
        ----------
        columns : ndarray, shape (rows, columns)
            Columns in the channel. [N·m]
        """
        within, means = self.layout.contrasts_and_means(columns)
        if self.whitening:
            return np.vstack([within / self.point, self.covariance.whitened(means)])
        return np.vstack([within / self.point, (means.T / self.deviation).T])

    def correlated(self, weighted: Array) -> Array:
        """Return C X: the correlation matrix of the weighted noise times weighted columns."""
        if self.whitening:
            return weighted
        within, between = np.split(weighted, [-len(self.deviation)])
        size = self.deviation[:, np.newaxis]
        return np.vstack([within, self.covariance.times(between / size) / size])


@dataclass(frozen=True, slots=True)
class WeightedFit:
    """Weighted least squares in both channels together.

    Attributes
    ----------
    friction, load : Weights
        Weights of both channels.
    unfitted : tuple of (ndarray, ndarray), shape (rows, columns)
        Columns in both channels of the discrepancy, and of all else that is not fitted, with
        coefficients of variance 1. [N·m]
    """

    friction: Weights
    load: Weights
    unfitted: tuple[tuple[Array, Array], ...] = ()

    def by_covariance(self) -> "WeightedFit":
        """Return the generalised least squares by the covariance of the noise."""
        return replace(self, friction=self.friction.by_covariance(), load=self.load.by_covariance())

    def beside(self, friction: Array, load: Array) -> "WeightedFit":
        """Return the fit with further torque that is there or not, and is not fitted.

        Parameters
        ----------
        friction, load : ndarray, shape (rows, columns)
            Its columns in both channels, with coefficients of variance 1. [N·m]
        """
        return replace(self, unfitted=(*self.unfitted, (friction, load)))

    def coefficients(self, friction: Array, load: Array, targets: tuple[Array, Array]) -> Array:
        """Return least-squares coefficients of columns, shape (columns,).

        Parameters
        ----------
        friction, load : ndarray, shape (rows, columns)
            Columns in both channels. [N·m]
        targets : (ndarray, ndarray), shape (rows,)
            What they are fitted to in both channels. [N·m]
        """
        first, second = self.friction.weighted(friction), self.load.weighted(load)
        right = first.T @ self.friction.weighted(targets[0][:, np.newaxis])
        right += second.T @ self.load.weighted(targets[1][:, np.newaxis])
        return (_inverse(first, second) @ right)[:, 0]

    def error_covariance(self, friction: Array, load: Array, *, whole: bool = False) -> Array:
        """Return the covariance of such coefficients, shape (columns, columns).

        Parameters
        ----------
        friction, load : ndarray, shape (rows, columns)
            Columns in both channels. [N·m]
        whole : bool, optional
            Whether what the discrepancy adds counts, and what is not fitted: it is the same on
            every run, so that it matters for what the coefficients mean, and not for what they
            predict.
        """
        first, second = self.friction.weighted(friction), self.load.weighted(load)
        bread = _inverse(first, second)
        meat = first.T @ self.friction.correlated(first) + second.T @ self.load.correlated(second)
        for columns in self.unfitted if whole else ():
            crossed = first.T @ self.friction.weighted(columns[0])
            crossed += second.T @ self.load.weighted(columns[1])
            meat = meat + crossed @ crossed.T
        return np.asarray(bread @ meat @ bread)


def _inverse(friction: Array, load: Array) -> Array:
    """Return the inverse of the inner products of weighted columns of both channels."""
    return scaled_gram_inverse(friction.T @ friction + load.T @ load, tolerance=_TOLERANCE)
