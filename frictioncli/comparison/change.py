"""Change of friction in the last run against the earlier runs.

Equation (16) is fitted to all runs together. In addition, each run has an offset, the same at all
speeds, loads and temperatures. The change is the offset of the last run less the mean of the
earlier ones, by generalised least squares: runs at other temperatures or speeds are compared as far
as the fitted parameters allow.

The deviation that a run may have by chance is estimated from the scatter of the earlier runs: the
interval is Student's prediction interval for one more run, wider where the conditions of the last
run determine its offset less precisely. With a single earlier run only the noise within both runs
is known: that of points, pairs and slow drift.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.comparison.noise_averaged_fit import is_estimable, noise_averaged_fit
from frictioncli.distributions import t_quantile
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.document import FrictionModel
from frictioncli.model.equations import COEFFICIENTS, jacobian
from frictioncli.model.identification import freedom, pair_equations, pair_residual
from frictioncli.model.late_torque import without_delay
from frictioncli.model.load_contrast import point_noise
from frictioncli.model.noise import plausible_noise
from frictioncli.model.observations import Observations, observations
from frictioncli.model.zero_load import temperature_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Friction of the last run less the mean of the earlier runs.

    Attributes
    ----------
    estimate : float
        Difference, the same at any speed, load and temperature. [torque unit]
    ci95 : (float, float)
        95 % confidence interval. [torque unit]
    by_run : tuple of float
        Friction of each run less the mean of all runs, in the order of the runs. [torque unit]
    """

    estimate: float
    ci95: tuple[float, float]
    by_run: tuple[float, ...]


def change_of_last_run(torques: pd.DataFrame, model: FrictionModel) -> Change | None:
    """Return the change of friction in the last run against the earlier runs.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the model's joint.
    model : FrictionModel
        Model fitted to all runs.

    Returns
    -------
    Change or None
        None where there is one run only, or the runs share too few conditions.
    """
    known = temperature_of(torques, model.temperature).notna()
    rows = without_delay(torques[known] if known.any() else torques, model.late_by)
    # observations() orders the runs by their plain names
    runs = sorted(rows["run"].unique())
    if len(runs) < 2:
        return None
    in_order = [runs.index(name) for name in runs_in_order(rows)]
    last = in_order[-1]
    observed = observations(rows, model.temperature)
    design = _design(observed, model)
    earlier = np.delete(np.arange(len(runs)), last)
    contrast = np.full(len(runs), -1.0 / len(earlier))
    contrast[last] = 1.0
    # the design has columns of length 1
    length = np.sqrt(np.bincount(observed.run))
    contrasts = np.zeros((1, design.shape[1]))
    contrasts[0, : len(runs)] = contrast / length
    if not is_estimable(design, contrasts):
        return None
    residual = pair_residual(observed, model.friction)
    noises = plausible_noise(
        residual=residual,
        design=design,
        time=observed.time,
        run=observed.run,
        bins=observed.bins,
        point=point_noise(observed, model.friction.alpha),
    )
    offsets, covariance = noise_averaged_fit(
        design,
        residual,
        noises,
        time=observed.time,
        run=observed.run,
        bins=observed.bins,
        count=len(runs),
    )
    offsets, covariance = offsets / length, covariance / np.outer(length, length)
    degrees = freedom(observed, noises[0][0], design.shape[1])
    estimate = float(contrast @ offsets)
    variance = float(contrast @ covariance @ contrast)
    if len(earlier) > 1:
        own = covariance[np.ix_(earlier, earlier)]
        variance = _prediction_variance(offsets[earlier], own, variance)
        degrees = len(earlier) - 1
    half_width = float(t_quantile(0.975, degrees) * np.sqrt(variance))
    levels = (offsets - offsets.mean())[in_order]
    return Change(
        estimate=estimate,
        ci95=(estimate - half_width, estimate + half_width),
        by_run=tuple(levels.tolist()),
    )


def _design(observed: Observations, model: FrictionModel) -> Array:
    """Return one column per run and the derivatives by the fitted parameters without tau_c.

    The common part of all offsets is tau_c.
    """
    terms = tuple(name for name in COEFFICIENTS if model.parameters[name].ci95 is not None)
    shape = jacobian(pair_equations(observed), terms, model.friction)
    if "tau_c" in terms:
        shape = np.delete(shape, terms.index("tau_c"), axis=1)
    run = (observed.run[:, np.newaxis] == np.unique(observed.run)).astype(float)
    design = np.column_stack([run, shape])
    return np.asarray(design / np.maximum(np.linalg.norm(design, axis=0), 1e-300))


def _prediction_variance(offsets: Array, covariance: Array, noise: float) -> float:
    """Return the variance of one more run about the mean of the earlier ones [(N·m)²].

    Parameters
    ----------
    offsets : ndarray, shape (runs,)
        Offsets of the earlier runs, two or more. [N·m]
    covariance : ndarray, shape (runs, runs)
        Covariance of the offsets by noise within the runs. [(N·m)²]
    noise : float
        Variance of the difference by noise within the runs. [(N·m)²]
    """
    count = len(offsets)
    factor = 1 + 1 / count
    observed = float(np.var(offsets, ddof=1))
    expected = (float(np.trace(covariance)) - float(covariance.sum()) / count) / (count - 1)
    # the conditions of the last run may determine its offset less precisely than the earlier ones
    return factor * observed * max(1.0, noise / (factor * expected))
