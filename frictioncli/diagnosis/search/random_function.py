r"""One more random function beside base, accepted effects and what else is there.

The torque gets

.. math:: f = \omega \sum_k s_k \gamma_k c_k , \quad \gamma_k \sim N(0, 1) ,

with given columns :math:`c_k` and the amplitude :math:`\omega` that is likeliest.
"""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.added_function import likely_amplitudes
from frictioncli.diagnosis.fit.columns import reduced
from frictioncli.diagnosis.fit.left_by_base import products_left_by, span_of
from frictioncli.diagnosis.fit.mixed_model import Components, MixedFit, evaluate
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import Part
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.search.realised_size import realised
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import CHANNELS, Basis, Channel

_ROUNDED = 1e-9
"""Share of its squares below which what the base leaves of a function is rounding."""


@dataclass(frozen=True, slots=True)
class RandomFunction:
    """A random function that was judged beside others.

    Attributes
    ----------
    statistic : float
        Twice the log likelihood ratio to the model without it.
    size : float
        RMS of what base and accepted effects leave of it. [N·m]
    interval : (float, float)
        95 % interval of that. [N·m]
    """

    statistic: float
    size: float
    interval: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """What a random function is judged beside.

    Attributes
    ----------
    step : Step
        Base and accepted effects.
    span : ndarray, shape (2 * rows, rank)
        Orthonormal basis of base, measurement and accepted effects.
    components : Components
        Variance components, those of functions beside the accepted effects among them.
    products : Products
        Inner products of all columns; the misfit is the last.
    fits : tuple of MixedFit
        The fit, and others from which a fit with one function more starts.
    """

    step: Step
    span: Array
    components: Components
    products: Products
    fits: tuple[MixedFit, ...]

    @classmethod
    def of(cls, step: Step, expected: Components) -> "Known":
        """Return base and accepted effects alone.

        Parameters
        ----------
        step : Step
            Base and accepted effects.
        expected : Components
            Their variance components.
        """
        known = step.precomputed.start
        starts = replace(step.fit.variances, amplitude=known.amplitude), known
        null = fit_variances(expected, step.products, step.known, *starts)
        quiet = evaluate(expected, step.products, step.known, known)
        accepted = [step.problem.basis(one.effect, one.shape) for one in step.accepted]
        return cls(
            step=step,
            span=span_of(step.problem, [*step.precomputed.measurement, *accepted]),
            components=expected,
            products=step.products,
            fits=(null, quiet),
        )

    @property
    def count(self) -> int:
        """Number of columns."""
        return self.products.columns.count - 1

    def with_any_drift(self, channel: Channel) -> "Known":
        """Return it with a drift of a channel that may be of any size.

        Parameters
        ----------
        channel : {"friction", "load"}
            The channel.
        """
        components = self.components.with_most_drift(CHANNELS.index(channel), np.inf)
        fit = fit_variances(components, self.products, self.count, self.fits[0].variances)
        return replace(self, components=components, fits=(fit,))

    def beside(self, channel: Channel, columns: Array) -> "Known | None":
        """Return it with one more function; None where it leaves nothing of the columns.

        Parameters
        ----------
        channel : {"friction", "load"}
            The channel of the function.
        columns : ndarray, shape (rows, columns)
            Its columns.
        """
        left = self._left(channel, columns)
        return None if left is None else self._with(channel, columns, left)

    def judged(self, channel: Channel, columns: Array) -> RandomFunction | None:
        """Return a function as it is beside the others; None where they leave nothing of it.

        Parameters
        ----------
        channel, columns
            As of :meth:`beside`.
        """
        left = self._left(channel, columns)
        if left is None:
            return None
        (fit,) = self._with(channel, columns, left).fits
        place = slice(self.count, self.count + columns.shape[1])
        size, interval = realised(
            left / np.trace(left),
            fit.coefficients[place],
            fit.covariance_of(place),
        )
        return RandomFunction(self.fits[0].objective - fit.objective, size, interval)

    def _left(self, channel: Channel, columns: Array) -> Array | None:
        """Return inner products of what the span leaves of columns; None where that is nothing."""
        left = products_left_by(self.span, _basis(channel, columns))
        is_rounding = np.trace(left) <= _ROUNDED * float(np.sum(np.square(columns)))
        return None if is_rounding else left

    def _with(self, channel: Channel, columns: Array, left: Array) -> "Known":
        """Return it with one more function, with the noise that suits it best."""
        step = self.step
        scale = float(np.sqrt(len(columns) / np.trace(left)))
        both = reduced(step.problem.layout, *_basis(channel, scale * columns))
        products = self.products.beside([Part(both, step.precomputed.noises)])
        place = slice(self.count, self.count + columns.shape[1])
        prior = self.components.prior
        amplitude = float(prior[0]) if len(prior) else _unit_amplitude(step)
        components = self.components.beside_function(place, amplitude)
        likely = likely_amplitudes(components, products, self.fits)
        starts = (
            replace(one.variances, amplitude=np.append(one.variances.amplitude, own))
            for one, own in zip(self.fits, likely, strict=True)
        )
        fit = fit_variances(components, products, place.stop, *starts)
        return replace(self, components=components, products=products, fits=(fit,))


def _basis(channel: Channel, columns: Array) -> Basis:
    zeros = np.zeros_like(columns)
    return Basis(columns, zeros) if channel == "friction" else Basis(zeros, columns)


def _unit_amplitude(step: Step) -> float:
    """Return the logarithm of the noise of a pair, where no discrepancy is expected."""
    return float(np.log(step.precomputed.start.between[0]) / 2)
