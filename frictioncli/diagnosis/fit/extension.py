r"""The base model extended by the causes found, refitted together.

The extended friction and load are linear about the base model: the simulated torque, plus its
derivatives by the base's parameters times their changes, plus the columns of each effect times its
coefficients,

.. math:: u = u_0 + \frac{\partial u}{\partial p}\, \Delta p + \sum_k X_k(\theta_k)\, c_k .
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.effects.base import Basis
from frictioncli.effects.parameter import Parameter

_STEP = 0.01
"""Share of a shape parameter's range over which its derivative is taken."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Refit:
    """Changes of the base model, and effects, fitted together.

    Attributes
    ----------
    names : tuple of str
        Friction parameters that were fitted.
    changes : ndarray, shape (names,)
        Their changes from the base, in their units.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of the gravity torque, as in the problem. [N·m], [N·m/kg]
    effects : tuple of EffectFit
        Effects with their shapes and coefficients.
    """

    names: tuple[str, ...]
    changes: Array
    gravity: Array
    effects: tuple[EffectFit, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Extension(Refit):
    """A refit with standard errors.

    Attributes
    ----------
    errors : ndarray, shape (parameters,)
        Standard errors of the changes, the gravity and the effects' coefficients, in this order.
    fixed_shape_errors : ndarray, shape (parameters,)
        The same if the shapes were known.
    shape_errors : ndarray, shape (shape parameters,)
        Standard errors of the effects' shape parameters, effect after effect; 0 where the data
        do not determine it.
    """

    errors: Array
    fixed_shape_errors: Array
    shape_errors: Array

    def place(self, number: int) -> slice:
        """Return the place of an effect's coefficients among the parameters.

        Parameters
        ----------
        number : int
            Number of the effect, from 0.
        """
        start = len(self.names) + len(self.gravity)
        start += sum(len(one.effect.coefficients) for one in self.effects[:number])
        return slice(start, start + len(self.effects[number].effect.coefficients))

    def shape_place(self, number: int) -> slice:
        """Return the place of an effect's shape parameters, behind all other parameters.

        Parameters
        ----------
        number : int
            Number of the effect, from 0.
        """
        start = len(self.errors) + sum(len(one.effect.shape) for one in self.effects[:number])
        return slice(start, start + len(self.effects[number].effect.shape))

    def may_be_zero(self, number: int) -> bool:
        """Return whether an effect's only coefficient may be zero.

        At the shape found: an effect of size zero has no shape (Davies 1977,
        doi:10.1093/biomet/64.2.247), so that its uncertainty says nothing about zero. That a shape
        was searched for is accounted for by the p-value of the search.

        Parameters
        ----------
        number : int
            Number of the effect, from 0.
        """
        values, errors = self.effects[number].coefficients, self.fixed_shape_errors
        return len(values) == 1 and abs(values[0]) <= Z95 * errors[self.place(number)][0]

    def intervals(self, number: int) -> tuple[Array, Array]:
        r"""Return the 95 % intervals of an effect's coefficients, shape (coefficients,) each.

        Shape and size of an effect may compensate each other over the range measured, as at speeds
        far above the Stribeck velocity. Where an only coefficient is not zero at the shape found,
        its interval :math:`c\, e^{\pm 1.96 \sigma / |c|}` is therefore one of its logarithm if that
        of itself held zero.

        Parameters
        ----------
        number : int
            Number of the effect, from 0.
        """
        values, errors = self.effects[number].coefficients, self.errors[self.place(number)]
        low, high = values - Z95 * errors, values + Z95 * errors
        if len(values) == 1 and low[0] * high[0] <= 0 and not self.may_be_zero(number):
            factor = np.exp(Z95 * errors / np.abs(values))
            low, high = np.sort([values / factor, values * factor], axis=0)
        return low, high


def refit(problem: Problem, weighted_fit: WeightedFit, effects: Sequence[EffectFit]) -> Refit:
    """Fit the base and effects together by weighted least squares, at fixed shapes.

    Parameters
    ----------
    problem : Problem
        Data with the base model.
    weighted_fit : WeightedFit
        Weights of both channels.
    effects : sequence of EffectFit
        Effects with the shapes found.
    """
    friction, load = fitted_rows(problem, effects)
    step = weighted_fit.coefficients(friction, load, (problem.friction_misfit, problem.load_misfit))
    widths = [len(one.effect.coefficients) for one in effects]
    ends = np.cumsum([len(problem.names), len(problem.gravity), *widths])
    changes, gravity, *coefficients, _ = np.split(step, ends)
    return Refit(
        names=problem.names,
        changes=changes,
        gravity=problem.gravity + gravity,
        effects=tuple(
            replace(one, coefficients=values)
            for one, values in zip(effects, coefficients, strict=True)
        ),
    )


def extend(problem: Problem, weighted_fit: WeightedFit, effects: Sequence[EffectFit]) -> Extension:
    """Fit the base and effects together, with standard errors; parameters as :func:`refit`.

    The uncertainty of the shape parameters is included: derivatives of the effects by their shapes
    are further columns of the error covariance.
    """
    fitted = refit(problem, weighted_fit, effects)
    columns = fitted_rows(problem, fitted.effects)
    friction, load = with_shapes(problem, fitted.effects)

    def errors_of(friction: Array, load: Array) -> Array:
        covariance = weighted_fit.error_covariance(friction, load, whole=True)
        return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 0.0)))

    errors = errors_of(friction, load)
    count = columns[0].shape[1]
    return Extension(
        names=fitted.names,
        changes=fitted.changes,
        gravity=fitted.gravity,
        effects=fitted.effects,
        errors=errors[:count],
        fixed_shape_errors=errors_of(*columns) if len(errors) > count else errors,
        shape_errors=errors[count:],
    )


def beside_unfitted(
    problem: Problem, weighted_fit: WeightedFit, effects: Sequence[EffectFit]
) -> WeightedFit:
    r"""Return a weighted fit that allows for effects that are not fitted.

    An effect of the measurement that is not named may be there all the same, and then is an error
    of what is fitted. Its coefficients *c*, estimated beside the base with the covariance
    :math:`\Sigma`, have the second moments :math:`c c^\mathsf{T} + \Sigma`.

    Parameters
    ----------
    problem : Problem
        The rows.
    weighted_fit : WeightedFit
        Weights of both channels.
    effects : sequence of EffectFit
        The effects.
    """
    for one in effects:
        friction, load = problem.basis(one.effect, one.shape)
        moments = np.outer(one.coefficients, one.coefficients) + one.covariance
        squares, axes = np.linalg.eigh(moments)
        root = axes * np.sqrt(np.maximum(squares, 0.0))
        weighted_fit = weighted_fit.beside(friction @ root, load @ root)
    return weighted_fit


def fitted_rows(problem: Problem, effects: Sequence[EffectFit]) -> tuple[Array, Array]:
    """Return the columns of base and effects in friction and load, shape (rows, columns) each.

    Parameters
    ----------
    problem : Problem
        The rows.
    effects : sequence of EffectFit
        Effects with their shapes.
    """
    bases = [base_rows(problem), *(problem.basis(one.effect, one.shape) for one in effects)]
    friction, load = (np.hstack([basis[channel] for basis in bases]) for channel in (0, 1))
    return friction, load


def with_shapes(problem: Problem, effects: Sequence[EffectFit]) -> tuple[Array, Array]:
    """Return the same, and behind them the derivatives of the effects by their shape parameters.

    Parameters
    ----------
    problem : Problem
        The rows.
    effects : sequence of EffectFit
        Effects with their shapes and coefficients.
    """
    derivatives = [
        _shape_derivative(problem, one, axis) for one in effects for axis in one.effect.shape
    ]
    friction, load = (
        np.column_stack([columns, *(one[channel] for one in derivatives)])
        for channel, columns in enumerate(fitted_rows(problem, effects))
    )
    return friction, load


def _shape_derivative(problem: Problem, one: EffectFit, axis: Parameter) -> Basis:
    """Return the derivative of an effect by a shape parameter, shape (rows,) per channel."""
    place = axis.share(one.shape[axis.name])
    ends = [axis.at(min(max(place + step, 0.0), 1.0)) for step in (-_STEP, _STEP)]
    low, high = (problem.basis(one.effect, one.shape | {axis.name: value}) for value in ends)
    width = ends[1] - ends[0]
    return Basis(
        (high.friction - low.friction) @ one.coefficients / width,
        (high.load - low.load) @ one.coefficients / width,
    )


def misfits(problem: Problem, fitted: Refit) -> tuple[Array, Array]:
    """Return measured minus extended torque in both channels, shape (rows,) each [N·m].

    Parameters
    ----------
    problem : Problem
        Rows with the base model that the extension started from.
    fitted : Refit
        Changes of the base, and effects.
    """
    changes = np.concatenate([fitted.changes, fitted.gravity - problem.gravity])
    base_friction, base_load = base_rows(problem)
    friction = problem.friction_misfit - base_friction @ changes
    load = problem.load_misfit - base_load @ changes
    for one in fitted.effects:
        basis = problem.basis(one.effect, one.shape)
        friction = friction - basis.friction @ one.coefficients
        load = load - basis.load @ one.coefficients
    return friction, load


def rms_misfit(problem: Problem, fitted: Refit) -> float:
    """Return the RMS of what a model leaves of the simulated torque [N·m].

    Parameters
    ----------
    problem : Problem
        Rows with the base model that the extension started from.
    fitted : Refit
        Changes of the base, and effects.
    """
    return float(np.sqrt(np.mean(problem.squared(*misfits(problem, fitted)))))
