r"""How friction departs from what the motor temperature tells, as a random process.

The deviation :math:`z = (\tau - \tau(T_m)) / \sqrt{v}` at zero load, with :math:`\tau(T_m)` from
(16), is that of the viscous coefficient :math:`\beta + \gamma e^{-\delta T}`. It is described as a
stationary Ornstein-Uhlenbeck process about a mean:

.. math:: z = \mu + d, \qquad \operatorname{cov}[d, d'] = \sigma_d^2 e^{-|s - s'| / \lambda}

It is measured at the correction speed, with white noise :math:`\sigma_w`. Two choices are the
data's:

- The process is one of friction, not of the temperature parameter T that (18) makes of it. The same
  torque is several times as many degrees in a hot joint as in a cold one; as a torque the
  deviation is of one size all over the cycle.
- Its clock s runs with the motor temperature, :math:`s = \int |dT_m| + r t`. Friction and motor
  temperature part while the joint warms or cools; the rate r says how much they part at rest.
  Neither r nor the correlation length :math:`\lambda` is known, so several have weights.
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

LEAST_PROBES = 8
"""Pairs at the correction speed that a mean, two deviations and a correlation length need."""

_RATES = np.array([1.0, 10.0, 100.0]) / 3600.0
"""What time adds to the clock: of little, equal, and more account than temperature. [°C/s]"""

_NEGLIGIBLE = 0.01
"""Clocks and lengths that are so many times less likely than the best are left out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """The deviation's process, for several clocks and correlation lengths.

    Attributes
    ----------
    weight : ndarray, shape (ways,)
        How likely each is; they sum to 1.
    rate : ndarray, shape (ways,)
        What time adds to the clock. [°C/s]
    length : ndarray, shape (ways,)
        Correlation length on the clock. [°C]
    mean : ndarray, shape (ways,)
        Mean deviation. [torque unit/(deg/s)^0.5]
    variance : ndarray, shape (ways,)
        Variance of the deviation about it, with that of the estimated mean. [torque unit²/(deg/s)]
    noise : ndarray, shape (ways,)
        Variance of the white noise of a measurement. [torque unit²/(deg/s)]
    """

    weight: Array
    rate: Array
    length: Array
    mean: Array
    variance: Array
    noise: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Probes:
    """Pairs at the correction speed, all phases of one joint, ordered by run and time.

    Attributes
    ----------
    run : ndarray of int, shape (probes,)
        Run of each pair.
    time, travel : ndarray, shape (probes,)
        Time, and how far the motor temperature has moved, up and down, since the first pair.
        [s], [°C]
    deviation : ndarray, shape (probes,)
        Measured viscous coefficient beyond that at the motor temperature.
        [torque unit/(deg/s)^0.5]
    """

    run: Indices
    time: Array
    travel: Array
    deviation: Array


def measured_deviation(data: PhaseData, parameters: FrictionParameters) -> Array:
    """Return each pair's viscous coefficient beyond that at its motor temperature.

    Parameters
    ----------
    data : PhaseData
        Pairs of one phase.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.

    Returns
    -------
    ndarray, shape (pairs,)
        NaN where (18) has no solution: no temperature gives that friction.
        [torque unit/(deg/s)^0.5]
    """
    modelled = friction_torque(parameters, load=0.0, speed=data.speed, temperature=data.temperature)
    found = temperature_from_friction(
        parameters, friction=data.friction, load=0.0, speed=data.speed
    )
    return np.where(np.isfinite(found), (data.friction - modelled) / np.sqrt(data.speed), np.nan)


def travel(data: PhaseData) -> Array:
    """Return how far the motor temperature has moved since the phase began, shape (pairs,). [°C].

    It is that of the pairs at the correction speed, interpolated over time: a sensor that flickers
    between two values moves less from one of these to the next than from pair to pair.
    """
    rows = np.unique(data.probe)
    moved = np.abs(np.diff(data.temperature[rows], prepend=data.temperature[rows[0]]))
    return np.interp(data.time, data.time[rows], np.cumsum(moved))


def probes_of(phases: list[tuple[int, PhaseData]], parameters: FrictionParameters) -> Probes:
    """Return the pairs at the correction speed whose inversion (18) has a solution.

    Parameters
    ----------
    phases : list of (int, PhaseData)
        Number of the run, and the phase, ordered by run and time.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    """
    columns = []
    for run, data in phases:
        rows = np.unique(data.probe)
        found = measured_deviation(data, parameters)[rows]
        columns.append(
            np.array([np.full(len(rows), run), data.time[rows], data.temperature[rows], found])
        )
    whole = np.concatenate(columns, axis=1)
    run, time, temperature, found = whole[:, np.isfinite(whole[3])]
    moved = np.abs(np.diff(temperature, prepend=temperature[:1]))
    return Probes(run=run.astype(np.intp), time=time, travel=np.cumsum(moved), deviation=found)


def estimated_deviation(probes: Probes) -> Deviation:
    """Estimate the process by restricted maximum likelihood, the mean being free.

    Parameters
    ----------
    probes : Probes
        Measured deviations.

    Raises
    ------
    NotEnoughData
        If there are fewer than :data:`LEAST_PROBES`.
    """
    count = len(probes.time)
    if count < LEAST_PROBES:
        raise NotEnoughData(
            f"criterion uncertainty needs {LEAST_PROBES} pairs at the correction speed whose"
            f" friction gives a temperature by (18), to see how uncertain friction becomes; found"
            f" {count}: log more of them, or choose another criterion"
        )
    even = np.ones((count, 1))
    likelihoods, ways = [], []
    for rate in _RATES:
        clock = probes.travel + rate * probes.time
        pairs = {"time": clock, "run": probes.run, "bins": np.ones(count)}
        for noise, _ in plausible_noise(residual=probes.deviation, design=even, point=0.0, **pairs):
            covariance = pair_covariance(noise, **pairs)
            solved = covariance.solve(even)[:, 0]
            mean = solved @ probes.deviation / solved.sum()
            variance = noise.drift**2 + 1 / solved.sum()
            likelihoods.append(restricted_log_likelihood(covariance, probes.deviation, even))
            ways.append((rate, noise.drift_time, mean, variance, noise.pair**2))
    likely = np.exp(np.array(likelihoods) - max(likelihoods))
    kept = likely >= _NEGLIGIBLE
    rates, lengths, means, variances, noises = np.array(ways)[kept].T
    return Deviation(
        weight=likely[kept] / likely[kept].sum(),
        rate=rates,
        length=lengths,
        mean=means,
        variance=variances,
        noise=noises,
    )
