"""Rows at hand, or with those to come, and the noise that columns are seen through in them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import ModelColumns
from frictioncli.effects.base import EffectTable
from frictioncli.model.noise import Noise, PairCovariance, pair_covariance


@dataclass(frozen=True, slots=True)
class Information:
    """Rows with the noise that they have, to take inner products of columns in.

    Attributes
    ----------
    problem : Problem
        The rows.
    noise : (Noise, Noise)
        Noise of friction and load. [N·m]
    gone : EffectTable
        The rows of all runs with the way that the joint really travels in a planned run. A
        diagnosis guesses the way of moves that are not recorded, and a cause that goes with the
        way may look as if it went with another.
    at_hand : float
        Share of the pairs at hand in all: where they end, something may have happened.
    """

    problem: Problem
    noise: tuple[Noise, Noise]
    gone: EffectTable
    at_hand: float = 1.0

    def gram(self, columns: ModelColumns) -> Array:
        """Return inner products of columns under the noise of both channels."""
        return next(self.grams(columns, self.noise[:1]))

    def grams(self, columns: ModelColumns, noises: Sequence[Noise]) -> Iterator[Array]:
        """Yield inner products of columns with each of some noises of friction in its own's place.

        Parameters
        ----------
        columns : ModelColumns
            The columns.
        noises : sequence of Noise
            Noises of pair means; that of a single angle bin stays. [N·m]
        """
        shared = _inner(columns.load.means, self._covariance(self.noise[1], 0.0))
        for part, noise in zip(columns.channels, self.noise, strict=True):
            shared += part.inside.T @ part.inside / noise.point**2
        for noise in noises:
            covariance = self._covariance(noise, self.problem.temperature_variance)
            yield shared + _inner(columns.friction.means, covariance)

    def _covariance(self, noise: Noise, extra: Array | float) -> PairCovariance:
        layout = self.problem.layout
        return pair_covariance(
            noise, time=layout.time, run=layout.run, bins=layout.bins, extra=extra
        )


def _inner(means: Array, covariance: PairCovariance) -> Array:
    return np.asarray(means.T @ covariance.solve(means))
