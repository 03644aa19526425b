"""One step of the search: every hypothesis tested against base and accepted effects."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import basis_columns
from frictioncli.diagnosis.fit.hypotheses import (
    EffectFit,
    HypothesisTest,
    free_coefficients,
    hypothesis_of,
)
from frictioncli.diagnosis.fit.mixed_model import Components, MixedFit, Variances, evaluate
from frictioncli.diagnosis.fit.planted_columns import with_torque
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.simplex_search import simplex_minimum
from frictioncli.diagnosis.fit.transformed_columns import Part, TransformedColumns
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.ripple_order import at_twice_the_order
from frictioncli.diagnosis.search.screening import Screened, of_size, screened, test_of
from frictioncli.effects.base import Basis, Effect
from frictioncli.effects.history import since_start
from frictioncli.effects.history_search import refined_history
from frictioncli.effects.pair_series import measured_share
from frictioncli.model.noise import Noise

_Found = TypeVar("_Found")

REFITTED = 8
"""Number of hypotheses for which the variance components are estimated anew."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """The null hypothesis of one step: base and accepted effects, with their variance components.

    Attributes
    ----------
    precomputed : Precomputed
        The data and the noise models.
    accepted : tuple of EffectFit
        Effects accepted so far.
    components : Components
        What the variance components belong to.
    products : Products
        Inner products of the columns of base, discrepancy and accepted effects; the misfit is the
        last.
    fit : MixedFit
        The null hypothesis.
    """

    precomputed: Precomputed
    accepted: tuple[EffectFit, ...]
    components: Components
    products: Products
    fit: MixedFit
    _found: dict[object, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, precomputed: Precomputed, accepted: Sequence[EffectFit]) -> "Step":
        """Return the step with these effects accepted."""
        free = [free_coefficients(one) for one in accepted]
        key = tuple(
            (id(one.effect), *one.shape.items(), *numbers.tolist())
            for one, numbers in zip(accepted, free, strict=True)
        )
        if key not in precomputed.fitted:
            problem, noises = precomputed.problem, precomputed.noises
            own = [basis_columns(problem, problem.basis(one.effect, one.shape)) for one in accepted]
            parts = [Part(one.take(to), noises) for one, to in zip(own, free, strict=True)]
            products = precomputed.products.beside(parts)
            known = products.columns.count - 1
            fit = fit_variances(precomputed.components, products, known, precomputed.start)
            effects = tuple(one.effect for one in accepted)
            precomputed.fitted[key] = effects, products, fit
        _, products, fit = precomputed.fitted[key]
        return cls(
            precomputed=precomputed,
            accepted=tuple(accepted),
            components=precomputed.components,
            products=products,
            fit=fit,
        )

    def planted(self, basis: Basis, coefficients: Array) -> "Step":
        """Return the step with a torque added to its misfit, its variances estimated anew.

        Parameters
        ----------
        basis : Basis
            Columns of the torque.
        coefficients : ndarray, shape (width,)
            Their coefficients.
        """
        torque = Basis(*(one @ coefficients[:, np.newaxis] for one in basis))
        own = Part(basis_columns(self.problem, torque), self.precomputed.noises)
        products = with_torque(self.products, own)
        start = self.precomputed.start
        return replace(
            self,
            products=products,
            fit=fit_variances(self.components, products, self.known, start),
            _found={},
        )

    def once(self, key: object, work: Callable[[], _Found]) -> _Found:
        """Return what belongs to a key at this step, worked out when it is first asked for."""
        if key not in self._found:
            self._found[key] = work()
        found: _Found = self._found[key]
        return found

    @property
    def quiet(self) -> MixedFit:
        """The null hypothesis under the variance components before anything is fitted."""
        return self.once("quiet", lambda: self.null_under(self.precomputed.start))

    def null_under(self, variances: Variances) -> MixedFit:
        """Return the null hypothesis under given variance components."""
        return evaluate(self.components, self.products, self.known, variances)

    @property
    def problem(self) -> Problem:
        """The data."""
        return self.precomputed.problem

    @property
    def columns(self) -> TransformedColumns:
        """Columns of base, discrepancy and accepted effects; the misfit is the last."""
        return self.products.columns

    @property
    def known(self) -> int:
        """Number of columns of base, discrepancy and accepted effects."""
        return self.columns.count - 1

    def tested(
        self,
        catalogue: Catalogue,
        skip: Collection[str] = (),
        refitted: int = REFITTED,
        least: Mapping[str, float] = MappingProxyType({}),
    ) -> dict[str, HypothesisTest]:
        """Return the test of every hypothesis against the null hypothesis, by name.

        The variance components are estimated anew with each of those hypotheses in place that
        explain most, under the components of the null hypothesis or before anything is fitted.

        Parameters
        ----------
        catalogue : Catalogue
            Hypotheses.
        skip : collection of str, optional
            Names of hypotheses to leave out.
        refitted : int, optional
            Number of those with which the variance components are estimated anew.
        least : mapping of str to float, optional
            Least RMS torque that matters, by the name of the hypothesis. [N·m]
        """

        def under(number: int, null: MixedFit) -> Screened:
            one = catalogue.hypotheses[number]
            found = screened(catalogue, number, self.columns, null)
            return of_size(found, one.rms, least.get(one.name, 0.0))

        everything = [i for i, one in enumerate(catalogue.hypotheses) if one.name not in skip]
        found = {i: under(i, self.fit) for i in everything}
        first = {i: under(i, self.quiet) for i in everything}
        tests = {}
        chosen = set()
        for ranked in (found, first):
            order = sorted(everything, key=lambda i: -float(ranked[i].gain.max(initial=0.0)))
            chosen |= set(order[: (refitted + 1) // 2])
        for number in everything:
            hypothesis = catalogue.hypotheses[number]
            best_fit, offset = found[number], 0.0
            variances = self.fit.variances
            if number in chosen:
                best = int(np.argmax(first[number].gain))
                again = self._refitted(catalogue, number, best)
                if int(np.argmax(best_fit.gain)) != best:
                    other = self._refitted(catalogue, number, int(np.argmax(best_fit.gain)))
                    again = min(again, other, key=lambda one: one.objective)
                null = self.null_under(again.variances)
                offset = min(self.fit.objective - null.objective, 0.0)
                best_fit = under(number, null)
                variances = again.variances
            if float(best_fit.gain.max(initial=0.0)) + offset < float(
                found[number].gain.max(initial=0.0)
            ):
                best_fit, offset, variances = found[number], 0.0, self.fit.variances
            tests[hypothesis.name] = test_of(catalogue, number, best_fit, offset, variances)
        return tests

    def noise(self) -> tuple[Noise, Noise]:
        """Return the noise of friction and load that suits base and accepted effects best."""
        return self.precomputed.noise(self.fit.variances)

    def weighted_fit(self) -> WeightedFit:
        """Return the fit, weighted by this noise, by which causes are tested on another run."""
        layout, extra = self.problem.layout, self.problem.temperature_variance
        friction, load = self.noise()
        known, amplitude = self.precomputed.discrepancy, self.fit.variances.amplitude
        smooth = self.once("unseen", lambda: np.split(known.unseen(amplitude), 2))
        return WeightedFit(
            Weights.of(layout, friction, extra),
            Weights.of(layout, load, np.zeros_like(extra)),
            ((smooth[0], smooth[1]),),
        )

    def predicting_fit(self) -> WeightedFit:
        """Return the fit by which predictions are made: of all rows alike."""
        fit = self.weighted_fit()
        return replace(fit, friction=fit.friction.alike(), load=fit.load.alike())

    def refined(self, found: EffectFit) -> EffectFit:
        """Return an effect with its shape optimised off the grid, and the variances with it.

        A ripple that consists of its second harmonic alone has twice the order.

        Parameters
        ----------
        found : EffectFit
            The effect at a shape of the grid, or near it.
        """
        effect, axes = found.effect, found.effect.shape
        if not axes:
            return self.fitted(effect, found.shape)
        if effect.moments is not None:
            return self._refined_change(found)
        null = self.null_under(self._fit_with(effect, found.shape).variances)

        start = np.array([axis.share(found.shape[axis.name]) for axis in axes])
        step = np.array([0.5 / axis.points for axis in axes])

        def shape_at(unit: Array) -> dict[str, float]:
            return {axis.name: axis.at(float(u)) for axis, u in zip(axes, unit, strict=True)}

        place, _ = simplex_minimum(
            lambda unit: -self._gain(effect, shape_at(unit), null),
            start,
            step,
            evaluations=16,
            tolerance=(5e-3, 5e-2),
        )
        return at_twice_the_order(self.fitted(effect, shape_at(place)), self.refined)

    def _refined_change(self, found: EffectFit) -> EffectFit:
        """Return a change with its moments moved to single pairs.

        Where a slow drift is likely, only a history with all moments right explains more than it.
        The moments of one that is tried first are therefore also searched under the noise before
        anything is fitted.
        """
        effect = found.effect

        def refined(shape: dict[str, float], null: MixedFit) -> dict[str, float]:
            rows, table = self.problem.rows, self.problem.all_runs
            best = refined_history(
                shape, table, rows, lambda one: self._gain(effect, one, null) / 2
            )
            return since_start(best, measured_share(table)[rows])

        suited = self.null_under(self._fit_with(effect, found.shape).variances)
        starts = [found.shape]
        if found.shape in effect.shapes(self.problem.all_runs):
            starts.append(refined(found.shape, self.quiet))
        shapes = [found.shape, *(refined(shape, suited) for shape in starts)]
        fits = [self.fitted(effect, shape) for shape in shapes]
        return max(fits, key=lambda one: one.statistic)

    def _gain(self, effect: Effect, shape: dict[str, float], null: MixedFit) -> float:
        """Return twice the log likelihood ratio of an effect under given variance components."""
        alone = self._alone_at(effect, shape)
        return float(screened(alone, 0, self.columns, null).gain[0])

    def fitted(self, effect: Effect, shape: dict[str, float]) -> EffectFit:
        """Return an effect fitted at one shape, the variance components with it."""
        variances = self._fit_with(effect, shape).variances
        null = self.null_under(variances)
        alone = self._alone_at(effect, shape)
        found = screened(alone, 0, self.columns, null)
        statistic = float(found.gain[0]) + min(self.fit.objective - null.objective, 0.0)
        return EffectFit(
            effect,
            shape,
            found.coefficients[0],
            found.covariance[0],
            max(statistic, 0.0),
            variances,
        )

    def _fit_with(self, effect: Effect, shape: dict[str, float]) -> MixedFit:
        alone = self._alone_at(effect, shape)
        return self._refitted(alone, 0, 0)

    def _alone_at(self, effect: Effect, shape: dict[str, float]) -> Catalogue:
        """Return the catalogue of one effect at one shape."""

        def alone() -> tuple[Effect, Catalogue]:
            found = hypothesis_of(effect, self.problem, [shape])
            return effect, Catalogue.of(self.precomputed, [found])

        return self.once((id(effect), *shape.items()), alone)[1]

    def _refitted(self, catalogue: Catalogue, number: int, shape: int) -> MixedFit:
        """Return the fit of a hypothesis at one of its shapes, with the variance components."""
        own = catalogue.shape_part(number, shape)
        products = self.products.beside([own])
        starts = self.fit.variances, self.precomputed.start
        return fit_variances(self.components, products, self.known, *starts)
