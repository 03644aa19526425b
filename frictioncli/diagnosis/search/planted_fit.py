"""An effect planted into the misfit of a step, and the fit that is expected of it."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.fit.columns import basis_columns, main_channel
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.mixed_model import MixedFit
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import Part
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.search.possible import beyond_bounds
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis, Effect

FORM = 0.05
"""What the form of an entry misses of an effect, relative to its size: no joint follows the
equation exactly. It differs from pair to pair."""

_SEEN = 1e-6
"""Share of the largest column of an effect below which a column is not there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantedFit:
    """An effect of one shape planted into the misfit of a step, in any size.

    Attributes
    ----------
    step : Step
        Base and other causes, with the data.
    effect : Effect
        The effect.
    shape : dict of str to float
        Its shape.
    direction : ndarray, shape (coefficients,)
        Its coefficients at an RMS of 1 N·m in its channel: the first that the data show.
    seen : ndarray of int
        Coefficients that the data show.
    products : Products
        Inner products of the step's columns, those of the effect, what its form misses of an RMS of
        1 N·m, and the misfit.
    fit : MixedFit
        The fit of the misfit as it is, with the effect in place.
    """

    step: Step
    effect: Effect
    shape: dict[str, float]
    direction: Array
    seen: Indices
    products: Products
    fit: MixedFit

    @classmethod
    def of(cls, step: Step, effect: Effect, shape: dict[str, float]) -> "PlantedFit | None":
        """Return an effect of one shape; None where these data do not show it.

        Parameters
        ----------
        step : Step
            Base and other causes.
        effect : Effect
            The effect.
        shape : dict of str to float
            Its shape.
        """
        problem, noises = step.problem, step.precomputed.noises
        basis = problem.basis(effect, shape)
        rms = _rms(np.vstack(basis))
        seen = np.flatnonzero(rms > _SEEN * rms.max(initial=0.0))
        main = _rms(main_channel(basis, effect))
        shown = [int(one) for one in seen if main[one] > _SEEN * rms.max(initial=0.0)]
        if not shown:
            return None
        first = shown[0]
        direction = np.zeros(len(rms))
        direction[first] = (-1.0 if effect.coefficients[first].upper <= 0 else 1.0) / main[first]
        missed = _missed_by_form(step, Basis(*(one @ direction for one in basis)))
        columns = basis_columns(problem, basis).take(seen)
        parts = [Part(one, noises) for one in (columns, basis_columns(problem, missed))]
        planted = cls(
            step=step,
            effect=effect,
            shape=shape,
            direction=direction,
            seen=seen,
            products=step.columns.bordered(step.products, parts),
            fit=step.fit,
        )
        return replace(planted, fit=planted._fit(0.0, np.zeros(len(seen))))

    def is_possible(self, size: float) -> bool:
        """Return whether a size is physically possible.

        Parameters
        ----------
        size : float
            RMS of the whole torque in the channel of the effect. [N·m]
        """
        return not beyond_bounds(self.alone(size), self.step.problem)

    def alone(self, size: float) -> EffectFit:
        """Return a size as it would be fitted with noise and discrepancy as they are.

        Parameters
        ----------
        size : float
            RMS of the whole torque in the channel of the effect. [N·m]
        """
        return self._effect_fit(self.fit, size * self.direction, 0.0)

    def expected(self, size: float) -> EffectFit:
        """Return the fit that is expected of a size, with its statistic.

        What already looks like the effect is taken out, unless it cannot be the effect.

        Parameters
        ----------
        size : float
            RMS of the whole torque in the channel of the effect. [N·m]
        """
        step, there = self.step, np.zeros(len(self.direction))
        there[self.seen] = self.fit.coefficients[step.known :]
        coefficients = size * self.direction
        if beyond_bounds(self._effect_fit(self.fit, there, 0.0), step.problem):
            coefficients = coefficients + there
        added = (coefficients - there)[self.seen]
        fit = self._fit(size, added)
        planted = self._products(size, added, step.known)
        null = fit_variances(step.components, planted, step.known, step.precomputed.start)
        return self._effect_fit(fit, coefficients, null.objective - fit.objective)

    def _effect_fit(self, fit: MixedFit, coefficients: Array, statistic: float) -> EffectFit:
        place = slice(self.step.known, self.step.known + len(self.seen))
        covariance = np.zeros((len(coefficients),) * 2)
        covariance[np.ix_(self.seen, self.seen)] = fit.covariance[place, place]
        return EffectFit(
            self.effect, self.shape, coefficients, covariance, statistic, fit.variances
        )

    def _fit(self, size: float, added: Array) -> MixedFit:
        """Return the fit with the effect in place."""
        step = self.step
        products = self._products(size, added, step.known + len(self.seen))
        starts = [self.fit.variances] if size > 0 else [self.fit.variances, step.precomputed.start]
        return fit_variances(step.components, products, step.known, *starts)

    def _products(self, size: float, added: Array, kept: int) -> Products:
        """Return inner products of the first columns and the misfit with the effect planted."""
        mixed = np.append(added, FORM * size)
        within, between = (
            [_with_misfit(one, self.step.known, mixed, kept) for one in part]
            for part in (self.products.within, self.products.between)
        )
        return Products(within=(within[0], within[1]), between=(between[0], between[1]))


def _missed_by_form(step: Step, torque: Basis) -> Basis:
    """Return what the form of an entry misses of a torque, pair by pair, shape (rows, 1)."""
    layout = step.problem.layout
    draws = np.random.default_rng(0).standard_normal(len(layout.time))[layout.row_pair]
    return Basis(*((draws * one)[:, np.newaxis] for one in torque))


def _with_misfit(gram: Array, known: int, added: Array, kept: int) -> Array:
    """Return inner products of the first columns and a misfit to which others are added.

    Parameters
    ----------
    gram : ndarray, shape (..., columns, columns)
        Of the known columns, those that are added and the misfit.
    known : int
        Number of known columns.
    added : ndarray, shape (width,)
        Coefficients of what is added.
    kept : int
        Number of columns to keep beside the misfit.
    """
    column = gram[..., -1] + gram[..., known:-1] @ added
    found = np.empty((*gram.shape[:-2], kept + 1, kept + 1))
    found[..., :kept, :kept] = gram[..., :kept, :kept]
    found[..., :kept, kept] = found[..., kept, :kept] = column[..., :kept]
    found[..., kept, kept] = column[..., -1] + column[..., known:-1] @ added
    return found


def _rms(columns: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(np.square(columns), axis=0)))
