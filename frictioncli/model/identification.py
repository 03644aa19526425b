r"""Identification of equation (16) by weighted least squares on all pairs.

Each pair has the weight of its own noise, whatever its number of angle bins. The covariance of the
estimates accounts for the noise that pairs share and for slow drift
(:mod:`frictioncli.model.noise`) by the sandwich

.. math:: (X^\mathsf{T} X)^{+} X^\mathsf{T} C X (X^\mathsf{T} X)^{+}

with the weighted derivatives *X* and the covariance *C* of the weighted noise, so that the
confidence intervals hold when the experiment is repeated. With several runs that is on other days:
*C* then holds by how much the coefficients differ between runs
(:mod:`frictioncli.model.run_differences`).
"""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.distributions import t_quantile
from frictioncli.model.drift import run_starts
from frictioncli.model.equations import Equations, jacobian
from frictioncli.model.friction import FrictionParameters, friction_torque
from frictioncli.model.load_contrast import (
    contrast_by_run,
    contrast_inflation,
    load_coefficient,
    load_difference,
    point_noise,
)
from frictioncli.model.noise import Noise, pair_covariance
from frictioncli.model.observations import Observations
from frictioncli.model.run_differences import FIRST_SHARE, noise_and_differences
from frictioncli.model.variable_projection import minimise

_ROUNDS = 2
"""Rounds of fit and noise estimate; the weights hardly change after the first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A fit of some of the parameters of equation (16).

    Attributes
    ----------
    parameters : FrictionParameters
        Estimates; parameters that were not fitted are zero.
    names : tuple of str
        The parameters that were fitted, in the order of ``covariance``.
    covariance : ndarray, shape (names, names)
        Covariance of the estimates under the estimated noise and differences between runs.
    within : ndarray, shape (names, names)
        The same if other runs had the coefficients of these: what the noise alone does.
    freedom : float
        Degrees of freedom of that noise estimate.
    noise : Noise
        The noise of the measurements.
    residual : ndarray, shape (pairs,)
        Mean residual of each pair. [N·m]
    rmse : float
        Root mean square of the residuals over all angle bins. [N·m]
    """

    parameters: FrictionParameters
    names: tuple[str, ...]
    covariance: Array
    within: Array
    freedom: float
    noise: Noise
    residual: Array
    rmse: float

    def interval(self, name: str) -> tuple[float, float]:
        """Return the 95 % confidence interval of a fitted parameter."""
        return self._interval(name, self.covariance)

    def interval_within(self, name: str) -> tuple[float, float]:
        """Return the 95 % confidence interval of a fitted parameter for these runs only."""
        return self._interval(name, self.within)

    def _interval(self, name: str, covariance: Array) -> tuple[float, float]:
        index = self.names.index(name)
        half_width = t_quantile(0.975, self.freedom) * np.sqrt(covariance[index, index])
        centre = getattr(self.parameters, name)
        return float(centre - half_width), float(centre + half_width)


def fit_terms(observed: Observations, terms: tuple[str, ...]) -> Estimate:
    """Fit the chosen terms of equation (16) to all pairs jointly.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    terms : tuple of str
        Those of :data:`frictioncli.model.equations.COEFFICIENTS` to fit.
    """
    names = (*terms, "delta") if "gamma" in terms else terms
    noise, shares = _first_noise(observed, terms), np.full(len(terms), FIRST_SHARE)
    for _ in range(_ROUNDS):
        equations = weighted_equations(observed, noise)
        parameters = minimise(equations, terms)
        residual = pair_residual(observed, parameters)
        plausible, shares = noise_of_pairs(observed, terms, parameters, shares)
        noise = plausible[0][0]
    covariance, within_runs = _covariances(observed, terms, parameters, plausible, shares)
    within = observed.friction_within - parameters.alpha * observed.squared_load_within
    rows = len(within)
    squares = np.sum(observed.bins * np.square(residual)) + within @ within
    return Estimate(
        parameters=parameters,
        names=names,
        covariance=covariance,
        within=within_runs,
        freedom=freedom(observed, noise, len(names)),
        noise=noise,
        residual=residual,
        rmse=float(np.sqrt(squares / rows)),
    )


def with_error_of(
    estimate: Estimate,
    observed: Observations,
    terms: tuple[str, ...],
    column: Observations,
    error: float,
) -> Estimate:
    """Return an estimate whose covariance allows for an error of what was taken off friction.

    Parameters
    ----------
    estimate : Estimate
        The fit.
    observed : Observations
        Friction of one joint, with the correction.
    terms : tuple of str
        Coefficients that were fitted.
    column : Observations
        The correction per unit, in place of the friction.
    error : float
        Standard error of its factor.
    """
    weighted = jacobian(weighted_equations(observed, estimate.noise), terms, estimate.parameters)
    moved = weighted_equations(column, estimate.noise).friction
    size = np.linalg.norm(weighted, axis=0)
    size = np.where(size > 0, size, 1.0)
    change = error * (np.linalg.lstsq(weighted / size, moved, rcond=1e-10)[0] / size)
    added = np.outer(change, change)
    return replace(estimate, covariance=estimate.covariance + added, within=estimate.within + added)


def noise_of_pairs(
    observed: Observations, terms: tuple[str, ...], parameters: FrictionParameters, shares: Array
) -> tuple[list[tuple[Noise, float]], Array]:
    """Return noises of the pairs, and by how much coefficients differ between runs.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    terms : tuple of str
        Coefficients that were fitted.
    parameters : FrictionParameters
        The fit.
    shares : ndarray, shape (terms,)
        By how much they are assumed to differ while the noise is found. [-]

    Returns
    -------
    noises : list of (Noise, float)
        Noises with their probabilities, the most probable first.
    shares : ndarray, shape (terms,)
        Root mean squares of the standard deviations between runs, as shares of the coefficients.
    """
    equations = pair_equations(observed)
    design = jacobian(equations, terms, parameters)
    coefficients = np.array([getattr(parameters, term) for term in terms])
    # the load is nearly the same in all pairs: only within them does it tell alpha
    told = np.array([term != "alpha" for term in terms])
    found = np.zeros(len(terms))
    noises, found[told] = noise_and_differences(
        (design[:, : len(terms)] * coefficients).T[told],
        shares[told],
        residual=pair_residual(observed, parameters),
        design=design,
        time=observed.time,
        run=observed.run,
        bins=observed.bins,
        point=point_noise(observed, parameters.alpha),
    )
    found[~told] = load_difference(observed, parameters.alpha)
    return noises, found


def pair_residual(observed: Observations, parameters: FrictionParameters) -> Array:
    """Return measured minus modelled mean friction torque of each pair, shape (pairs,) [N·m]."""
    modelled = friction_torque(
        parameters,
        load=np.sqrt(observed.squared_load),
        speed=observed.speed,
        temperature=_finite(observed.temperature),
    )
    return observed.friction - modelled


def pair_equations(observed: Observations) -> Equations:
    """Return one unweighted equation per pair."""
    return Equations(
        constant=np.ones_like(observed.friction),
        squared_load=observed.squared_load,
        root_speed=np.sqrt(observed.speed),
        temperature=_finite(observed.temperature),
        friction=observed.friction,
    )


def weighted_equations(observed: Observations, noise: Noise) -> Equations:
    """Return one weighted equation per pair, and one for the load term within all pairs.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    noise : Noise
        Noise that sets the weights. [N·m]
    """
    deviation = np.sqrt(noise.pair**2 + noise.drift**2 + noise.point**2 / observed.bins)
    pairs = pair_equations(observed)
    contrast = np.sqrt(observed.load_contrast)
    slope = 0.0
    if contrast > 0:
        slope = float(observed.squared_load_within @ observed.friction_within) / contrast

    def rows(between: Array, within: float) -> Array:
        return np.append(between / deviation, within / noise.point)

    return Equations(
        constant=rows(pairs.constant, 0.0),
        squared_load=rows(pairs.squared_load, contrast),
        root_speed=rows(pairs.root_speed, 0.0),
        temperature=np.append(pairs.temperature, 0.0),
        friction=rows(pairs.friction, slope),
    )


def _finite(temperature: Array) -> Array:
    """Return temperatures with 0 where unknown: gamma is then not fitted."""
    return np.nan_to_num(temperature, nan=0.0)


def _first_noise(observed: Observations, terms: tuple[str, ...]) -> Noise:
    point = point_noise(observed, load_coefficient(observed) if "alpha" in terms else 0.0)
    return Noise(point=point, pair=point, drift=point, drift_time=3600.0)


def _covariances(
    observed: Observations,
    terms: tuple[str, ...],
    parameters: FrictionParameters,
    plausible: list[tuple[Noise, float]],
    shares: Array,
) -> tuple[Array, Array]:
    """Return the covariance of the weighted estimates, averaged over the plausible noises.

    With differences between runs by some shares of the coefficients, and by the noise alone.
    """
    noise = plausible[0][0]
    weighted = jacobian(weighted_equations(observed, noise), terms, parameters)
    size = np.maximum(np.linalg.norm(weighted, axis=0), 1e-300)
    between, within = weighted[:-1] / size, weighted[-1] / size
    deviation = np.sqrt(noise.pair**2 + noise.drift**2 + noise.point**2 / observed.bins)
    scaled = between / deviation[:, np.newaxis]
    meat = np.outer(within, within) * contrast_inflation(observed, parameters.alpha, noise.point)
    for possible, weight in plausible:
        truth = pair_covariance(possible, time=observed.time, run=observed.run, bins=observed.bins)
        meat += weight * (scaled.T @ truth.times(scaled))
    noise_alone = meat.copy()
    starts = run_starts(observed.run)
    of_load = contrast_by_run(observed) / max(observed.load_contrast, 1e-300)
    for number, (term, share) in enumerate(zip(terms, shares.tolist(), strict=True)):
        # what a coefficient of another size in a run does to the sums of the fit
        spread = share * getattr(parameters, term)
        moved = np.add.reduceat(weighted[:-1, number, np.newaxis] * between, starts)
        moved += np.outer(of_load * weighted[-1, number], within)
        meat += spread**2 * moved.T @ moved
    bread = np.linalg.pinv(between.T @ between + np.outer(within, within))
    scale = np.outer(size, size)

    def of_estimates(meat: Array) -> Array:
        # the column of delta is zero where gamma is
        unknown = np.full_like(scale, np.nan)
        return np.divide(bread @ meat @ bread, scale, out=unknown, where=scale > 0)

    return of_estimates(meat), of_estimates(noise_alone)


def freedom(observed: Observations, noise: Noise, parameters: int) -> float:
    """Return the effective degrees of freedom of the noise estimate.

    The number of independent observations, a duration of two correlation times counting as one
    where drift dominates, less the number of parameters.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    noise : Noise
        Its noise. [N·m]
    parameters : int
        Number of fitted parameters.
    """
    white = noise.pair**2 + noise.point**2 / np.mean(observed.bins)
    runs = [observed.time[observed.run == run] for run in np.unique(observed.run)]
    independent = sum(1 + np.ptp(time) / (2 * noise.drift_time) for time in runs)
    share = noise.drift**2 / (noise.drift**2 + white)
    pairs = len(observed.friction)
    effective = 1 / (share / min(independent, pairs) + (1 - share) / pairs)
    return float(max(effective - parameters, 2.0))
