"""Functions estimated from a misfit, and what they reduce of rows that they have not seen."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.fitted_columns import refitted_beside
from frictioncli.diagnosis.empirical.located import sizes_of_parts
from frictioncli.diagnosis.empirical.normal_equations import Misfits, NormalEquations
from frictioncli.diagnosis.empirical.random_functions import Function, term_of
from frictioncli.diagnosis.empirical.term import EmpiricalTerm
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.fit.gain import Gain, gain_of
from frictioncli.diagnosis.noise.cosine_series import CosineSeries
from frictioncli.effects.base import Basis

_LEAST_OF_PART = 1 / 3
"""Share of itself with which a form must show in each part of the pairs alone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimatedFunctions:
    """Functions with their normal equations, and what they gain on blocks kept out.

    Attributes
    ----------
    functions : list of Function
        The functions, forms first.
    equations : NormalEquations
        Their normal equations.
    gain : Gain
        What they reduce the misfit by on blocks of pairs that were kept out.
    """

    functions: list[Function]
    equations: NormalEquations
    gain: Gain

    def term(self) -> EmpiricalTerm:
        """Return the term that they make."""
        return term_of(self.equations.problem, self.functions, self.equations.coefficients())

    def beyond_base(self) -> "EstimatedFunctions":
        """Return them with what base and causes take here: these were fitted to other rows."""
        problem = self.equations.problem
        base = np.vstack(base_rows(problem))

        def whole(one: Function) -> Array:
            if isinstance(one.what, CosineSeries):
                return one.columns + base @ one.taken
            form, shape = one.what
            return np.vstack(form.columns(problem.table, shape))

        functions = [
            replace(one, taken=np.zeros_like(one.taken), columns=whole(one))
            for one in self.functions
        ]
        columns = np.hstack([one.columns for one in functions])
        return replace(
            self, functions=functions, equations=replace(self.equations, columns=columns)
        )

    def refitted(self, extension: Extension) -> Extension:
        """Return base and causes refitted beside the forms.

        Parameters
        ----------
        extension : Extension
            Base and causes fitted without them.
        """
        taken = [one.taken for one in self.functions if one.is_form]
        if not taken:
            return extension
        chosen = self.equations.of_form
        return refitted_beside(
            extension,
            np.hstack(taken),
            self.equations.coefficients()[chosen],
            self.equations.covariance()[np.ix_(chosen, chosen)],
        )


def reduced_by(
    problem: Problem, before: Misfits, after: Misfits, *, basis: str, floor: float, seed: int
) -> Gain:
    """Return by how much a term reduces a misfit.

    Parameters
    ----------
    problem : Problem
        The rows.
    before, after : (ndarray, ndarray), shape (rows,)
        What is left of both channels without and with the term. [N·m]
    basis : {"new_run", "within_run"}
        Whether these rows were new to base and causes.
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    seed : int
        Seed of the block bootstrap.
    """
    squares = problem.squared(*before), problem.squared(*after)
    return gain_of(problem, *squares, basis=basis, floor=floor, seed=seed)


def without_term(misfit: Misfits, term: Basis) -> Misfits:
    """Return what a term leaves of a misfit.

    Parameters
    ----------
    misfit : (ndarray, ndarray), shape (rows,)
        The misfit of both channels. [N·m]
    term : Basis
        The term in both. [N·m]
    """
    return misfit[0] - term.friction, misfit[1] - term.load


def recurs(found: EstimatedFunctions) -> bool:
    """Return whether each form shows in each part of the pairs alone.

    Parameters
    ----------
    found : EstimatedFunctions
        Functions, some of them forms.
    """
    sizes = sizes_of_parts(found.functions, found.equations)
    return all(
        shares.min() >= _LEAST_OF_PART
        for one, (_, shares) in zip(found.functions, sizes, strict=True)
        if one.is_form
    )


def explained(gain: Gain) -> float:
    """Return the RMS of what a term explains of rows that it has not seen [N·m].

    Parameters
    ----------
    gain : Gain
        By how much it reduces the misfit of these rows.
    """
    return float(np.sqrt(max(gain.before**2 - gain.after**2, 0.0)))


def surely_explained(gain: Gain) -> float:
    """Return the lower end of the 95 % interval of what a term explains, as RMS [N·m].

    Parameters
    ----------
    gain : Gain
        By how much it reduces the misfit of these rows.
    """
    return gain.before * float(np.sqrt(max(1 - (1 - max(gain.interval[0], 0.0)) ** 2, 0.0)))


def is_worth_using(gain: Gain, margin: float) -> bool:
    """Return whether a term explains more of rows that it has not seen than is worth a name.

    Parameters
    ----------
    gain : Gain
        By how much it reduces the misfit of these rows.
    margin : float
        Smallest size worth a name. [N·m]
    """
    return gain.interval[0] > 0 and explained(gain) >= margin
