"""What is computed once for all steps of a search: columns, noise models and inner products."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.base_products import BaseProducts
from frictioncli.diagnosis.fit.columns import (
    RANK,
    ModelColumns,
    base_columns,
    basis_columns,
    joined,
    misfit_column,
    residual_of_base,
)
from frictioncli.diagnosis.fit.left_by_base import span_of
from frictioncli.diagnosis.fit.mixed_model import (
    LEAST_VARIANCE,
    Components,
    MixedFit,
    Variances,
)
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import NoiseModels, Part, TransformedColumns
from frictioncli.diagnosis.noise.discrepancy import SHARE, SPREAD, Discrepancy, discrepancy_of
from frictioncli.diagnosis.noise.spectra import STRENGTHS, Spectra, spectra_of
from frictioncli.effects.base import Basis, Effect
from frictioncli.linear_algebra import least_squares_residual
from frictioncli.model.noise import Noise

_LEAST_NOISE = 1e-9
"""Least standard deviation, so that torques without noise can be weighted. [N·m]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Precomputed:
    """Data of one joint with the columns that every hypothesis has, and the noise models.

    Attributes
    ----------
    problem : Problem
        The rows with the base model.
    measurement : tuple of Basis
        Columns of the measurement effects that stand beside the base.
    span, span_of_base : ndarray, shape (2 * rows, rank)
        Orthonormal basis of the base with these columns, and of the base alone.
    base : ModelColumns
        Columns of the base model and of these.
    discrepancy : Discrepancy
        Random functions beside the base.
    products : Products
        Inner products of the columns of base and discrepancy, and of the misfit, which is the last.
    point : (float, float)
        Standard deviation of an angle bin about its pair in friction and load. [N·m]
    start : Variances
        Variance components before anything is fitted.
    components : Components
        What the variance components belong to.
    left : dict
        Products of what the base leaves of effects, by effect and shape, once they are known.
    fitted : dict
        Products and fit beside accepted effects, by effect, shape and free coefficients of each,
        once they are known.
    """

    problem: Problem
    measurement: tuple[Basis, ...]
    span: Array
    span_of_base: Array
    base: ModelColumns
    discrepancy: Discrepancy
    products: Products
    point: tuple[float, float]
    start: Variances
    components: Components
    left: dict[tuple[object, ...], tuple[Effect, Array, Array]] = field(
        default_factory=dict, init=False, repr=False
    )
    fitted: dict[tuple[object, ...], tuple[tuple[Effect, ...], Products, MixedFit]] = field(
        default_factory=dict, init=False, repr=False
    )

    @classmethod
    def of(
        cls,
        problem: Problem,
        measurement: Sequence[Effect] = (),
        discrepancy: float = SHARE,
        before: "Precomputed | None" = None,
        spectra: Sequence[Spectra] = (),
    ) -> "Precomputed":
        """Return the columns and noise models of a problem.

        Parameters
        ----------
        problem : Problem
            The rows with the base model.
        measurement : sequence of Effect
            Effects of the measurement that stand beside the base.
        discrepancy : float, optional
            RMS of the discrepancy that is expected, relative to the mean friction; 0 for none.
        before : Precomputed, optional
            The same of other effects of the measurement, for what does not depend on these.
        spectra : sequence of Spectra, optional
            Spectra of the same pairs, so that none is worked out twice.
        """
        layout = problem.layout
        bases = [problem.basis(one, {}) for one in measurement]
        base = joined([base_columns(problem), *(basis_columns(problem, one) for one in bases)])
        misfit = misfit_column(problem)
        point = point_noise(problem, bases)
        noises = _noise_models(problem, base, misfit, point, spectra)
        span_of_base = span_of(problem) if before is None else before.span_of_base
        if before is None:
            smooth = discrepancy_of(problem, span_of_base, discrepancy)
        else:
            smooth = before.discrepancy
        expected = np.full(len(smooth.components), np.log(max(smooth.amplitude, _LEAST_NOISE)))
        span = span_of(problem, bases) if bases else span_of_base
        functions = [
            Part(smooth.columns.take(place), noises, (channel,))
            for channel, place in enumerate(smooth.places)
        ]
        columns = TransformedColumns((Part(base, noises), *functions, Part(misfit, noises)))
        quiet = [
            max(one.white, deviation**2 * 1e-6, LEAST_VARIANCE)
            for one, deviation in zip(noises.spectra, point, strict=True)
        ]
        products = Products.of(columns)
        return cls(
            problem=problem,
            measurement=tuple(bases),
            span=span,
            span_of_base=span_of_base,
            base=base,
            discrepancy=smooth,
            products=products,
            point=point,
            start=Variances(
                noise=(0, 0),
                within=(point[0] ** 2, point[1] ** 2),
                between=(quiet[0], quiet[1]),
                amplitude=expected,
            ),
            components=Components(
                base=base.count,
                functions=tuple(
                    slice(base.count + one.columns.start, base.count + one.columns.stop)
                    for one in smooth.components
                ),
                widths=smooth.widths,
                prior=expected,
                spread=np.full(len(expected), SPREAD),
                least=expected,
                within=(layout.within_freedom,) * 2,
                pairs=len(layout.time),
                determinants=(noises.determinants(0), noises.determinants(1)),
                drifts=(noises.drifts(0), noises.drifts(1)),
                bases=BaseProducts.of_part(columns.parts[0], base.count),
            ),
        )

    @property
    def columns(self) -> TransformedColumns:
        """Base, discrepancy and the misfit, which is the last."""
        return self.products.columns

    @property
    def noises(self) -> NoiseModels:
        """Noise models of the pair means."""
        return self.columns.noises

    def noise(self, variances: Variances) -> tuple[Noise, Noise]:
        """Return the noise of friction and load of variance components.

        Parameters
        ----------
        variances : Variances
            The variance components.
        """
        found = []
        for channel, spectra in enumerate(self.noises.spectra):
            time, strength = self.noises.indices[variances.noise[channel]]
            scale = variances.between[channel]
            found.append(
                Noise(
                    point=float(np.sqrt(variances.within[channel])),
                    pair=float(np.sqrt(max(scale - spectra.known, 0.0))),
                    drift=float(np.sqrt(scale * STRENGTHS[strength])),
                    drift_time=spectra.spectra[time].time,
                )
            )
        return found[0], found[1]


def _noise_models(
    problem: Problem,
    base: ModelColumns,
    misfit: ModelColumns,
    point: tuple[float, float],
    spectra: Sequence[Spectra],
) -> NoiseModels:
    """Return the noise models of the pair means of both channels."""
    extra = (problem.temperature_variance, np.zeros_like(problem.layout.time))
    friction, load = (
        spectra_of(
            problem.layout,
            deviation,
            known,
            least_squares_residual(columns.means, one.means[:, 0], tolerance=RANK),
            spectra,
        )
        for deviation, known, columns, one in zip(
            point, extra, base.channels, misfit.channels, strict=True
        )
    )
    indices = tuple(
        (time, strength)
        for time in range(len(friction.spectra))
        for strength in range(0 if time == 0 else 1, len(STRENGTHS))
    )
    return NoiseModels((friction, load), indices)


def point_noise(problem: Problem, beside: Sequence[Basis] = ()) -> tuple[float, float]:
    """Return the standard deviation of an angle bin about its pair in friction and load [N·m].

    From pure error, the scatter of neighbouring pairs at one speed about their common course; from
    the residual of the base where too few pairs can be compared.

    Parameters
    ----------
    problem : Problem
        The rows.
    beside : sequence of Basis
        Columns fitted beside the base.
    """
    measured = np.column_stack([problem.friction, problem.load])
    pure = problem.layout.pure_deviation(measured, problem.table.position)
    if pure is None:
        friction = residual_of_base(problem, problem.friction_misfit, "friction", beside)
        load = residual_of_base(problem, problem.load_misfit, "load", beside)
        pure = np.array([problem.layout.point_deviation(one) for one in (friction, load)])
    return max(float(pure[0]), _LEAST_NOISE), max(float(pure[1]), _LEAST_NOISE)
