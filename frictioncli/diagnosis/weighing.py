r"""Weights by which an extended model is fitted, and what its estimates are worth.

Estimates that must predict are made by weighted least squares that does not look at drift: where a
slow error is forgiven as drift, a model may miss by as much. Their covariance does look at it,

.. math:: (X'X)^{-1} X' C X (X'X)^{-1}

with the weighted columns *X* and the correlation *C* of the weighted noise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.layout import PairLayout
from frictioncli.model.noise import Noise

Array = NDArray[np.float64]


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
    correlation : ndarray, shape (pairs, pairs)
        Correlation of the pair means' noise.
    """

    layout: PairLayout
    point: float
    deviation: Array
    correlation: Array

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
        white = noise.pair**2 + noise.point**2 / layout.bins + extra
        deviation = np.sqrt(white + noise.drift**2)
        apart = np.abs(layout.time[:, np.newaxis] - layout.time[np.newaxis, :])
        alike = np.exp(-np.minimum(apart / noise.drift_time, 50.0))
        same = layout.run[:, np.newaxis] == layout.run[np.newaxis, :]
        covariance = noise.drift**2 * np.where(same, alike, 0.0) + np.diag(white)
        return cls(layout, noise.point, deviation, covariance / np.outer(deviation, deviation))

    def inside(self, rows: Array) -> Array:
        """Return weighted deviations from the pair means."""
        return self.layout.contrasts(rows) / self.point

    def between(self, rows: Array) -> Array:
        """Return weighted pair means."""
        return np.asarray((self.layout.means(rows).T / self.deviation).T)


@dataclass(frozen=True, slots=True)
class Weighing:
    """Both channels' weights."""

    friction: Weights
    load: Weights

    def rows(self, friction: Array, load: Array) -> list[tuple[Array, Array | None]]:
        """Return weighted rows by part, each with the correlation of its noise, if it has one."""
        return [
            (self.friction.inside(friction), None),
            (self.friction.between(friction), self.friction.correlation),
            (self.load.inside(load), None),
            (self.load.between(load), self.load.correlation),
        ]

    def solve(
        self, friction: Array, load: Array, targets: tuple[Array, Array]
    ) -> tuple[Array, Array]:
        """Return least-squares coefficients of columns, and their covariance.

        Parameters
        ----------
        friction, load : ndarray, shape (rows, columns)
            Columns in both channels. [N·m]
        targets : (ndarray, ndarray), shape (rows,)
            What they are to explain. [N·m]
        """
        system = self.rows(friction, load)
        wanted = self.rows(targets[0][:, np.newaxis], targets[1][:, np.newaxis])
        gram = sum((part.T @ part for part, _ in system), np.zeros((friction.shape[1],) * 2))
        size = np.sqrt(np.where(np.diag(gram) > 0, np.diag(gram), 1.0))
        bread = np.linalg.pinv(gram / np.outer(size, size), rcond=1e-10, hermitian=True)
        bread = np.asarray(bread) / np.outer(size, size)
        right = sum(
            (part.T @ aim for (part, _), (aim, _) in zip(system, wanted, strict=True)),
            np.zeros((len(size), 1)),
        )
        meat = sum(
            (part.T @ (part if noise is None else noise @ part) for part, noise in system),
            np.zeros_like(gram),
        )
        return np.asarray(bread @ right)[:, 0], bread @ meat @ bread
