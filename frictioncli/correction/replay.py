"""Replay of Algorithm 3 on measured pairs: corrections, predicted friction and its error."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.model.friction import (
    FrictionParameters,
    friction_torque,
    temperature_from_friction,
)

_LEAST_SMOOTHED = 4
"""Least number of pairs of a speed in a phase that are smoothed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PhaseData:
    """Pairs of one phase of one run and joint at zero load, in time order.

    Attributes
    ----------
    time : ndarray, shape (pairs,)
        Time. [s]
    speed : ndarray, shape (pairs,)
        Speed. [deg/s]
    temperature, reading : ndarray, shape (pairs,)
        Motor temperature, and the value that the controller registered. [°C]
    friction, smoothed : ndarray, shape (pairs,)
        Measured friction torque, and the same smoothed over temperature for each speed. [N·m]
    correction_pair : ndarray of int, shape (pairs,)
        For each pair the index of the one at the correction speed that is nearest in time.
    """

    time: Array
    speed: Array
    temperature: Array
    reading: Array
    friction: Array
    smoothed: Array
    correction_pair: Numbers


@dataclass(frozen=True, slots=True)
class Replay:
    """Result of Algorithm 3 in one phase.

    Attributes
    ----------
    corrected, failed : ndarray of bool, shape (pairs,)
        Where a correction was made, and where (18) had no solution for it.
    correction : ndarray, shape (pairs,)
        Temperature correction in force. [°C]
    predicted : ndarray, shape (pairs,)
        Friction torque at zero load predicted by (16) and (17). [N·m]
    """

    corrected: Flags
    failed: Flags
    correction: Array
    predicted: Array

    def epsilon(self, measured: Array) -> float:
        """Return the RMS error (21) of the prediction [N·m].

        Parameters
        ----------
        measured : ndarray, shape (pairs,)
            Measured friction torque. [N·m]
        """
        return float(np.sqrt(np.mean(np.square(self.predicted - measured))))


def phase_data(pairs: pd.DataFrame, *, correction_speed: float, degree: int) -> PhaseData:
    """Return the arrays of one phase.

    Parameters
    ----------
    pairs : DataFrame
        Rows of :func:`frictioncli.model.zero_load.friction_at_zero_load` of one phase, in time
        order, all with a motor temperature.
    correction_speed : float
        Speed of the pairs that corrections use; the nearest one in the data is taken. [deg/s]
    degree : int
        Degree of the polynomials in temperature that smooth the measured friction.

    Returns
    -------
    PhaseData
        The arrays.
    """
    time = pairs["time"].to_numpy(float)
    speed = pairs["speed"].to_numpy(float)
    temperature = pairs["motor_temperature"].to_numpy(float)
    friction = pairs["friction_torque"].to_numpy(float)
    reading = pairs["motor_temperature_reading"].to_numpy(float)
    nearest = speed[np.argmin(np.abs(speed - correction_speed))]
    candidates = np.flatnonzero(np.isclose(speed, nearest, rtol=0.01))
    after = np.clip(np.searchsorted(time[candidates], time), 0, len(candidates) - 1)
    before = np.maximum(after - 1, 0)
    later = np.abs(time[candidates[after]] - time) < np.abs(time[candidates[before]] - time)
    return PhaseData(
        time=time,
        speed=speed,
        temperature=temperature,
        reading=np.where(np.isfinite(reading), reading, temperature),
        friction=friction,
        smoothed=smoothed_friction(
            temperature=temperature, speed=speed, friction=friction, degree=degree
        ),
        correction_pair=np.where(later, candidates[after], candidates[before]),
    )


def smoothed_friction(*, temperature: Array, speed: Array, friction: Array, degree: int) -> Array:
    """Return friction torque smoothed by a polynomial in motor temperature, speed by speed.

    Parameters
    ----------
    temperature, speed, friction : ndarray, shape (pairs,)
        Motor temperature [°C], speed [deg/s] and friction torque [N·m] of the pairs of one phase.
    degree : int
        Degree of the polynomials; lower where a speed has too few different temperatures. Fewer
        than four pairs at different temperatures are left as they are: their mean would not fall
        with temperature.

    Returns
    -------
    ndarray, shape (pairs,)
        Smoothed friction torque. [N·m]

    Examples
    --------
    >>> smoothed_friction(
    ...     temperature=np.array([20.0, 25.0, 30.0, 35.0]),
    ...     speed=np.full(4, 60.0),
    ...     friction=np.array([50.0, 46.0, 44.0, 40.0]),
    ...     degree=1,
    ... ).round(6)
    array([49.8, 46.6, 43.4, 40.2])
    """
    smooth = np.empty_like(friction)
    for level in np.unique(speed):
        rows = speed == level
        if rows.sum() < _LEAST_SMOOTHED and degree and np.ptp(temperature[rows]) > 0:
            smooth[rows] = friction[rows]
            continue
        order = min(degree, len(np.unique(temperature[rows])) - 1, max(rows.sum() // 2 - 1, 0))
        polynomial = np.polynomial.Polynomial.fit(temperature[rows], friction[rows], order)
        smooth[rows] = polynomial(temperature[rows])
    return smooth


def replay(data: PhaseData, parameters: FrictionParameters, instants: ArrayLike) -> Replay:
    """Predict the friction of a phase with corrections at the given instants.

    Parameters
    ----------
    data : PhaseData
        The phase.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    instants : array_like of int
        Increasing indices of the pairs at which a correction is made.

    Returns
    -------
    Replay
        Corrections and predicted friction.

    Notes
    -----
    A correction uses, in (18) and (19), the measured pair at the correction speed that is nearest
    in time, and its motor temperature. Where (18) has no solution, the last correction is kept and
    the event counts as failed.
    """
    events = np.asarray(instants, dtype=np.int64)
    used = data.correction_pair[events]
    effective = temperature_from_friction(
        parameters, friction=data.friction[used], load=0.0, speed=data.speed[used]
    )
    failures = ~np.isfinite(effective)
    steps = effective - data.temperature[used]
    # a failed event keeps the correction in force: carry the last success forward
    last_good = np.maximum.accumulate(np.where(failures, -1, np.arange(len(events))))
    in_force = np.where(last_good >= 0, steps[last_good], 0.0) if len(events) else steps
    event_of = np.searchsorted(events, np.arange(len(data.time)), side="right") - 1
    correction = np.zeros(len(data.time))
    correction[event_of >= 0] = in_force[event_of[event_of >= 0]]
    corrected = np.zeros(len(data.time), dtype=bool)
    failed = corrected.copy()
    corrected[events] = True
    failed[events] = failures
    predicted = friction_torque(
        parameters, load=0.0, speed=data.speed, temperature=data.temperature + correction
    )
    return Replay(corrected, failed, correction, predicted)


def replay_online(
    data: PhaseData, corrector: TemperatureCorrector, instants: ArrayLike | None = None
) -> Replay:
    """Predict the friction of a phase with the corrector of a controller, pair by pair.

    Parameters
    ----------
    data : PhaseData
        The phase.
    corrector : TemperatureCorrector
        A new corrector; it is modified.
    instants : array_like of int, optional
        Indices of the pairs at which to correct; by default those at which it is due.

    Returns
    -------
    Replay
        Corrections and predicted friction, by the rules of :func:`replay`.
    """
    count = len(data.time)
    corrected, failed = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    correction = np.zeros(count)
    given = None if instants is None else set(np.asarray(instants, dtype=np.int64).tolist())
    samples = zip(data.time.tolist(), data.temperature.tolist(), data.reading.tolist(), strict=True)
    for i, (time, temperature, reading) in enumerate(samples):
        corrector.update(time, temperature, registered=reading)
        if corrector.is_due if given is None else i in given:
            used = data.correction_pair[i]
            solved = corrector.correct(
                friction=float(data.friction[used]),
                load=0.0,
                speed=float(data.speed[used]),
                motor_temperature=float(data.temperature[used]),
            )
            corrected[i], failed[i] = True, not solved
        correction[i] = corrector.correction
    predicted = friction_torque(
        corrector.parameters,
        load=0.0,
        speed=data.speed,
        temperature=data.temperature + correction,
    )
    return Replay(corrected, failed, correction, predicted)
