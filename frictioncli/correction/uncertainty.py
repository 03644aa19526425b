r"""Correct when the predicted uncertainty of friction demands it.

Between corrections a scalar Kalman filter predicts the deviation z of friction, the process of
:mod:`frictioncli.correction.deviation`. While its clock goes on by h, the estimate goes back to the
mean and becomes uncertain:

.. math::

    \hat z \to \mu + e^{-h/\lambda} (\hat z - \mu), \qquad
    P \to e^{-2h/\lambda} P + \sigma_d^2 (1 - e^{-2h/\lambda})

A correction measures z with the white noise's variance :math:`\sigma_w^2`: the estimate moves by
the share :math:`g = P/(P + \sigma_w^2)` towards it, and P falls to :math:`(1 - g) P`. Before the
first one friction is predicted from the motor temperature as it is, and the mean adds to the error:
its second moment is :math:`\mu^2 + \sigma_d^2`.

The deviation is one of the viscous coefficient, so at speed v the standard deviation of friction is
:math:`\sqrt{P v}`. A correction is due where that exceeds a bound at the highest speed. The
temperature parameter in force is the one that gives the estimate:
:math:`\Delta T = -\ln(1 + \hat z / (\gamma e^{-\delta T_m})) / \delta`.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.correction.deviation import Deviation, measured_deviation, travel
from frictioncli.correction.replay import PhaseData, Replay
from frictioncli.model.friction import FrictionParameters, friction_torque

_BLOCK = 64

_LEAST = 0.01
"""Share of the temperature term that a correction leaves at least: (16) cannot go below zero."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterState:
    """What is known of the deviation at one moment, for each way that its process may be.

    Attributes
    ----------
    clock : ndarray, shape (ways,)
        Reading of each clock. [°C]
    mean, variance : ndarray, shape (ways,)
        Estimate and its variance. [torque unit/(deg/s)^0.5], [torque unit²/(deg/s)]
    untouched : bool
        Whether no correction has been made yet: the one in force is then zero.
    """

    clock: Array
    mean: Array
    variance: Array
    untouched: bool = False

    def at(self, clock: Array, process: Deviation) -> tuple[Array, Array]:
        """Return estimate and variance at later moments, shape (moments, ways) each.

        Parameters
        ----------
        clock : ndarray, shape (moments, ways)
            Readings of the clocks, none before the belief's. [°C]
        process : Deviation
            The deviation's process.
        """
        decay = np.exp(-(clock - self.clock) / process.length)
        mean = process.mean + decay * (self.mean - process.mean)
        return mean, process.variance + np.square(decay) * (self.variance - process.variance)

    def predicted(self, clock: Array, process: Deviation) -> tuple[Array, Array]:
        """Return the deviation predicted and its mean square error, shape (moments,) each.

        Parameters are those of :meth:`at`.
        """
        mean, variance = self.at(clock, process)
        if self.untouched:
            return np.zeros(len(clock)), (variance + np.square(mean)) @ process.weight
        return mean @ process.weight, variance @ process.weight

    def corrected(self, value: float, clock: Array, process: Deviation) -> "FilterState":
        """Return the belief after a correction.

        Parameters
        ----------
        value : float
            Measured deviation. [torque unit/(deg/s)^0.5]
        clock : ndarray, shape (ways,)
            When. [°C]
        process : Deviation
            The deviation's process.
        """
        mean, variance = (part[0] for part in self.at(clock[np.newaxis], process))
        gain = variance / (variance + process.noise)
        return FilterState(
            clock=clock, mean=mean + gain * (value - mean), variance=(1 - gain) * variance
        )


def follow(
    data: PhaseData,
    parameters: FrictionParameters,
    process: Deviation,
    *,
    bound: float,
    speed: float,
) -> Replay:
    """Predict the friction of a phase, correcting wherever the predicted error exceeds a bound.

    Parameters
    ----------
    data : PhaseData
        The phase.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    process : Deviation
        How the deviation behaves.
    bound : float
        Greatest standard deviation of the predicted friction. [torque unit]
    speed : float
        Speed at which the bound must hold, the highest of the joint. [deg/s]

    Notes
    -----
    A correction uses the measured pair at the correction speed that is nearest in time, no pair
    twice: where the bound is too small to be kept, every such pair is used. Where (18) has no
    solution for it, the event counts as failed and the next pair is tried.
    """
    count = len(data.time)
    clock = travel(data)[:, np.newaxis] + data.time[:, np.newaxis] * process.rate
    measured = measured_deviation(data, parameters)
    allowed = bound**2 / speed
    belief = FilterState(
        clock=clock[0], mean=process.mean, variance=process.variance, untouched=True
    )
    deviation = np.zeros(count)
    corrected, failed = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    begin, size, used = 0, _BLOCK, -1
    while begin < count:
        rows = slice(begin, begin + size)
        deviation[rows], error = belief.predicted(clock[rows], process)
        due = (error > allowed) & (data.probe[rows] > used)
        if not due.any():
            begin, size = begin + size, 2 * size
            continue
        begin, size = begin + int(np.argmax(due)), _BLOCK
        used = int(data.probe[begin])
        corrected[begin], failed[begin] = True, not np.isfinite(measured[used])
        if not failed[begin]:
            belief = belief.corrected(float(measured[used]), clock[begin], process)
    correction = _temperature_correction(deviation, data.temperature, parameters)
    predicted = friction_torque(
        parameters, load=0.0, speed=data.speed, temperature=data.temperature + correction
    )
    return Replay(corrected, failed, correction, predicted)


def _temperature_correction(
    deviation: Array, temperature: Array, parameters: FrictionParameters
) -> Array:
    """Return the change of the temperature parameter that a deviation stands for. [°C]."""
    term = parameters.gamma * np.exp(-parameters.delta * temperature)
    return np.asarray(-np.log(np.maximum(1 + deviation / term, _LEAST)) / parameters.delta)
