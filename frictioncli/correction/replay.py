"""Algorithm 3 replayed on measured pairs: temperature parameter, prediction and its error."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class PhaseData:
    """Pairs of one phase of one run and joint, in time order, at zero load.

    Attributes
    ----------
    time, speed, temperature, reading : ndarray, shape (pairs,)
        Time, speed, motor temperature and the same as the controller registered it.
        [s], [deg/s], [°C], [°C]
    friction, smoothed : ndarray, shape (pairs,)
        Measured friction torque, and the same smoothed over temperature per speed. [N·m]
    probe : ndarray of int, shape (pairs,)
        For each pair the one at the correction speed that is nearest in time.
    """

    time: Array
    speed: Array
    temperature: Array
    reading: Array
    friction: Array
    smoothed: Array
    probe: Numbers


@dataclass(frozen=True, slots=True)
class Replay:
    """What Algorithm 3 does in one phase.

    Attributes
    ----------
    corrected, failed : ndarray of bool, shape (pairs,)
        Where a correction was tried, and where its inversion (18) had no solution.
    correction : ndarray, shape (pairs,)
        Temperature correction in force. [°C]
    predicted : ndarray, shape (pairs,)
        Friction torque at zero load predicted by (16), (17). [N·m]
    """

    corrected: Flags
    failed: Flags
    correction: Array
    predicted: Array

    def epsilon(self, measured: Array) -> float:
        """Return the error (21) of the prediction against measured friction torque. [N·m]."""
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
    """
    time = pairs["time"].to_numpy(float)
    speed = pairs["speed"].to_numpy(float)
    temperature = pairs["motor_temperature"].to_numpy(float)
    friction = pairs["friction_torque"].to_numpy(float)
    reading = pairs["motor_temperature_reading"].to_numpy(float)
    nearest = speed[np.argmin(np.abs(speed - correction_speed))]
    probes = np.flatnonzero(np.isclose(speed, nearest, rtol=0.01))
    after = np.clip(np.searchsorted(time[probes], time), 0, len(probes) - 1)
    before = np.maximum(after - 1, 0)
    later = np.abs(time[probes[after]] - time) < np.abs(time[probes[before]] - time)
    return PhaseData(
        time=time,
        speed=speed,
        temperature=temperature,
        reading=np.where(np.isfinite(reading), reading, temperature),
        friction=friction,
        smoothed=smoothed_friction(
            temperature=temperature, speed=speed, friction=friction, degree=degree
        ),
        probe=np.where(later, probes[after], probes[before]),
    )


def smoothed_friction(*, temperature: Array, speed: Array, friction: Array, degree: int) -> Array:
    """Return friction torque smoothed by a polynomial in motor temperature, speed by speed.

    Parameters
    ----------
    temperature, speed, friction : ndarray, shape (pairs,)
        Of the pairs of one phase. [°C], [deg/s], [N·m]
    degree : int
        Degree of the polynomials; lower where a speed has too few different temperatures.
    """
    smooth = np.empty_like(friction)
    for level in np.unique(speed):
        rows = speed == level
        order = min(degree, len(np.unique(temperature[rows])) - 1, max(rows.sum() // 2 - 1, 0))
        law = np.polynomial.Polynomial.fit(temperature[rows], friction[rows], order)
        smooth[rows] = law(temperature[rows])
    return smooth


def replay(data: PhaseData, parameters: FrictionParameters, corrections: ArrayLike) -> Replay:
    """Predict the friction of a phase with corrections at the given instants.

    Parameters
    ----------
    data : PhaseData
        The phase.
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    corrections : array_like of int
        Pairs at which a correction is made, growing. Before the first one there is none.

    Notes
    -----
    A correction uses the measured pair at the correction speed that is nearest in time, and that
    pair's motor temperature, in (18) and (19). Where (18) has no solution the last correction is
    kept and the event counts as failed.
    """
    events = np.asarray(corrections, dtype=np.int64)
    used = data.probe[events]
    found = temperature_from_friction(
        parameters, friction=data.friction[used], load=0.0, speed=data.speed[used]
    )
    failures = ~np.isfinite(found)
    steps = found - data.temperature[used]
    # a failed event keeps what was in force: carry the last success forward
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
    """Predict the friction of a phase with the corrector of a robot at work, pair by pair.

    Parameters
    ----------
    data : PhaseData
        The phase.
    corrector : TemperatureCorrector
        A new one; it goes through the phase.
    instants : array_like of int, optional
        Pairs at which to correct, instead of those at which it is due.

    Notes
    -----
    What a correction uses, and what its failure does, is as in :func:`replay`.
    """
    count = len(data.time)
    corrected, failed = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    correction = np.zeros(count)
    chosen = None if instants is None else set(np.asarray(instants, dtype=np.int64).tolist())
    samples = zip(data.time.tolist(), data.temperature.tolist(), data.reading.tolist(), strict=True)
    for i, (time, temperature, reading) in enumerate(samples):
        corrector.update(time, temperature, registered=reading)
        if corrector.is_due if chosen is None else i in chosen:
            used = data.probe[i]
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
