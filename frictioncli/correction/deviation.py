r"""Random process of the deviation of friction from the model at the motor temperature.

The deviation :math:`z = (\tau - \tau(T_m)) / \sqrt{v}` at zero load, with :math:`\tau(T_m)` from
(16), is a deviation of the viscous coefficient :math:`\beta + \gamma e^{-\delta T}`. It is modelled
as a stationary Ornstein-Uhlenbeck process about a mean [1]_:

.. math:: z = \mu + d, \qquad \operatorname{cov}[d, d'] = \sigma_d^2 e^{-|s - s'| / \lambda}

It is measured at the correction speed, with white noise :math:`\sigma_w`. Two choices follow from
measured data:

- The process describes friction, not the temperature parameter T that (18) derives from it. The
  same torque corresponds to several times as many degrees in a hot joint as in a cold one; as a
  torque the deviation has the same size over the whole thermal cycle.
- Its clock s advances with the motor temperature, :math:`s = \int |dT_m| + r t`. Friction departs
  from the model mainly while the joint warms or cools; the rate r describes how much it does at
  constant temperature. Neither r nor the correlation length :math:`\lambda` is known, so that
  several candidates are weighted by their likelihood.

References
----------
.. [1] G. E. Uhlenbeck and L. S. Ornstein, "On the theory of the Brownian motion," Phys. Rev. 36(5),
   1930, doi:10.1103/PhysRev.36.823.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.correction.replay import PhaseData
from frictioncli.errors import NotEnoughData
from frictioncli.model.friction import (
    FrictionParameters,
    friction_torque,
    temperature_from_friction,
)
from frictioncli.model.noise import (
    pair_covariance,
    plausible_noise,
    restricted_log_likelihood,
)

LEAST_PAIRS = 8
"""Least number of pairs at the correction speed, to estimate four parameters of the process."""

_RATES = np.array([1.0, 10.0, 100.0]) / 3600.0
"""Candidate rates r: time matters less, as much, and more than temperature. [°C/s]"""

_LEAST_LIKELIHOOD = 0.01
"""Candidates less likely than this, relative to the best, are left out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviationProcess:
    """Candidate processes of the deviation with different clocks and correlation lengths.

    Attributes
    ----------
    weight : ndarray, shape (candidates,)
        Normalised likelihood of each candidate.
    rate : ndarray, shape (candidates,)
        Rate r of the clock. [°C/s]
    length : ndarray, shape (candidates,)
        Correlation length on the clock. [°C]
    mean : ndarray, shape (candidates,)
        Mean deviation. [torque unit/(deg/s)^0.5]
    variance : ndarray, shape (candidates,)
        Variance about the mean, with that of the estimated mean. [torque unit²/(deg/s)]
    noise : ndarray, shape (candidates,)
        Variance of the white measurement noise. [torque unit²/(deg/s)]
    """

    weight: Array
    rate: Array
    length: Array
    mean: Array
    variance: Array
    noise: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionPairs:
    """Pairs at the correction speed in all phases of one joint, ordered by run and time.

    Attributes
    ----------
    run : ndarray of int, shape (pairs,)
        Number of the run.
    time : ndarray, shape (pairs,)
        Time. [s]
    travel : ndarray, shape (pairs,)
        Sum of the absolute changes of the motor temperature since the first pair. [°C]
    deviation : ndarray, shape (pairs,)
        Measured deviation of the viscous coefficient. [torque unit/(deg/s)^0.5]
    """

    run: Indices
    time: Array
    travel: Array
    deviation: Array


def measured_deviation(data: PhaseData, parameters: FrictionParameters) -> Array:
    """Return each pair's deviation of the viscous coefficient from the model.

    Parameters
    ----------
    data : PhaseData
        Pairs of one phase.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.

    Returns
    -------
    ndarray, shape (pairs,)
        Deviation; NaN where (18) has no solution, as no temperature gives that friction.
        [torque unit/(deg/s)^0.5]
    """
    modelled = friction_torque(parameters, load=0.0, speed=data.speed, temperature=data.temperature)
    temperature = temperature_from_friction(
        parameters, friction=data.friction, load=0.0, speed=data.speed
    )
    deviation = (data.friction - modelled) / np.sqrt(data.speed)
    return np.where(np.isfinite(temperature), deviation, np.nan)


def temperature_travel(data: PhaseData) -> Array:
    """Return the sum of the absolute changes of the motor temperature since the phase began.

    It is computed at the pairs at the correction speed and interpolated over time: the flicker of a
    sensor between two values adds less from one of these to the next than from pair to pair.

    Parameters
    ----------
    data : PhaseData
        Pairs of one phase.

    Returns
    -------
    ndarray, shape (pairs,)
        Travel of the motor temperature. [°C]
    """
    rows = np.unique(data.correction_pair)
    change = np.abs(np.diff(data.temperature[rows], prepend=data.temperature[rows[0]]))
    return np.interp(data.time, data.time[rows], np.cumsum(change))


def correction_pairs_of(
    phases: list[tuple[int, PhaseData]], parameters: FrictionParameters
) -> CorrectionPairs:
    """Return the pairs at the correction speed for which (18) has a solution.

    Parameters
    ----------
    phases : list of (int, PhaseData)
        Number of the run, and the phase; ordered by run and time.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    """
    columns = []
    for run, data in phases:
        rows = np.unique(data.correction_pair)
        deviation = measured_deviation(data, parameters)[rows]
        columns.append(
            np.array([np.full(len(rows), run), data.time[rows], data.temperature[rows], deviation])
        )
    table = np.concatenate(columns, axis=1)
    run, time, temperature, deviation = table[:, np.isfinite(table[3])]
    change = np.abs(np.diff(temperature, prepend=temperature[:1]))
    return CorrectionPairs(
        run=run.astype(np.intp), time=time, travel=np.cumsum(change), deviation=deviation
    )


def fit_deviation_process(pairs: CorrectionPairs) -> DeviationProcess:
    """Estimate the process of the deviation by restricted maximum likelihood.

    Parameters
    ----------
    pairs : CorrectionPairs
        Measured deviations.

    Returns
    -------
    DeviationProcess
        Candidates with their weights.

    Raises
    ------
    NotEnoughData
        If there are fewer pairs than :data:`LEAST_PAIRS`.
    """
    count = len(pairs.time)
    if count < LEAST_PAIRS:
        raise NotEnoughData(
            f"criterion uncertainty needs {LEAST_PAIRS} pairs at the correction speed whose"
            f" friction gives a temperature by (18), to estimate the uncertainty; found"
            f" {count}: log more of them, or choose another criterion"
        )
    constant = np.ones((count, 1))
    likelihoods, candidates = [], []
    for rate in _RATES:
        clock = pairs.travel + rate * pairs.time
        layout = {"time": clock, "run": pairs.run, "bins": np.ones(count)}
        noises = plausible_noise(residual=pairs.deviation, design=constant, point=0.0, **layout)
        for noise, _ in noises:
            covariance = pair_covariance(noise, **layout)
            solved = covariance.solve(constant)[:, 0]
            mean = solved @ pairs.deviation / solved.sum()
            variance = noise.drift**2 + 1 / solved.sum()
            likelihoods.append(restricted_log_likelihood(covariance, pairs.deviation, constant))
            candidates.append((rate, noise.drift_time, mean, variance, noise.pair**2))
    likely = np.exp(np.array(likelihoods) - max(likelihoods))
    kept = likely >= _LEAST_LIKELIHOOD
    rates, lengths, means, variances, noises = np.array(candidates)[kept].T
    return DeviationProcess(
        weight=likely[kept] / likely[kept].sum(),
        rate=rates,
        length=lengths,
        mean=means,
        variance=variances,
        noise=noises,
    )
