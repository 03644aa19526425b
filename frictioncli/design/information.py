"""Fisher information of model columns in observed and planned rows."""

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
    """Observed and planned rows with their noise model.

    Attributes
    ----------
    problem : Problem
        The rows.
    noise : (Noise, Noise)
        Noise of friction and of load. [N·m]
    true_inputs : EffectTable
        Inputs of the rows with the true travel of planned runs. A diagnosis estimates the travel of
        unrecorded moves, and so may take a cause that depends on travel for another one.
    observed_share : float
        Share of the pairs that are observed; at this place in the sequence a step change may lie.
    """

    problem: Problem
    noise: tuple[Noise, Noise]
    true_inputs: EffectTable
    observed_share: float = 1.0

    def matrix(self, columns: ModelColumns) -> Array:
        """Return the information matrix of columns, shape (columns, columns)."""
        return next(self.matrices(columns, self.noise[:1]))

    def matrices(self, columns: ModelColumns, noises: Sequence[Noise]) -> Iterator[Array]:
        """Yield the information matrix of columns under each of several noises of friction.

        Parameters
        ----------
        columns : ModelColumns
            Columns of the model in both channels.
        noises : sequence of Noise
            Noises of the pair means of friction; the noise of a single angle bin is kept. [N·m]

        Yields
        ------
        ndarray, shape (columns, columns)
            Information matrix.
        """
        shared = _pair_information(columns.load.means, self._covariance(self.noise[1], 0.0))
        for part, noise in zip(columns.channels, self.noise, strict=True):
            shared += part.within.T @ part.within / noise.point**2
        for noise in noises:
            covariance = self._covariance(noise, self.problem.temperature_variance)
            yield shared + _pair_information(columns.friction.means, covariance)

    def _covariance(self, noise: Noise, extra: Array | float) -> PairCovariance:
        layout = self.problem.layout
        return pair_covariance(
            noise, time=layout.time, run=layout.run, bins=layout.bins, extra=extra
        )


def _pair_information(means: Array, covariance: PairCovariance) -> Array:
    return np.asarray(means.T @ covariance.solve(means))
