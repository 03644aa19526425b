r"""Weights by which an extended model is fitted, and what its estimates are worth.

Estimates that must predict are made by weighted least squares that does not look at drift: where a
slow error is forgiven as drift, a model may miss by as much. Their covariance does look at it,

.. math:: (X'X)^{-1} X' C X (X'X)^{-1}

with the weighted columns *X* and the correlation *C* of the weighted noise.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.linear_algebra import scaled_gram_inverse
from frictioncli.model.noise import Noise, PairCovariance, pair_covariance

_TOLERANCE = 1e-10
"""Directions of unit columns with less than this share of the squared length are undetermined."""


@dataclass(frozen=True, slots=True)
class Weights:
    """One channel's weights.

    Attributes
    ----------
    layout : PairLayout
        The pairs.
    point : float
        Standard deviation of a row about its pair. [N·m]
    deviation : ndarray, shape (pairs,)
        Standard deviation of each pair's mean. [N·m]
    covariance : PairCovariance
        Covariance of the pair means' noise.
    """

    layout: PairLayout
    point: float
    deviation: Array
    covariance: PairCovariance

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

    def rows(self, columns: Array) -> Array:
        """Return weighted deviations from the pair means and, below them, weighted pair means.

        Parameters
        ----------
        columns : ndarray, shape (rows, columns)
            Columns in the channel. [N·m]
        """
        inside = self.layout.contrasts(columns) / self.point
        return np.vstack([inside, (self.layout.means(columns).T / self.deviation).T])

    def correlated(self, weighted: Array) -> Array:
        """Return the correlation of the weighted rows' noise times such rows."""
        inside, between = np.split(weighted, [-len(self.deviation)])
        size = self.deviation[:, np.newaxis]
        return np.vstack([inside, self.covariance.times(between / size) / size])


@dataclass(frozen=True, slots=True)
class WeightedFit:
    """Both channels' weights."""

    friction: Weights
    load: Weights

    def coefficients(self, friction: Array, load: Array, targets: tuple[Array, Array]) -> Array:
        """Return least-squares coefficients of columns, shape (columns,).

        Parameters
        ----------
        friction, load : ndarray, shape (rows, columns)
            Columns in both channels. [N·m]
        targets : (ndarray, ndarray), shape (rows,)
            What they are to explain. [N·m]
        """
        own, other = self.friction.rows(friction), self.load.rows(load)
        right = own.T @ self.friction.rows(targets[0][:, np.newaxis])
        right += other.T @ self.load.rows(targets[1][:, np.newaxis])
        return (scaled_gram_inverse(own.T @ own + other.T @ other, tolerance=_TOLERANCE) @ right)[
            :, 0
        ]

    def error_covariance(self, friction: Array, load: Array) -> Array:
        """Return the covariance of such coefficients, shape (columns, columns)."""
        own, other = self.friction.rows(friction), self.load.rows(load)
        bread = scaled_gram_inverse(own.T @ own + other.T @ other, tolerance=_TOLERANCE)
        meat = own.T @ self.friction.correlated(own) + other.T @ self.load.correlated(other)
        return np.asarray(bread @ meat @ bread)
