r"""Consecutive identification of the source paper: load first, then the viscous law.

Within a pair friction is :math:`\alpha L^2 + G` (equations (9), (10)), which gives alpha and the
zero-load friction G of each pair. Heating and cooling branches of G are averaged (11), and the
means are fitted by
:math:`\tau^* = \tau_c + (\beta + \gamma e^{-\delta T^*}) \sqrt{\dot\varphi}` ((12), (13)) [1]_.
The covariance comes from a parametric bootstrap with the estimated noise.

References
----------
.. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of industrial
   robot joint with temperature correction by example of KUKA KR10," J. Robotics, 2019,
   doi:10.1155/2019/6931563.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData
from frictioncli.model.drift import run_starts
from frictioncli.model.equations import COEFFICIENTS, Equations, jacobian
from frictioncli.model.friction import FrictionParameters, friction_torque
from frictioncli.model.identifiability import Determination, why_no_load_term
from frictioncli.model.identification import (
    Estimate,
    freedom,
    noise_of_pairs,
    pair_equations,
    pair_residual,
)
from frictioncli.model.load_contrast import (
    contrast_by_run,
    contrast_inflation,
    load_coefficient,
    point_noise,
)
from frictioncli.model.noise import pair_covariance
from frictioncli.model.observations import Observations
from frictioncli.model.run_differences import FIRST_SHARE
from frictioncli.model.variable_projection import minimise
from frictioncli.model.zero_load import friction_at_zero_load, temperature_of

_GRID_STEP = 0.5
"""Distance of the temperatures at which the branches are averaged. [°C]"""

_REPETITIONS = 200
"""Bootstrap samples."""

_SEED = 0

_WITHOUT_LOAD = tuple(one for one in COEFFICIENTS if one != "alpha")
"""Terms that are fitted where the load does not vary."""


def branch_means(pairs: pd.DataFrame, temperature: str = "mean") -> pd.DataFrame:
    r"""Return the mean of the heating and the cooling branch, per speed, on a temperature grid.

    Parameters
    ----------
    pairs : DataFrame
        Rows of :func:`frictioncli.model.zero_load.friction_at_zero_load`.
    temperature : {"mean", "motor", "housing"}
        The temperature against which the branches are averaged; ``mean`` is the paper's.

    Returns
    -------
    DataFrame
        Columns ``speed`` [deg/s], ``temperature`` [°C], ``friction_torque`` [N·m]; empty where no
        speed has both branches over a common temperature range.

    Notes
    -----
    Equation (11): :math:`\tau^*(T^*) = (\tau_{heatup}(T^*) + \tau_{cooldown}(T^*)) / 2` with
    :math:`T^* = (T_c + T_m)/2`. Each branch is interpolated linearly between its measurements;
    branches of several runs are averaged run by run.
    """
    means = _branch_weights(pairs, temperature)
    return pd.DataFrame(
        {
            "speed": means.speed,
            "temperature": means.temperature,
            "friction_torque": means.weights @ pairs["friction_torque"].to_numpy(float),
        }
    )


class _BranchMeans(NamedTuple):
    """Speeds and temperatures of the means, and the weights of the pairs in them.

    The mean is linear in friction: the bootstrap needs the weights only once.
    """

    speed: Array
    temperature: Array
    weights: Array


def _branch_weights(pairs: pd.DataFrame, temperature: str) -> _BranchMeans:
    """Return the weights of the pairs in the branch means, shape (means, pairs)."""
    frame = pd.DataFrame(
        {
            "run": pairs["run"].to_numpy(),
            "joint": pairs["joint"].to_numpy(),
            "speed": pairs["speed"].to_numpy(float),
            "phase": pairs["phase"].to_numpy(),
            "temperature": temperature_of(pairs, temperature).to_numpy(float),
        }
    ).dropna(subset=["temperature"])
    at: dict[tuple[float, float], list[Array]] = {}
    for (_, _, speed), group in frame.groupby(["run", "joint", "speed"], observed=True):
        branches = [
            group.loc[group["phase"] == phase, "temperature"].sort_values()
            for phase in ("heat-up", "cool-down")
        ]
        if min(map(len, branches)) < 2:
            continue
        low = max(branch.iloc[0] for branch in branches)
        high = min(branch.iloc[-1] for branch in branches)
        grid = np.arange(np.ceil(low / _GRID_STEP), np.floor(high / _GRID_STEP) + 1) * _GRID_STEP
        weights = np.zeros((len(grid), len(pairs)))
        for branch in branches:
            place = np.interp(grid, branch, np.arange(len(branch)))
            first = np.minimum(place.astype(int), len(branch) - 2)
            rows = branch.index.to_numpy()
            weights[np.arange(len(grid)), rows[first]] += 0.5 * (1 - (place - first))
            weights[np.arange(len(grid)), rows[first + 1]] += 0.5 * (place - first)
        for number, warm in enumerate(grid):
            at.setdefault((float(speed), float(warm)), []).append(weights[number])
    keys = sorted(at)
    return _BranchMeans(
        speed=np.array([speed for speed, _ in keys]),
        temperature=np.array([warm for _, warm in keys]),
        weights=np.array([np.mean(at[key], axis=0) for key in keys]).reshape(-1, len(pairs)),
    )


def consecutive_fit(
    torques: pd.DataFrame, observed: Observations, temperature: str
) -> tuple[Estimate, Determination]:
    """Identify equation (16) as the source paper does.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of one joint, with the temperatures needed.
    observed : Observations
        The same by pair.
    temperature : {"mean", "motor", "housing"}
        Temperature of the branch means; ``mean`` is the paper's.

    Raises
    ------
    NotEnoughData
        If no two speeds have both a heating and a cooling branch.
    """
    terms = COEFFICIENTS if observed.load_contrast > 0 else _WITHOUT_LOAD
    estimate = _consecutive_fit(torques, observed, temperature, terms)
    reason = why_no_load_term(observed, estimate)
    if not reason:
        return estimate, Determination()
    if "alpha" in terms:
        estimate = _consecutive_fit(torques, observed, temperature, _WITHOUT_LOAD)
    return estimate, Determination().without("alpha", reason, None, "")


def _consecutive_fit(
    torques: pd.DataFrame, observed: Observations, temperature: str, terms: tuple[str, ...]
) -> Estimate:
    """Identify some terms of equation (16) as the source paper does; without alpha it is 0."""
    alpha = load_coefficient(observed) if "alpha" in terms else 0.0
    pairs = friction_at_zero_load(torques, alpha)
    means = _branch_weights(pairs, temperature)
    parameters = _viscous_law(means, pairs["friction_torque"].to_numpy(float), alpha)
    residual = pair_residual(observed, parameters)
    names = (*terms, "delta")
    point = point_noise(observed, alpha)
    plausible, shares = noise_of_pairs(
        observed, terms, parameters, np.full(len(terms), FIRST_SHARE)
    )
    spread = shares * [getattr(parameters, term) for term in terms]
    columns = jacobian(pair_equations(observed), terms, parameters)[:, :-1]
    starts = run_starts(observed.run)
    pairs_of_run = np.diff(np.append(starts, len(observed.run)))
    generator = np.random.default_rng(_SEED)
    covariances = [
        pair_covariance(noise, time=observed.time, run=observed.run, bins=observed.bins)
        for noise, _ in plausible
    ]
    choices = generator.choice(len(plausible), _REPETITIONS, p=[weight for _, weight in plausible])
    unloaded = friction_torque(
        parameters,
        load=0.0,
        speed=pairs["speed"].to_numpy(float),
        temperature=temperature_of(pairs, temperature).to_numpy(float),
    )
    of_runs = np.random.default_rng([_SEED, 1]).standard_normal(
        (_REPETITIONS, len(starts), len(terms))
    )
    load = np.array([term == "alpha" for term in terms])
    deviation, of_load = 0.0, np.zeros(len(starts))
    if load.any():
        contrast = observed.load_contrast
        deviation = point * np.sqrt(contrast_inflation(observed, alpha, point) / contrast)
        of_load = contrast_by_run(observed) / contrast
    repeated = []
    for choice, differences in zip(choices, of_runs * spread, strict=True):
        shift = deviation * generator.standard_normal()
        shift += float(np.sum(of_load @ differences[:, load]))
        disturbance = covariances[choice].draw(generator) - shift * observed.squared_load
        disturbance += np.sum(columns * np.repeat(differences, pairs_of_run, axis=0), axis=1)
        again = _viscous_law(means, unloaded + disturbance, alpha + shift)
        repeated.append([getattr(again, name) for name in names])
    within = observed.friction_within - alpha * observed.squared_load_within
    squares = np.sum(observed.bins * np.square(residual)) + within @ within
    covariance = np.cov(np.array(repeated).T)
    return Estimate(
        parameters=parameters,
        names=names,
        covariance=covariance,
        within=covariance,
        freedom=freedom(observed, plausible[0][0], len(names)),
        noise=plausible[0][0],
        residual=residual,
        rmse=float(np.sqrt(squares / len(within))),
    )


def _viscous_law(means: _BranchMeans, friction: Array, alpha: float) -> FrictionParameters:
    """Return the fit of (12), (13) to the branch means of the pairs' friction."""
    speeds = len(np.unique(means.speed))
    if speeds < 2:
        raise NotEnoughData(
            "--method paper needs a heating and a cooling branch at two speeds at least; found"
            f" {speeds}; use --method joint"
        )
    found = minimise(
        Equations(
            constant=np.ones(len(means.speed)),
            squared_load=np.zeros(len(means.speed)),
            root_speed=np.sqrt(means.speed),
            temperature=means.temperature,
            friction=means.weights @ friction,
        ),
        ("tau_c", "beta", "gamma"),
    )
    return FrictionParameters(
        tau_c=found.tau_c, alpha=alpha, beta=found.beta, gamma=found.gamma, delta=found.delta
    )
