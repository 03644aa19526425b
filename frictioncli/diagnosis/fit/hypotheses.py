"""Candidate explanations of the misfit, the result of testing one, and an effect that is fitted."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.gravity import NAMES
from frictioncli.diagnosis.data.load_levels import two_level_history
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import ModelColumns, joined, main_channel, reduced
from frictioncli.diagnosis.fit.mixed_model import Variances
from frictioncli.diagnosis.noise.significance import NullDistribution
from frictioncli.effects.base import Effect
from frictioncli.effects.history import distinct
from frictioncli.effects.pair_series import measured_share
from frictioncli.quantities import TORQUE

_USUAL_FRICTION = 20.0
"""Mean friction torque up to which the catalogue's bounds in units of torque hold; the bounds of a
joint with more friction grow in proportion. [N·m]"""

_USUAL_LOAD = 40.0
"""Greatest load torque from which on those bounds hold for coefficients of its square; those of a
joint with less load grow with its square. [N·m]"""

_AT_ONCE = 8
"""Shapes whose rows are reduced together: those of more would not fit into a processor's cache."""

_CANCELLED = 0.1
"""Share of the greatest load that an offset and a constant that the gear carries may cancel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """A candidate explanation of the misfit: columns, perhaps over a grid of shape parameters.

    Attributes
    ----------
    name : str
        Its name.
    shapes : tuple of dict
        Shape parameters of each group of columns.
    width : int
        Columns of each group.
    columns : ModelColumns
        The groups side by side, ``len(shapes) * width`` columns.
    rms : ndarray, shape (shapes, width)
        RMS of each column in the channel where the hypothesis shows most. [N·m]
    lower, upper : ndarray, shape (width,)
        Physical bounds of the coefficients.
    """

    name: str
    shapes: tuple[dict[str, float], ...]
    width: int
    columns: ModelColumns
    rms: Array
    lower: Array
    upper: Array


def hypothesis_of(
    effect: Effect, problem: Problem, shapes: Sequence[dict[str, float]] | None = None
) -> Hypothesis:
    """Return an effect as a hypothesis over its grid of shapes, or over given ones.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    problem : Problem
        The rows on which its columns are evaluated.
    shapes : sequence of dict, optional
        Shape parameters to try instead of the grid.
    """
    tried = informative_shapes(effect, problem) if shapes is None else list(shapes)
    bases = [problem.basis(effect, shape) for shape in tried]
    rms = [_rms(main_channel(basis, effect)) for basis in bases]
    parts = [bases[first : first + _AT_ONCE] for first in range(0, len(bases), _AT_ONCE)]
    columns = joined(
        [reduced(problem.layout, *map(_beside, zip(*part, strict=True))) for part in parts]
    )
    lower, upper = physical_bounds(effect, problem)
    return Hypothesis(
        name=effect.name,
        shapes=tuple(tried),
        width=len(effect.coefficients),
        columns=columns,
        rms=np.array(rms),
        lower=lower,
        upper=upper,
    )


def _rms(columns: Array) -> Array:
    """Return the RMS of each column, shape (columns,)."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->j", columns, columns) / len(columns)))


def _beside(columns: Sequence[Array]) -> Array:
    """Return columns beside each other; those of a single shape are not copied."""
    return columns[0] if len(columns) == 1 else np.hstack(columns)


def physical_bounds(effect: Effect, problem: Problem) -> tuple[Array, Array]:
    """Return the bounds of an effect's coefficients on a joint, shape (coefficients,) each.

    A constant that does not load the gear is a part of the constant of gravity, or beyond it by a
    tenth of the greatest load: the offset of a sensor and a constant that is carried may cancel
    each other. Without that bound it would stand for any friction that grows with the load.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    problem : Problem
        The joint's rows: bounds in units of torque grow with its friction, and those of the square
        of the load where that is small.
    """
    factor = max(float(np.mean(np.abs(problem.friction))) / _USUAL_FRICTION, 1.0)
    factors = np.array([factor if TORQUE in one.unit else 1.0 for one in effect.coefficients])
    load = float(np.max(np.abs(problem.table.load), initial=0.0))
    of_square = np.array([one.of_square_load for one in effect.coefficients])
    factors = np.where(of_square, factors * max(_USUAL_LOAD / max(load, 1e-9), 1.0) ** 2, factors)
    lower = np.array([parameter.lower for parameter in effect.coefficients])
    upper = np.array([parameter.upper for parameter in effect.coefficients])
    of_load = effect.measurement & np.array([one.of_load for one in effect.coefficients])
    low, high = _of_constant(problem)
    return (
        np.maximum(lower * factors, np.where(of_load, low, -np.inf)),
        np.minimum(upper * factors, np.where(of_load, high, np.inf)),
    )


def _of_constant(problem: Problem) -> tuple[float, float]:
    """Return how much of the constant of gravity may not load the gear, at least and at most."""
    constant = float(problem.gravity[NAMES.index("offset")])
    beyond = _CANCELLED * float(np.max(np.abs(problem.table.load), initial=0.0))
    return min(constant, 0.0) - beyond, max(constant, 0.0) + beyond


def informative_shapes(effect: Effect, problem: Problem) -> list[dict[str, float]]:
    """Return the shapes to try first; of histories those that differ in the problem's runs.

    Those of a load have the history besides that the load of the pairs suggests.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    problem : Problem
        The joint's rows.
    """
    tried = effect.shapes(problem.all_runs)
    if effect.moments is None:
        return tried
    share = measured_share(problem.all_runs)[problem.rows]
    levels = two_level_history(problem) if effect.channel == "load" else None
    return distinct([*([levels] if levels else []), *tried], share) or tried[:1]


@dataclass(frozen=True, slots=True)
class EffectFit:
    """An effect fitted beside the base.

    Attributes
    ----------
    effect : Effect
        The effect.
    shape : dict of str to float
        Shape parameters.
    coefficients : ndarray, shape (coefficients,)
        Its coefficients, the base refitted.
    covariance : ndarray, shape (coefficients, coefficients)
        Their covariance for this shape.
    statistic : float
        Twice the log likelihood ratio to the base alone.
    variances : Variances or None
        Variances of noise and discrepancy with the effect in place; None where they were not
        estimated.
    """

    effect: Effect
    shape: dict[str, float]
    coefficients: Array
    covariance: Array
    statistic: float
    variances: Variances | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class HypothesisTest:
    """Result of testing one hypothesis against the null hypothesis, base and accepted effects.

    Attributes
    ----------
    name : str
        Name of the hypothesis.
    shape : dict of str to float
        Shape at which it explains most.
    coefficients, covariance : ndarray, shape (width,) and (width, width)
        Its coefficients there.
    statistic : float
        Twice the log likelihood ratio to the null hypothesis there; 0 if no shape is physical.
    p_value : float
        Probability that noise explains as much, corrected for shapes and for the number of
        hypotheses (Bonferroni).
    log_bayes_factor : float
        Logarithm of its Bayes factor, averaged over shapes.
    freedom : int
        Number of coefficients that the data determine.
    null : NullDistribution
        Distribution of the statistic under the null hypothesis, searched over all shapes.
    size_scale : float
        RMS in its channel per unit of whitened length. [N·m]
    left_share : float
        Share of its RMS that the base leaves.
    variances : Variances or None
        Variances of noise and discrepancy with the hypothesis in place.
    """

    name: str
    shape: dict[str, float]
    coefficients: Array
    covariance: Array
    statistic: float
    p_value: float
    log_bayes_factor: float
    freedom: int
    null: NullDistribution
    size_scale: float
    left_share: float = 1.0
    variances: Variances | None = None

    def effect_fit(self, effect: Effect) -> EffectFit:
        """Return the fit of an effect that the hypothesis stands for."""
        return EffectFit(
            effect,
            self.shape,
            self.coefficients,
            self.covariance,
            self.statistic,
            self.variances,
        )

    def refined_log_bayes_factor(self, fit: EffectFit) -> float:
        """Return the log Bayes factor after the shape has been refined off the grid.

        Parameters
        ----------
        fit : EffectFit
            The effect at its refined shape.
        """
        return self.log_bayes_factor + max(fit.statistic - self.statistic, 0.0) / 2


def free_coefficients(fit: EffectFit) -> Indices:
    """Return which coefficients of an effect are estimated: those that no bound sets to zero."""
    free = np.flatnonzero(fit.coefficients)
    return free if len(free) else np.arange(len(fit.coefficients))
