r"""Coefficients of functions given a misfit, and what they predict of blocks that are kept out.

The best estimate of random functions with coefficients of variance 1 beside the noise is the mean
given the misfit *y*,

.. math:: \hat\gamma = (O^\mathsf{T} W O + I)^{-1} O^\mathsf{T} W y

with the functions' columns *O*, orthogonal to the base, and the inverse *W* of the noise's
covariance [1]_. Noise alone gives a small estimate. Coefficients of forms are nearly free.

References
----------
.. [1] G. K. Robinson, "That BLUP is a good thing: the estimation of random effects," Stat. Sci.
   6(1), 1991, doi:10.1214/ss/1177011926.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.random_functions import Function
from frictioncli.diagnosis.fit.gain import BLOCK
from frictioncli.diagnosis.fit.weighted_fit import Weights
from frictioncli.effects.base import Basis
from frictioncli.model.noise import Noise

_PARTS = 5
"""Parts of the pairs, each of which is kept out of one estimate."""

Misfits = tuple[Array, Array]


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalEquations:
    """Weighted inner products of the functions' columns, and with the misfit, of each part of rows.

    Attributes
    ----------
    problem : Problem
        The rows.
    columns : ndarray, shape (2 * rows, columns)
        The functions over them, friction above load. [N·m]
    part : ndarray of int, shape (rows,)
        The part that each row belongs to; those of a pair, and of its neighbours, to the same.
    of_form : ndarray of bool, shape (columns,)
        Which columns are of forms.
    precision : ndarray, shape (columns,)
        Precision of the coefficients beforehand: 1 of random functions; those of forms, which are
        torques, may be as large as the mean friction.
    inner : ndarray, shape (parts, columns, columns)
        Inner products of the columns.
    right : ndarray, shape (parts, columns)
        Inner products with the misfit.
    """

    problem: Problem
    columns: Array
    part: Indices
    of_form: Flags
    precision: Array
    inner: Array
    right: Array

    @classmethod
    def of(
        cls,
        problem: Problem,
        functions: Sequence[Function],
        noise: tuple[Noise, Noise],
        misfit: Misfits,
    ) -> "NormalEquations":
        """Return them for a misfit of a problem's rows.

        Parameters
        ----------
        problem : Problem
            The rows.
        functions : sequence of Function
            Functions over these rows.
        noise : (Noise, Noise)
            Noise of friction and load.
        misfit : (ndarray, ndarray), shape (rows,)
            What base and causes leave of both channels. [N·m]
        """
        columns = np.hstack([one.columns for one in functions])
        widths = [len(one.scale) for one in functions]
        mean = float(np.mean(np.abs(problem.friction)))
        part = problem.layout.row_pair // BLOCK % _PARTS
        inner, right = [], []
        for number in np.unique(part):
            chosen = part == number
            rows = problem.part(chosen)
            extra = (rows.temperature_variance, np.zeros(len(rows.layout.time)))
            square, product = np.zeros((columns.shape[1],) * 2), np.zeros(columns.shape[1])
            for own, level, known, target in zip(
                np.split(columns, 2), noise, extra, misfit, strict=True
            ):
                weights = Weights.of(rows.layout, level, known)
                left = weights.weighted(own[chosen])
                square += left.T @ left
                product += left.T @ weights.weighted(target[chosen, np.newaxis])[:, 0]
            inner.append(square)
            right.append(product)
        return cls(
            problem=problem,
            columns=columns,
            part=np.unique(part, return_inverse=True)[1],
            of_form=np.repeat([one.is_form for one in functions], widths),
            precision=np.hstack(
                [
                    np.full(len(one.scale), 1 / mean**2) if one.is_form else np.ones(len(one.scale))
                    for one in functions
                ]
            ),
            inner=np.array(inner),
            right=np.array(right),
        )

    def coefficients(self, without: int | None = None) -> Array:
        """Return the functions' best coefficients, shape (columns,).

        Parameters
        ----------
        without : int, optional
            Number of the part that is kept out of the estimate.
        """
        inner, right = self.inner.sum(axis=0), self.right.sum(axis=0)
        if without is not None:
            inner, right = inner - self.inner[without], right - self.right[without]
        return self._solved(inner, right)

    def by_part(self, number: int) -> Array:
        """Return the functions' best coefficients from one part alone, shape (columns,).

        Parameters
        ----------
        number : int
            Number of the part.
        """
        return self._solved(self.inner[number], self.right[number])

    def covariance(self) -> Array:
        """Return the covariance of these coefficients, shape (columns, columns)."""
        return np.linalg.inv(self.inner.sum(axis=0) + np.diag(self.precision))

    def _solved(self, inner: Array, right: Array) -> Array:
        return np.asarray(np.linalg.solve(inner + np.diag(self.precision), right), float)

    def of_forms(self) -> "NormalEquations":
        """Return those of the forms alone, without random functions."""
        chosen = self.of_form
        return replace(
            self,
            columns=self.columns[:, chosen],
            of_form=chosen[chosen],
            precision=self.precision[chosen],
            inner=self.inner[:, chosen][:, :, chosen],
            right=self.right[:, chosen],
        )

    def predicted_blocks(self) -> Basis:
        """Return what estimates predict of the rows kept out of them, shape (rows,) each [N·m]."""
        found = np.zeros(len(self.columns))
        for number in range(len(self.inner)):
            out = np.tile(self.part == number, 2)
            found[out] = self.columns[out] @ self.coefficients(without=number)
        return Basis(*np.split(found, 2))
