"""How far the friction of the last run is from that of the runs before.

Equation (16) is fitted to all runs at once. About that fit, each run gets an offset of its own, the
same at all speeds, loads and temperatures. The change is the offset of the last run less the mean
of the earlier ones, by generalised least squares: runs over other temperatures or speeds are
compared as far as the fitted parameters allow.

How far a run can be off by chance, the earlier runs tell by how they differ among themselves: the
interval is Student's for one more run of the same kind, wider where the last one was measured under
conditions that tell its offset less well. With a single earlier run only the noise within the two
is known, of points, pairs and slow drift.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from frictioncli.arrays import Array
from frictioncli.comparison.noise_averaged_fit import averaged_fit, estimable
from frictioncli.logs.runs.discovery import natural_key
from frictioncli.model.document import FrictionModel
from frictioncli.model.equations import COEFFICIENTS, jacobian
from frictioncli.model.identification import freedom, pair_equations, pair_residual, point_noise
from frictioncli.model.noise import plausible_noise
from frictioncli.model.observations import Observations, observations
from frictioncli.model.zero_load import temperature_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """The friction of the last run less the mean of the runs before.

    Attributes
    ----------
    estimate : float
        The difference, at any speed, load and temperature. [torque unit]
    ci95 : (float, float)
        Its 95 % confidence interval. [torque unit]
    """

    estimate: float
    ci95: tuple[float, float]


def change_of_last_run(torques: pd.DataFrame, model: FrictionModel) -> Change | None:
    """Return how far the last run is from the runs before; none where that cannot be told.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the model's joint.
    model : FrictionModel
        Fitted to all runs.
    """
    known = temperature_of(torques, model.temperature).notna()
    rows = torques[known] if known.any() else torques
    # observations() orders the runs by their plain names
    runs = sorted(rows["run"].unique())
    if len(runs) < 2:
        return None
    last = max(range(len(runs)), key=lambda number: natural_key(runs[number]))
    observed = observations(rows, model.temperature)
    design = _design(observed, model)
    earlier = np.delete(np.arange(len(runs)), last)
    contrast = np.full(len(runs), -1.0 / len(earlier))
    contrast[last] = 1.0
    # columns of the design have length 1
    size = np.sqrt(np.bincount(observed.run))
    asked = np.zeros((1, design.shape[1]))
    asked[0, : len(runs)] = contrast / size
    if not estimable(design, asked):
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
    offsets, covariance = averaged_fit(
        design,
        residual,
        noises,
        time=observed.time,
        run=observed.run,
        bins=observed.bins,
        count=len(runs),
    )
    offsets, covariance = offsets / size, covariance / np.outer(size, size)
    steps = freedom(observed, noises[0][0], design.shape[1])
    estimate = float(contrast @ offsets)
    variance = float(contrast @ covariance @ contrast)
    if len(earlier) > 1:
        own = covariance[np.ix_(earlier, earlier)]
        variance = _variance_of_one_more(offsets[earlier], own, variance)
        steps = len(earlier) - 1
    reach = float(stats.t.ppf(0.975, steps) * np.sqrt(variance))
    return Change(estimate=estimate, ci95=(estimate - reach, estimate + reach))


def _design(observed: Observations, model: FrictionModel) -> Array:
    """Return one column per run, and the derivatives by the fitted parameters but tau_c.

    Only differences between runs have a meaning: what they have in common is tau_c.
    """
    terms = tuple(name for name in COEFFICIENTS if model.parameters[name].ci95 is not None)
    shape = jacobian(pair_equations(observed), terms, model.friction)
    if "tau_c" in terms:
        shape = np.delete(shape, terms.index("tau_c"), axis=1)
    run = (observed.run[:, np.newaxis] == np.unique(observed.run)).astype(float)
    design = np.column_stack([run, shape])
    return np.asarray(design / np.maximum(np.linalg.norm(design, axis=0), 1e-300))


def _variance_of_one_more(offsets: Array, covariance: Array, noise: float) -> float:
    """Return the variance of one more run about the mean of some, as these differ. [(N·m)²].

    Parameters
    ----------
    offsets : ndarray, shape (runs,)
        Offsets of two runs or more. [N·m]
    covariance : ndarray, shape (runs, runs)
        Of the offsets, by noise within the runs. [(N·m)²]
    noise : float
        Variance of the difference by noise within the runs. [(N·m)²]
    """
    count = len(offsets)
    share = 1 + 1 / count
    seen = float(np.var(offsets, ddof=1))
    explained = (float(np.trace(covariance)) - float(covariance.sum()) / count) / (count - 1)
    # a run under other conditions may tell its offset less well than the earlier ones do theirs
    return share * seen * max(1.0, noise / (share * explained))
