r"""Base and causes beside the forms that describe what has no name: what they take of these.

Base and causes were fitted without a form, :math:`b = P y`, and hold a part of it. Fitted to the
torque *y* less the form *F a* they are

.. math:: b' = P (y - F a) = b - P F a ,

which with the best *a* is the fit of all together. Of the form, base and causes leave
:math:`F - X P F`, from which *a* is estimated [1]_. Its covariance :math:`\Sigma` adds
:math:`P F \Sigma F^\mathsf{T} P^\mathsf{T}` to that of *b*.

References
----------
.. [1] M. C. Lovell, "Seasonal adjustment of economic time series and multiple regression analysis,"
   J. Am. Stat. Assoc. 58(304), 1963, doi:10.1080/01621459.1963.10480682.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension, fitted_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.effects.base import Basis


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedColumns:
    """Columns of base and causes over a problem's rows, and the fit by which they are estimated.

    Attributes
    ----------
    problem : Problem
        The rows.
    weighted_fit : WeightedFit
        Weights of both channels.
    friction, load : ndarray, shape (rows, parameters)
        The columns in both channels. [N·m]
    """

    problem: Problem
    weighted_fit: WeightedFit
    friction: Array
    load: Array

    @classmethod
    def of(
        cls, problem: Problem, weighted_fit: WeightedFit, effects: Sequence[EffectFit]
    ) -> "FittedColumns":
        """Return those of the base with effects.

        Parameters
        ----------
        problem : Problem
            The rows.
        weighted_fit : WeightedFit
            Weights of both channels.
        effects : sequence of EffectFit
            Effects with their shapes.
        """
        friction, load = fitted_rows(problem, effects)
        return cls(problem=problem, weighted_fit=weighted_fit, friction=friction, load=load)

    @property
    def rows(self) -> Array:
        """The columns, friction above load, shape (2 * rows, parameters) [N·m]."""
        return np.vstack([self.friction, self.load])

    def taken_and_left(self, both: Basis) -> tuple[Array, Array]:
        """Return what base and causes take of further columns, and what they leave of them.

        Parameters
        ----------
        both : Basis
            The columns in both channels. [N·m]

        Returns
        -------
        taken : ndarray, shape (parameters, columns)
            Coefficients of base and causes.
        left : ndarray, shape (2 * rows, columns)
            The rest, friction above load. [N·m]
        """
        taken = np.column_stack(
            [
                self.weighted_fit.coefficients(self.friction, self.load, one)
                for one in zip(both.friction.T, both.load.T, strict=True)
            ]
        )
        return taken, np.vstack(both) - self.rows @ taken

    def left(self, misfit: tuple[Array, Array]) -> tuple[Array, Array]:
        """Return what base and causes, fitted to a misfit, leave of it, shape (rows,) each [N·m].

        Parameters
        ----------
        misfit : (ndarray, ndarray), shape (rows,)
            The misfit of both channels. [N·m]
        """
        _, left = self.taken_and_left(Basis(*(one[:, np.newaxis] for one in misfit)))
        friction, load = np.split(left[:, 0], 2)
        return friction, load


def refitted_beside(
    extension: Extension, taken: Array, coefficients: Array, covariance: Array
) -> Extension:
    """Return base and causes as they are fitted beside forms.

    Parameters
    ----------
    extension : Extension
        Base and causes fitted without them.
    taken : ndarray, shape (parameters, columns)
        What these took of the forms' columns.
    coefficients : ndarray, shape (columns,)
        The forms' coefficients.
    covariance : ndarray, shape (columns, columns)
        Their covariance.
    """
    widths = [len(one.effect.coefficients) for one in extension.effects]
    ends = np.cumsum([len(extension.names), len(extension.gravity), *widths])
    changes, gravity, *of_effects, _ = np.split(taken @ coefficients, ends)
    variance = np.einsum("ij,jk,ik->i", taken, covariance, taken)
    return replace(
        extension,
        changes=extension.changes - changes,
        gravity=extension.gravity - gravity,
        effects=tuple(
            replace(one, coefficients=one.coefficients - values)
            for one, values in zip(extension.effects, of_effects, strict=True)
        ),
        errors=_with(extension.errors, variance),
        fixed_shape_errors=_with(extension.fixed_shape_errors, variance),
    )


def _with(errors: Array, variance: Array) -> Array:
    """Return standard errors with more variance."""
    return np.asarray(np.sqrt(np.square(errors) + np.maximum(variance, 0.0)))
