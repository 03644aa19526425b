r"""Fits of a step with torques planted into its misfit, in any size, from few inner products.

Under given variance components *k* minus twice the log likelihood of base and other causes is
quadratic in the size *s* of what is planted,

.. math:: o_k(s) = o_k + 2 s\, d^\mathsf{T} P_k y + s^2 d^\mathsf{T} P_k d ,

with the torque *d* of size 1, the misfit *y* and :math:`P_k`, which takes out the known columns.
What columns of an effect explain of it follows from the same products. So the variance components
that suit a size best are chosen from a family, of which each member is worked out once.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.bounded import bounded_coefficients, pseudo_inverse
from frictioncli.diagnosis.fit.columns import basis_columns, joined
from frictioncli.diagnosis.fit.hypotheses import EffectFit, physical_bounds
from frictioncli.diagnosis.fit.mixed_model import MixedFit, Variances
from frictioncli.diagnosis.fit.planted_columns import WithinProducts, weighted_products
from frictioncli.diagnosis.fit.transformed_columns import Part
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.search.planted_torque import PlantedTorque
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis, friction_only

SHARED = 2
"""Number of sets of variance components that are known without anything planted, and that all
effects beside a step share; they come first."""

_NOTHING = 1e-300
"""Squared length of a column of which nothing is left."""


@dataclass(frozen=True, slots=True)
class Left:
    """What the known columns leave under one set of variance components, as inner products.

    Attributes
    ----------
    variances : Variances
        The variance components.
    right : ndarray, shape (columns,)
        Products of the columns with the misfit.
    inner : ndarray, shape (columns, columns)
        Products of the columns with each other.
    inverse : ndarray, shape (torques, width, width)
        Inverse of the products of what is fitted to each torque.
    plain, alone : ndarray, shape (torques, 3)
        Minus twice the log likelihood with each torque as a polynomial in its size, the constant
        first: of what is known, and with what is fitted, whose coefficients have no bounds.
    """

    variances: Variances
    right: Array
    inner: Array
    inverse: Array
    plain: Array
    alone: Array


@dataclass(frozen=True, slots=True)
class PlantedFit:
    """A torque of one size in the misfit, and its effect fitted beside base and other causes.

    Attributes
    ----------
    number : int
        Number of the torque.
    size : float
        Its size. [unit of its channel]
    fit : EffectFit
        The effect.
    member : int
        Member of the family that suits it best.
    offset : float
        Twice the log likelihood of base and other causes alone under its variance components, less
        that under those that suit them best; not above 0.
    missed : float
        Twice the log likelihood that the rest of the torque would gain.
    """

    number: int
    size: float
    fit: EffectFit
    member: int
    offset: float
    missed: float


@dataclass(frozen=True, slots=True)
class PlantedFits:
    """Shapes of an effect, each planted into the misfit of a step.

    Attributes
    ----------
    step : Step
        Base and other causes.
    torques : tuple of PlantedTorque
        What is planted.
    part : Part
        Torque and columns of the effect, shape by shape, and the column of the base that is freed.
    freed : bool
        Whether there is such a column.
    within : WithinProducts
        Products of deviations within pairs of the columns of the step with those of the part.
    physical : (ndarray, ndarray), shape (coefficients,)
        Bounds of the coefficients of the effect.
    family : list of Left
        What is left under each set of variance components.
    """

    step: Step
    torques: tuple[PlantedTorque, ...]
    part: Part
    freed: bool
    within: WithinProducts
    physical: tuple[Array, Array]
    family: list[Left] = field(default_factory=list)

    @classmethod
    def of(cls, step: Step, torques: Sequence[PlantedTorque]) -> "PlantedFits":
        """Return the fits under the variance components before and after other causes are fitted.

        Parameters
        ----------
        step : Step
            Base and other causes.
        torques : sequence of PlantedTorque
            Shapes of one effect.
        """
        problem = step.problem
        bases = [one for own in torques for one in (own.torque, own.columns)]
        freed = freed_base(problem)
        bases += [] if freed is None else [freed]
        columns = joined([basis_columns(problem, one) for one in bases])
        part = Part(columns, step.precomputed.noises)
        bounds = physical_bounds(torques[0].effect, problem)
        within = WithinProducts.of(step.columns, part)
        fits = cls(step, tuple(torques), part, freed is not None, within, bounds)
        for one in (step.fit, step.quiet):
            fits.add(one)
        return fits

    def add(self, null: MixedFit) -> None:
        """Add the variance components of a fit of base and other causes to the family."""
        part, variances = self.part, null.variances
        across, own = weighted_products(self.step.columns, part, variances, self.within)
        known = across[:-1]
        right = across[-1] - null.coefficients @ known
        inner = own - known.T @ (null.covariance @ known)
        places = [self._places(number) for number in range(len(self.torques))]
        inverse = pseudo_inverse(np.array([inner[np.ix_(one, one)] for _, one in places]))
        plain = np.array([(null.objective, 2 * right[at], inner[at, at]) for at, _ in places])
        fixed = np.array([right[one] for _, one in places])
        growing = np.array([inner[at, one] for at, one in places])
        gain = [
            np.einsum("ti,tij,tj->t", first, inverse, second)
            for first, second in ((fixed, fixed), (2 * fixed, growing), (growing, growing))
        ]
        alone = plain - np.column_stack(gain)
        self.family.append(Left(variances, right, inner, inverse, plain, alone))

    def add_best(self, number: int, size: float) -> None:
        """Add the variance components that suit the step best with a torque of one size.

        At first those that suit the effect beside it, too: it leaves what its form misses.

        Parameters
        ----------
        number : int
            Number of the torque.
        size : float
            Its size. [unit of its channel]
        """
        step = self.step.planted(self.torques[number].torque, np.array([size]))
        first = len(self.family) == SHARED
        self.add(self.step.null_under(step.fit.variances))
        if first:
            own = self.part.take(self._places(number)[1].tolist())
            products = step.products.beside([own])
            starts = step.fit.variances, step.precomputed.start
            fit = fit_variances(step.components, products, step.known, *starts)
            self.add(self.step.null_under(fit.variances))

    def most_statistics(self, number: int, sizes: Array) -> Array:
        """Return twice the log likelihood ratios of the effect if its coefficients had no bounds.

        Parameters
        ----------
        number : int
            Number of the torque.
        sizes : ndarray, shape (sizes,)
            Its sizes. [unit of its channel]
        """
        null, _ = self._null(number, sizes)
        return np.asarray(null.min(axis=0) - self._alone(number, sizes).min(axis=0))

    def fitted(self, number: int, size: float, members: int | None = None) -> PlantedFit:
        """Return the effect fitted beside the step with a torque of one size.

        Parameters
        ----------
        number : int
            Number of the torque.
        size : float
            Its size. [unit of its channel]
        members : int, optional
            How many of the family the effect may choose from; by default all.
        """
        one = np.array([size])
        null, plain = (found[:, 0] for found in self._null(number, one))
        member = int(np.argmin(self._alone(number, one)[:members, 0]))
        torque, left = self.torques[number], self.family[member]
        place, columns = self._places(number)
        right = left.right[columns] + size * left.inner[place, columns]
        inner = left.inner[np.ix_(columns, columns)]
        lower, upper = self.physical
        if self.freed:
            lower, upper = np.append(lower, 0.0), np.append(upper, np.inf)
        coefficients, gain, free = bounded_coefficients(
            inner[np.newaxis], right[np.newaxis], lower, upper
        )
        covariance = left.inverse[number]
        if not free.all():
            both = free[0][:, np.newaxis] & free[0]
            covariance = pseudo_inverse(np.where(both, inner, 0.0)[np.newaxis])[0]
            covariance = np.where(both, covariance, 0.0)
        own = slice(0, len(torque.coefficients))
        chosen = np.append(place, columns[own])
        rest = np.append(size, -coefficients[0, own])
        # without the effect the freed column may be fitted, too
        alone = float(plain[member] - gain[0])
        return PlantedFit(
            number=number,
            size=size,
            fit=EffectFit(
                torque.effect,
                torque.shape,
                coefficients[0, own],
                covariance[own, own],
                max(float(null.min() - alone), 0.0),
                left.variances,
            ),
            member=member,
            offset=float(null.min() - null[member]),
            missed=float(rest @ left.inner[np.ix_(chosen, chosen)] @ rest),
        )

    @property
    def torque_part(self) -> Part:
        """The torques alone."""
        width = self._width
        return self.part.take(slice(0, width * len(self.torques), width))

    @property
    def _width(self) -> int:
        """Columns of each shape: its torque and those of its effect."""
        return 1 + len(self.torques[0].coefficients)

    def _places(self, number: int) -> tuple[int, Indices]:
        """Return the places of a torque and of what is fitted: its effect and the freed column."""
        first, last = number * self._width, (number + 1) * self._width
        fitted = np.arange(first + 1, last)
        return first, np.append(fitted, self.part.columns.count - 1) if self.freed else fitted

    def _null(self, number: int, sizes: Array) -> tuple[Array, Array]:
        """Return minus twice the log likelihood of what is known, shape (members, sizes) each.

        With a torque and the freed column, where it is positive; and without that column.
        """
        plain = np.array([left.plain[number] for left in self.family]) @ _powers(sizes)
        if not self.freed:
            return plain, plain
        place = self._places(number)[0]
        fixed, growing, inner = np.array(
            [(left.right[-1], left.inner[place, -1], left.inner[-1, -1]) for left in self.family]
        ).T[:, :, np.newaxis]
        right = np.maximum(fixed + sizes * growing, 0.0)
        # a column of which nothing is left beside what is known gains nothing
        own = np.broadcast_to(inner > _NOTHING, right.shape)
        return plain - np.divide(np.square(right), inner, np.zeros_like(right), where=own), plain

    def _alone(self, number: int, sizes: Array) -> Array:
        """Return the same with the effect, whose coefficients have no bounds."""
        return np.asarray(np.array([left.alone[number] for left in self.family]) @ _powers(sizes))


def _powers(sizes: Array) -> Array:
    """Return the powers of sizes up to the second, shape (3, sizes)."""
    return np.array([np.ones_like(sizes), sizes, np.square(sizes)])


def freed_base(problem: Problem) -> Basis | None:
    """Return the column of a parameter of the base that is zero, and need not be with an effect.

    Parameters
    ----------
    problem : Problem
        The joint's rows.

    Returns
    -------
    Basis or None
        Friction by the square of the load; None where the base has it.
    """
    load = problem.table.load
    if "alpha" in problem.names or not np.ptp(np.abs(load)) > 0:
        return None
    return friction_only(np.square(load))
