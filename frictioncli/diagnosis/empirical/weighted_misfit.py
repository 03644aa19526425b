r"""A weighted misfit beside base, causes and discrepancy, and what forms explain of it.

The misfit *y* has the covariance *V* of the noise and of the discrepancy that any model has. What
columns *X* of a form explain is

.. math:: t = y^\mathsf{T} V^{-1} X (X^\mathsf{T} V^{-1} X)^{-1} X^\mathsf{T} V^{-1} y .

All shapes of a grid are tried, those of the best forms at more places, and then refined.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import solve_triangular

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.distinct_inputs import InputProducts, Inputs, input_names
from frictioncli.diagnosis.empirical.fitted_columns import FittedColumns
from frictioncli.diagnosis.empirical.form_columns import Shape
from frictioncli.diagnosis.empirical.forms import Form, ShapeAxis
from frictioncli.diagnosis.empirical.random_functions import Function
from frictioncli.diagnosis.fit.simplex_search import simplex_minimum
from frictioncli.diagnosis.fit.weighted_fit import Weights
from frictioncli.effects.base import Basis
from frictioncli.model.noise import Noise

_AT_ONCE = 20
"""Shapes whose columns are weighted together: those of more would not fit into a cache."""

_FINER = 4
"""Places of a peak that are tried for each of the grid, once it is among the best forms."""

_LEAST_LEFT = 1e-4
"""Share of the weighted square of a column that base and discrepancy leave, if it counts at all."""

_FREE = 1e-9
"""Precision of a coefficient of a unit column that is not expected to be small."""

Explained = tuple[Mapping[str, float], float]
"""A shape of a form, and what the form explains there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WeightedMisfit:
    """A weighted misfit with the columns of base, causes, discrepancy and forms that are known.

    Attributes
    ----------
    problem : Problem
        The rows.
    weights : (Weights, Weights)
        Weights of friction and load.
    known : ndarray, shape (columns, weighted rows)
        Base, causes, discrepancy and forms, weighted: the inverse of the lower Cholesky factor of
        their inner products with the precision of their coefficients, times the columns.
    misfit : ndarray, shape (weighted rows,)
        What these leave of the weighted misfit.
    """

    problem: Problem
    weights: tuple[Weights, Weights]
    known: Array
    misfit: Array
    _inputs: dict[tuple[str, ...], Inputs | None] = field(
        default_factory=dict, init=False, repr=False
    )
    _input_products: dict[tuple[tuple[str, ...], int], InputProducts] = field(
        default_factory=dict, init=False, repr=False
    )

    @classmethod
    def of(
        cls,
        fitted: FittedColumns,
        noise: tuple[Noise, Noise],
        functions: Sequence[Function],
        misfit: tuple[Array, Array],
    ) -> "WeightedMisfit":
        """Return a misfit with what is known beside it.

        Parameters
        ----------
        fitted : FittedColumns
            Columns of base and causes.
        noise : (Noise, Noise)
            Noise of friction and load.
        functions : sequence of Function
            Random functions of the discrepancy, and forms.
        misfit : (ndarray, ndarray), shape (rows,)
            What base and causes leave of both channels. [N·m]
        """
        problem = fitted.problem
        extra = (problem.temperature_variance, np.zeros(len(problem.layout.time)))
        friction, load = (
            Weights.of(problem.layout, level, known)
            for level, known in zip(noise, extra, strict=True)
        )

        def weighted(both: Array) -> Array:
            upper, lower = np.split(both, 2)
            return np.vstack([friction.weighted(upper), load.weighted(lower)])

        smooth = [one.columns for one in functions if not one.is_form]
        forms = [one.columns for one in functions if one.is_form]
        columns = weighted(np.hstack([fitted.rows, *forms, *smooth]))
        free = columns.shape[1] - sum(one.shape[1] for one in smooth)
        length = np.linalg.norm(columns[:, :free], axis=0)
        columns[:, :free] /= np.where(length > 0, length, 1.0)
        precision = np.ones(columns.shape[1])
        precision[:free] = _FREE
        root = np.linalg.cholesky(columns.T @ columns + np.diag(precision))
        known = np.asarray(solve_triangular(root, columns.T, lower=True))
        own = weighted(np.concatenate(misfit)[:, np.newaxis])[:, 0]
        return cls(
            problem=problem,
            weights=(friction, load),
            known=known,
            misfit=own - known.T @ (known @ own),
        )

    def statistics(self, form: Form, shapes: Sequence[Shape]) -> Array:
        """Return what a form explains at each shape, shape (shapes,).

        Parameters
        ----------
        form : Form
            The form.
        shapes : sequence of mapping of str to float
            Its shapes.
        """
        width = len(form.coefficients)
        right, hidden, whole = self._products(form, shapes)
        if width == 1:
            size = whole[:, 0, 0]
            own = size - np.einsum("ks,ks->s", hidden, hidden)
            shown = own > _LEAST_LEFT * size
            return np.where(shown, right**2 / np.where(shown, own + _FREE * size, 1.0), 0.0)
        found = []
        for number, own in enumerate(whole):
            columns = slice(number * width, (number + 1) * width)
            taken = hidden[:, columns]
            found.append(_statistic(right[columns], own - taken.T @ taken, np.diag(own)))
        return np.array(found)

    def _products(self, form: Form, shapes: Sequence[Shape]) -> tuple[Array, Array, Array]:
        """Return products of a form's columns with the misfit, with what is known, and their own.

        Those of their own are of each shape, shape (shapes, coefficients, coefficients).
        """
        inputs = self._inputs_of(form)
        if inputs is None:
            parts = [form.columns(self.problem.table, one) for one in shapes]
            weighted, rows = self._weighted(parts)
            own = _own_products(weighted, weighted, len(shapes))
            return weighted.T @ self.misfit[rows], self.known[:, rows] @ weighted, own
        parts = [form.columns(inputs.table, one) for one in shapes]
        count = len(shapes) * len(form.coefficients)
        right, hidden = np.zeros(count), np.zeros((len(self.known), count))
        whole = np.zeros((len(shapes), len(form.coefficients), len(form.coefficients)))
        for channel in (0, 1):
            values = np.hstack([one[channel] for one in parts])
            if values.any():
                products = self._products_of(form, inputs, channel)
                right += products.misfit @ values
                hidden += products.known @ values
                whole += _own_products(values, products.own @ values, len(shapes))
        return right, hidden, whole

    def _inputs_of(self, form: Form) -> Inputs | None:
        names = input_names(form)
        if names not in self._inputs:
            self._inputs[names] = Inputs.of(self.problem.table, names)
        return self._inputs[names]

    def _products_of(self, form: Form, inputs: Inputs, channel: int) -> InputProducts:
        key = input_names(form), channel
        if key not in self._input_products:
            weighted = inputs.weighted(self.weights[channel])
            end = len(self.misfit) // 2 * (channel + 1)
            rows = slice(end - len(weighted), end)
            self._input_products[key] = InputProducts.of(
                weighted, self.misfit[rows], self.known[:, rows]
            )
        return self._input_products[key]

    def together(self, forms: Sequence[tuple[Form, Shape]]) -> float:
        """Return what several forms explain together.

        Parameters
        ----------
        forms : sequence of (Form, mapping of str to float)
            The forms with their shapes.
        """
        parts = [form.columns(self.problem.table, shape) for form, shape in forms]
        weighted, rows = self._weighted(parts)
        hidden, whole = self.known[:, rows] @ weighted, weighted.T @ weighted
        left = whole - hidden.T @ hidden
        return _statistic(weighted.T @ self.misfit[rows], left, np.diag(whole))

    def _weighted(self, parts: Sequence[Basis]) -> tuple[Array, slice]:
        """Return weighted columns in the channels in which they show, and the rows of these."""
        upper, lower = (
            weights.weighted(np.hstack([one[channel] for one in parts]))
            if any(one[channel].any() for one in parts)
            else None
            for channel, weights in enumerate(self.weights)
        )
        if lower is None:
            width = sum(one.friction.shape[1] for one in parts)
            weighted = np.zeros((0, width)) if upper is None else upper
            return weighted, slice(0, len(weighted))
        if upper is None:
            return lower, slice(len(self.misfit) - len(lower), None)
        return np.vstack([upper, lower]), slice(None)

    def best_of(self, form: Form, shapes: Sequence[dict[str, float]] | None = None) -> Explained:
        """Return the shape at which a form explains most, and what it explains there.

        Parameters
        ----------
        form : Form
            The form.
        shapes : sequence of dict of str to float, optional
            Shapes to try; those of the form's grid without them.
        """
        shapes = form.shapes() if shapes is None else shapes
        statistics = np.concatenate(
            [
                self.statistics(form, shapes[first : first + _AT_ONCE])
                for first in range(0, len(shapes), _AT_ONCE)
            ]
        )
        number = int(np.argmax(statistics))
        return shapes[number], float(statistics[number])

    def in_place(self, form: Form, found: Explained) -> Explained:
        """Return the best of more places over the whole range, at all widths.

        Beside smooth functions a narrow peak explains something two widths beside its place, too:
        between coarse places that may look best.

        Parameters
        ----------
        form : Form
            The form.
        found : (dict of str to float, float)
            The best shape of its grid.
        """
        axes = {axis.name: axis for axis in form.shape}
        if not {"centre", "width"} <= axes.keys():
            return found
        places = axes["centre"].values
        between = np.linspace(0, len(places) - 1, _FINER * (len(places) - 1) + 1)
        shapes = [
            dict(found[0]) | {"centre": float(centre), "width": width}
            for centre in np.interp(between, np.arange(len(places)), places)
            for width in axes["width"].values
        ]
        return max(found, self.best_of(form, shapes), key=lambda one: one[1])

    def refined(self, form: Form, found: Explained) -> Explained:
        """Return a shape optimised between the values of the grid.

        Parameters
        ----------
        form : Form
            The form.
        found : (dict of str to float, float)
            A shape near the best one.
        """
        axes = [one for one in form.shape if one.name != "order"]
        if not axes:
            return found
        low, high = (
            np.array([_measure(axis, axis.values[end]) for axis in axes]) for end in (0, -1)
        )

        def shape_at(place: Array) -> dict[str, float]:
            values = low + np.clip(place, 0.0, 1.0) * (high - low)
            return dict(found[0]) | {
                axis.name: float(np.exp(value) if axis.logarithmic else value)
                for axis, value in zip(axes, values, strict=True)
            }

        at = np.array([_measure(axis, found[0][axis.name]) for axis in axes])
        start = (at - low) / (high - low)
        step = np.array([0.5 / len(axis.values) for axis in axes])
        place, least = simplex_minimum(
            lambda place: -float(self.statistics(form, [shape_at(place)])[0]),
            start,
            step,
            evaluations=25,
            tolerance=(2e-3, 0.1),
        )
        return max(found, (shape_at(place), -float(least)), key=lambda one: one[1])


def _measure(axis: ShapeAxis, value: float) -> float:
    return float(np.log(value)) if axis.logarithmic else value


def _own_products(left: Array, right: Array, shapes: int) -> Array:
    """Return inner products of the columns of each shape, shape (shapes, columns, columns)."""
    first, second = (one.reshape(len(one), shapes, -1) for one in (left, right))
    return np.einsum("rsa,rsb->sab", first, second)


def _statistic(right: Array, left: Array, size: Array) -> float:
    """Return what columns explain, from their inner products with the misfit and each other."""
    own = np.flatnonzero(np.diag(left) > _LEAST_LEFT * size)
    if not len(own):
        return 0.0
    inner = left[np.ix_(own, own)] + _FREE * np.diag(size[own])
    return float(right[own] @ np.linalg.solve(inner, right[own]))
