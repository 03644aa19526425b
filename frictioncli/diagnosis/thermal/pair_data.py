"""Pairs of a problem, prepared for fits with a hidden temperature."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.base import Basis
from frictioncli.effects.pair_series import pair_heads
from frictioncli.effects.thermal_lag import ThermalInputs
from frictioncli.linear_algebra import orthonormal_basis

RANK = 1e-10
"""Singular values of unit columns below this share of the greatest count as zero."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalData:
    """Means of pairs, and what deviations within them tell.

    Attributes
    ----------
    inputs : ThermalInputs
        What drives the gear, in all pairs of all runs.
    pairs : ndarray of int, shape (pairs,)
        Which of those pairs the problem has.
    root_speed : ndarray, shape (pairs,)
        Root of the speed. [(deg/s)^0.5]
    target : ndarray, shape (pairs,)
        Mean friction of each pair, less what fixed parameters explain. [N·m]
    linear : ndarray, shape (pairs, columns)
        Means of the linear columns: those of the free parameters but gamma and delta, and of other
        effects. [N·m per unit]
    names : tuple of str
        Parameters that the first of the linear columns belong to.
    within : ndarray, shape (columns + 1, columns + 1)
        Triangular factor of the deviations within pairs of the same columns and, last, of the
        friction, in units of their noise. [-]
    delta : float
        Delta of the base model, where fits start. [1/°C]
    deviation : float
        Standard deviation of a pair mean by which it is weighted. [N·m]
    """

    inputs: ThermalInputs
    pairs: Indices
    root_speed: Array
    target: Array
    linear: Array
    names: tuple[str, ...]
    within: Array
    delta: float
    deviation: float

    @classmethod
    def of(
        cls,
        problem: Problem,
        beside: Sequence[Basis],
        *,
        point: float,
        deviation: float,
    ) -> "ThermalData":
        """Return the data of a problem.

        Parameters
        ----------
        problem : Problem
            The rows.
        beside : sequence of Basis
            Columns of other effects at these rows.
        point, deviation : float
            Standard deviation of an angle bin about the mean of its pair, and of a pair mean. [N·m]
        """
        table, layout, parameters = problem.table, problem.layout, problem.parameters
        columns = {
            "tau_c": np.ones_like(table.speed),
            "alpha": np.square(table.load),
            "beta": np.sqrt(table.speed),
        }
        names = tuple(name for name in columns if name in problem.names)
        fixed = [getattr(parameters, name) * columns[name] for name in columns if name not in names]
        target = problem.friction - sum(fixed, np.zeros_like(problem.friction))
        linear = [columns[name][:, np.newaxis] for name in names]
        linear += [basis.friction for basis in beside]
        rows = np.column_stack([*linear, target])
        heads = pair_heads(problem.all_runs)
        means = layout.means(rows)
        return cls(
            inputs=problem.all_runs.once(ThermalInputs.of),
            pairs=np.unique(heads.of_row[problem.rows]),
            root_speed=layout.means(np.sqrt(table.speed)[:, np.newaxis])[:, 0],
            target=means[:, -1],
            linear=means[:, :-1],
            names=names,
            within=np.asarray(np.linalg.qr(layout.contrasts(rows) / point)[1]),
            delta=parameters.delta,
            deviation=deviation,
        )

    def excess(self, time_constant: float, housing_time_constant: float | None) -> Array:
        """Return the parts of the network at the problem's pairs, shape (pairs, 4).

        Parameters
        ----------
        time_constant : float
            Time constant of the gear. [s]
        housing_time_constant : float or None
            Time constant of a housing that is not measured; none where that is no part. [s]
        """
        inputs = self.inputs
        if housing_time_constant is not None:
            inputs = inputs.with_hidden_housing(housing_time_constant)
        return inputs.excess(time_constant)[self.pairs]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearPart:
    """The columns that do not depend on the hidden temperature, and what they leave of friction.

    Pair means stand above what deviations within pairs tell, all in units of their noise.

    Attributes
    ----------
    columns : ndarray, shape (rows, columns)
        The columns.
    basis : ndarray, shape (rows, rank)
        Orthonormal basis of them.
    target, left : ndarray, shape (rows,)
        The friction, and what the columns leave of it.
    deviation : float
        Standard deviation of a pair mean. [N·m]
    """

    columns: Array
    basis: Array
    target: Array
    left: Array
    deviation: float

    @classmethod
    def of(cls, data: ThermalData) -> "LinearPart":
        """Return the linear part of the data of a problem."""
        count = data.linear.shape[1]
        columns = np.vstack([data.linear / data.deviation, data.within[:, :count]])
        basis = orthonormal_basis(columns, tolerance=RANK)
        target = np.concatenate([data.target / data.deviation, data.within[:, -1]])
        left = target - basis @ (basis.T @ target)
        return cls(columns=columns, basis=basis, target=target, left=left, deviation=data.deviation)

    def weighted(self, means: Array) -> Array:
        """Return a torque that is the same in all angle bins of a pair, shape (rows,).

        Parameters
        ----------
        means : ndarray, shape (pairs,)
            The torque. [N·m]
        """
        below = np.zeros(len(self.target) - len(means))
        return np.append(means / self.deviation, below)

    def beside(self, means: Array) -> Array:
        """Return the coefficients of the columns beside such a torque, shape (columns,).

        Parameters
        ----------
        means : ndarray, shape (pairs,)
            The torque. [N·m]
        """
        length = np.linalg.norm(self.columns, axis=0)
        length = np.where(length > 0, length, 1.0)
        left = self.target - self.weighted(means)
        return np.asarray(np.linalg.lstsq(self.columns / length, left, rcond=RANK)[0] / length)
