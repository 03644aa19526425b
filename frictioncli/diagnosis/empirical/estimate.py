r"""Estimate of the empirical term, and whether it is used.

The discrepancy that any model has (:mod:`frictioncli.diagnosis.noise.discrepancy`) is a sum of
random functions with known amplitudes beside the noise. Its best estimate from the misfit *y* that
base and causes leave is the mean given the data,

.. math:: \hat\gamma = (O^\mathsf{T} W O + I)^{-1} O^\mathsf{T} W y

with the functions' columns *O*, orthogonal to the base, each scaled to its amplitude, and the
inverse *W* of the noise's covariance [1]_. Noise alone gives a small estimate.

It is used only where it predicts pairs that it has not seen: the pairs are cut into blocks of
neighbours, a fifth of the blocks at a time is kept out of the estimate, and what the estimate then
reduces the misfit by on those,

.. math:: \sqrt{\overline{y^2} - \overline{(y - \hat y)^2}} ,

must be above the smallest size worth a name, and beyond chance. Where a run was kept out of the
diagnosis, so must what it reduces the misfit by there.

References
----------
.. [1] G. K. Robinson, "That BLUP is a good thing: the estimation of random effects," Stat. Sci.
   6(1), 1991, doi:10.1214/ss/1177011926.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.random_functions import Function, functions_of, term_of
from frictioncli.diagnosis.empirical.term import EmpiricalTerm
from frictioncli.diagnosis.fit.extension import Extension, Gain, misfits, reduction_interval
from frictioncli.diagnosis.fit.weighted_fit import Weights
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis
from frictioncli.model.noise import Noise

_PARTS = 5
"""Parts of the pairs, each of which is kept out of one estimate."""

_BLOCK = 12
"""Neighbouring pairs that are kept out together: their misfits are not independent."""

Misfits = tuple[Array, Array]


@dataclass(frozen=True, slots=True, kw_only=True)
class Empirical:
    """An empirical term that is worth using, with what it gains.

    Attributes
    ----------
    term : EmpiricalTerm
        The term.
    size : float
        Its RMS over the rows that it was estimated from. [N·m]
    kept_out : float
        RMS of what it explains on blocks of pairs that were kept out of its estimate. [N·m]
    gain : Gain
        Reduction of the misfit that base and causes leave, on the run kept out of the diagnosis, or
        on the blocks kept out of the estimate.
    beside : Extension
        Base and causes that it was estimated beside.
    """

    term: EmpiricalTerm
    size: float
    kept_out: float
    gain: Gain
    beside: Extension


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
    inner : ndarray, shape (parts, columns, columns)
        Inner products of the columns.
    right : ndarray, shape (parts, columns)
        Inner products with the misfit.
    """

    problem: Problem
    columns: Array
    part: Indices
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
        part = problem.layout.row_pair // _BLOCK % _PARTS
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
        return np.linalg.solve(inner + np.eye(len(right)), right)

    def predicted_blocks(self) -> Basis:
        """Return what estimates predict of the rows kept out of them, shape (rows,) each [N·m]."""
        found = np.zeros(len(self.columns))
        for number in range(len(self.inner)):
            out = np.tile(self.part == number, 2)
            found[out] = self.columns[out] @ self.coefficients(without=number)
        return Basis(*np.split(found, 2))


def reduced_by(
    problem: Problem, misfit: Misfits, term: Basis, *, basis: str, floor: float, seed: int
) -> Gain:
    """Return by how much a term reduces a misfit.

    Parameters
    ----------
    problem : Problem
        The rows.
    misfit : (ndarray, ndarray), shape (rows,)
        What base and causes leave of both channels. [N·m]
    term : Basis
        The term at these rows. [N·m]
    basis : {"new_run", "within_run"}
        Whether these rows were new to base and causes.
    floor : float
        RMS of point and pair noise. [N·m]
    seed : int
        Seed of the block bootstrap.
    """
    before = problem.squared(*misfit)
    after = problem.squared(misfit[0] - term.friction, misfit[1] - term.load)
    first, last = float(np.sqrt(np.mean(before))), float(np.sqrt(np.mean(after)))
    return Gain(
        basis=basis,
        before=first,
        after=last,
        reduction=1 - last / max(first, 1e-300),
        interval=reduction_interval(problem, before, after, seed),
        floor=floor,
    )


def empirical_term(
    step: Step,
    seen: tuple[Problem, Extension],
    new: tuple[Problem, Extension] | None,
    *,
    margin: float,
    floor: float,
    seed: int,
) -> Empirical | None:
    """Return an empirical term for what base and causes leave; None where it is not worth using.

    Parameters
    ----------
    step : Step
        The last step of the search: noise, and amplitudes of the discrepancy.
    seen : (Problem, Extension)
        Rows to learn from, and base with causes fitted to them.
    new : (Problem, Extension) or None
        Rows of a run that was kept out, and base with the causes that hold there.
    margin : float
        Smallest size worth a name. [N·m]
    floor : float
        RMS of point and pair noise. [N·m]
    seed : int
        Seed of the block bootstrap.
    """
    problem, misfit = seen[0], misfits(*seen)
    components = step.precomputed.discrepancy.components
    functions = functions_of(problem, components, step.fit.variances.amplitude)
    if not functions:
        return None
    equations = NormalEquations.of(problem, functions, step.noise(), misfit)
    unseen = equations.predicted_blocks()
    gain = reduced_by(problem, misfit, unseen, basis="within_run", floor=floor, seed=seed)
    explained = _explained(gain)
    if not _is_worth_using(gain, margin):
        return None
    term = term_of(problem, functions, equations.coefficients())
    if new is not None:
        added = term.at(new[0])
        gain = reduced_by(new[0], misfits(*new), added, basis="new_run", floor=floor, seed=seed)
        if not _is_worth_using(gain, margin):
            return None
    added = term.at(problem)
    size = float(np.sqrt(np.mean(problem.squared(added.friction, added.load))))
    return Empirical(term=term, size=size, kept_out=explained, gain=gain, beside=seen[1])


def _explained(gain: Gain) -> float:
    """Return the RMS of what a term explains of rows that it has not seen [N·m]."""
    return float(np.sqrt(max(gain.before**2 - gain.after**2, 0.0)))


def _is_worth_using(gain: Gain, margin: float) -> bool:
    """Return whether a term explains more of rows that it has not seen than is worth a name."""
    return gain.interval[0] > 0 and _explained(gain) >= margin
