r"""Correction of the temperature when the predicted uncertainty of friction exceeds a bound.

Between corrections a scalar Kalman filter [1]_ predicts the state z, the deviation of friction
described in :mod:`frictioncli.correction.deviation`. While its clock advances by h, the estimate
returns to the mean and process noise increases its variance:

.. math::

    \hat z \to \mu + e^{-h/\lambda} (\hat z - \mu), \qquad
    P \to e^{-2h/\lambda} P + \sigma_d^2 (1 - e^{-2h/\lambda})

A correction measures z with noise of variance :math:`\sigma_w^2`: with the gain
:math:`g = P/(P + \sigma_w^2)` the estimate moves by g times the innovation, and P falls to
:math:`(1 - g) P`. Before the first correction friction is predicted from the motor temperature
alone, so that the mean is an error, too: the mean square error is :math:`\mu^2 + \sigma_d^2`.

The state is a deviation of the viscous coefficient; at speed v the standard deviation of friction
is :math:`\sqrt{P v}`. A correction is due where it exceeds a bound at the highest speed. The
temperature correction that corresponds to the estimate is
:math:`\Delta T = -\ln(1 + \hat z / (\gamma e^{-\delta T_m})) / \delta`.

References
----------
.. [1] R. E. Kalman, "A new approach to linear filtering and prediction problems," J. Basic Eng.
   82(1), 1960, doi:10.1115/1.3662552.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.correction.deviation import (
    DeviationProcess,
    measured_deviation,
    temperature_travel,
)
from frictioncli.correction.replay import PhaseData, Replay
from frictioncli.model.friction import FrictionParameters, friction_torque

_CHUNK = 64
"""Number of pairs that are predicted at once after a correction; it doubles without one."""

_LEAST_SHARE = 0.01
"""Least share of the temperature term that remains: (16) cannot become negative."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterState:
    """State of the Kalman filter after an update, for each candidate process.

    Attributes
    ----------
    clock : ndarray, shape (candidates,)
        Reading of each candidate's clock. [°C]
    estimate : ndarray, shape (candidates,)
        Estimate of the deviation. [torque unit/(deg/s)^0.5]
    variance : ndarray, shape (candidates,)
        Its variance. [torque unit²/(deg/s)]
    is_initial : bool
        Whether no correction was made yet: the temperature correction is then zero.
    """

    clock: Array
    estimate: Array
    variance: Array
    is_initial: bool = False

    def predict(self, clock: Array, process: DeviationProcess) -> tuple[Array, Array]:
        """Return estimate and variance at later instants.

        Parameters
        ----------
        clock : ndarray, shape (instants, candidates)
            Readings of the clocks, none before those of the state. [°C]
        process : DeviationProcess
            Process of the deviation.

        Returns
        -------
        estimate, variance : ndarray, shape (instants, candidates)
            Predicted state.
        """
        decay = np.exp(-(clock - self.clock) / process.length)
        estimate = process.mean + decay * (self.estimate - process.mean)
        return estimate, process.variance + np.square(decay) * (self.variance - process.variance)

    def predicted_error(self, clock: Array, process: DeviationProcess) -> tuple[Array, Array]:
        """Return the deviation in force and its mean square error, averaged over candidates.

        Parameters
        ----------
        clock, process
            As for :meth:`predict`.

        Returns
        -------
        deviation, error : ndarray, shape (instants,)
            Deviation [torque unit/(deg/s)^0.5] and mean square error [torque unit²/(deg/s)].
        """
        estimate, variance = self.predict(clock, process)
        if self.is_initial:
            return np.zeros(len(clock)), (variance + np.square(estimate)) @ process.weight
        return estimate @ process.weight, variance @ process.weight

    def update(self, measured: float, clock: Array, process: DeviationProcess) -> "FilterState":
        """Return the state after the update by a measurement.

        Parameters
        ----------
        measured : float
            Measured deviation. [torque unit/(deg/s)^0.5]
        clock : ndarray, shape (candidates,)
            Readings of the clocks at the measurement. [°C]
        process : DeviationProcess
            Process of the deviation.
        """
        estimate, variance = (part[0] for part in self.predict(clock[np.newaxis], process))
        gain = variance / (variance + process.noise)
        return FilterState(
            clock=clock,
            estimate=estimate + gain * (measured - estimate),
            variance=(1 - gain) * variance,
        )


def replay_with_filter(
    data: PhaseData,
    parameters: FrictionParameters,
    process: DeviationProcess,
    *,
    bound: float,
    speed: float,
) -> Replay:
    """Predict the friction of a phase, with a correction wherever its error exceeds a bound.

    Parameters
    ----------
    data : PhaseData
        The phase.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    process : DeviationProcess
        Process of the deviation.
    bound : float
        Greatest standard deviation of the predicted friction. [torque unit]
    speed : float
        Speed at which the bound must hold, the highest of the joint. [deg/s]

    Returns
    -------
    Replay
        Corrections and predicted friction.

    Notes
    -----
    A correction uses the measured pair at the correction speed that is nearest in time, and each
    pair once: where the bound is too small to be kept, all of them are used. Where (18) has no
    solution, the correction counts as failed and the next pair is tried.
    """
    count = len(data.time)
    clock = temperature_travel(data)[:, np.newaxis] + data.time[:, np.newaxis] * process.rate
    measured = measured_deviation(data, parameters)
    allowed = bound**2 / speed
    state = FilterState(
        clock=clock[0], estimate=process.mean, variance=process.variance, is_initial=True
    )
    deviation = np.zeros(count)
    corrected, failed = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    begin, size, used = 0, _CHUNK, -1
    while begin < count:
        rows = slice(begin, begin + size)
        deviation[rows], error = state.predicted_error(clock[rows], process)
        due = (error > allowed) & (data.correction_pair[rows] > used)
        if not due.any():
            begin, size = begin + size, 2 * size
            continue
        begin, size = begin + int(np.argmax(due)), _CHUNK
        used = int(data.correction_pair[begin])
        corrected[begin], failed[begin] = True, not np.isfinite(measured[used])
        if not failed[begin]:
            state = state.update(float(measured[used]), clock[begin], process)
    correction = _temperature_correction(deviation, data.temperature, parameters)
    predicted = friction_torque(
        parameters, load=0.0, speed=data.speed, temperature=data.temperature + correction
    )
    return Replay(corrected, failed, correction, predicted)


def _temperature_correction(
    deviation: Array, temperature: Array, parameters: FrictionParameters
) -> Array:
    """Return the temperature correction that corresponds to a deviation [°C]."""
    term = parameters.gamma * np.exp(-parameters.delta * temperature)
    return np.asarray(-np.log(np.maximum(1 + deviation / term, _LEAST_SHARE)) / parameters.delta)
