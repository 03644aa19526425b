r"""What the extended model leaves of a run that was kept out, and torque fitted to it.

With the errors of the model *N z* and the noise *V* of the run the precision of what is left is

.. math:: M = V^{-1} - V^{-1} N (I + N^\mathsf{T} V^{-1} N)^{-1} N^\mathsf{T} V^{-1} .
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension, misfits
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.search.new_run_residual import (
    greater_noise,
    model_columns,
    reduced_rows,
    solved_rows,
    square_root,
)
from frictioncli.effects.base import Basis
from frictioncli.model.noise import Noise, plausible_noise


@dataclass(frozen=True, slots=True)
class NewRunMisfit:
    """What the extended model leaves of a run, under a noise.

    Attributes
    ----------
    new : Problem
        The run.
    misfit : (ndarray, ndarray), shape (rows,)
        What is left of friction and load. [N·m]
    nuisance : (ndarray, ndarray), shape (rows, columns)
        Columns of the model per standard error. [N·m]
    noises : (Noise, Noise)
        Noise of friction and load.
    weights : (Weights, Weights)
        Weights under it.
    solved : (ndarray, ndarray), shape (contrasts and pairs, columns + 1)
        Inverse covariance of the noise times the nuisance and the misfit.
    inverse : ndarray, shape (columns, columns)
        :math:`(I + N^T V^{-1} N)^{-1}` of both channels together.
    crossed : ndarray, shape (columns,)
        :math:`N^T V^{-1} r`.
    """

    new: Problem
    misfit: tuple[Array, Array]
    nuisance: tuple[Array, Array]
    noises: tuple[Noise, Noise]
    weights: tuple[Weights, Weights]
    solved: tuple[Array, Array]
    inverse: Array
    crossed: Array

    @classmethod
    def of(
        cls,
        problem: Problem,
        new: Problem,
        extension: Extension,
        weighted_fit: WeightedFit,
        noises: tuple[Noise, Noise],
    ) -> "NewRunMisfit":
        """Return what an extended model leaves of a new run.

        Parameters
        ----------
        problem, new : Problem
            The runs seen, and the held-out run with the base model of the former.
        extension : Extension
            The extended model as it predicts the new run.
        weighted_fit : WeightedFit
            Weights of the runs seen.
        noises : (Noise, Noise)
            Noise of friction and load there.
        """
        columns = model_columns(problem, extension.effects)
        root = square_root(weighted_fit.error_covariance(*columns))
        friction, load = (one @ root for one in model_columns(new, extension.effects))
        return cls._under(new, misfits(new, extension), (friction, load), noises)

    @classmethod
    def _under(
        cls,
        new: Problem,
        misfit: tuple[Array, Array],
        nuisance: tuple[Array, Array],
        noises: tuple[Noise, Noise],
    ) -> "NewRunMisfit":
        friction, load = (
            Weights.of(new.layout, noise, extra)
            for noise, extra in zip(noises, _extra(new), strict=True)
        )
        weights = friction, load
        rows = [
            reduced_rows(one, np.column_stack([known, left]))
            for one, known, left in zip(weights, nuisance, misfit, strict=True)
        ]
        solved = solved_rows(friction, rows[0]), solved_rows(load, rows[1])
        products = rows[0].T @ solved[0] + rows[1].T @ solved[1]
        inverse = np.linalg.inv(np.eye(len(products) - 1) + products[:-1, :-1])
        return cls(
            new, misfit, nuisance, noises, weights, solved, np.asarray(inverse), products[:-1, -1]
        )

    def mean_square(self, misfit: tuple[Array, Array]) -> float:
        """Return the mean square misfit of the simulated torque [(N·m)²]."""
        return float(np.mean(self.new.squared(*misfit)))

    def fitted(self, basis: Basis) -> tuple[Array, Array, float]:
        """Return coefficients of torque, their covariance and twice the log likelihood ratio.

        Parameters
        ----------
        basis : Basis
            Columns in both channels, shape (rows, width). [N·m]
        """
        width = basis.friction.shape[1]
        inner, along = np.zeros((width, width)), np.zeros(width)
        across = np.zeros((len(self.inverse), width))
        for weights, columns, solved in zip(self.weights, basis, self.solved, strict=True):
            if not np.any(columns):
                continue
            own = reduced_rows(weights, columns)
            inner += own.T @ solved_rows(weights, own)
            products = solved.T @ own
            across += products[:-1]
            along += products[-1]
        inner -= across.T @ self.inverse @ across
        along -= across.T @ self.inverse @ self.crossed
        covariance = np.linalg.pinv(inner, hermitian=True)
        coefficients = covariance @ along
        return coefficients, np.asarray(covariance), float(along @ coefficients)

    def with_own_noise(self, basis: Basis) -> "NewRunMisfit":
        """Return the same under the noise that suits this run with a torque in place, if greater.

        Parameters
        ----------
        basis : Basis
            Columns of the torque in both channels, shape (rows, width). [N·m]
        """
        layout = self.new.layout
        noises = []
        for noise, known, left, extra, columns in zip(
            self.noises, self.nuisance, self.misfit, _extra(self.new), basis, strict=True
        ):
            means = layout.means(np.column_stack([known, columns, left]))
            found = plausible_noise(
                residual=means[:, -1],
                design=means[:, :-1],
                time=layout.time,
                run=layout.run,
                bins=layout.bins,
                point=noise.point,
                extra=extra,
            )[0][0]
            noises.append(greater_noise(noise, found))
        return self._with(noises)

    def without_drift(self) -> "NewRunMisfit":
        """Return the same with the variance of the drift as noise of pairs."""
        return self._with(
            [
                replace(one, pair=float(np.hypot(one.pair, one.drift)), drift=0.0)
                for one in self.noises
            ]
        )

    def _with(self, noises: Sequence[Noise]) -> "NewRunMisfit":
        return NewRunMisfit._under(self.new, self.misfit, self.nuisance, (noises[0], noises[1]))


def _extra(new: Problem) -> tuple[Array, Array]:
    """Return the further variance of the pair means of friction and load [(N·m)²]."""
    return new.temperature_variance, np.zeros_like(new.layout.time)
