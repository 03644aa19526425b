"""Change of friction at reference temperatures and speeds."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.day_to_day import LevelEstimate, LevelModel
from frictioncli.comparison.run_levels import RunLevels
from frictioncli.diagnosis.data.pair_layout import speed_level
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.model.friction import friction_torque
from frictioncli.schemas import REFERENCE_TEMPERATURES

_MOST_SPEEDS = 5
"""Greatest number of reference speeds."""

_TOLERANCE = 0.5
"""A run covers a temperature within this tolerance: controllers state whole degrees. [°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceCondition:
    """Friction at one temperature and speed, at the usual load, and its change.

    Attributes
    ----------
    temperature : float
        Reference temperature. [°C]
    speed : float
        Reference speed. [deg/s]
    load : float
        RMS load torque of the data; changes of the load term alone are not considered [torque unit,
        or that of the log's load channel].
    friction : float
        Friction torque of the model that all runs share. [torque unit]
    change : LevelEstimate
        Change from the first run to the last. [%]
    extrapolated : bool
        Whether some runs did not reach this temperature.
    """

    temperature: float
    speed: float
    load: float
    friction: float
    change: LevelEstimate
    extrapolated: bool


def changes_at_references(
    problem: Problem,
    levels: RunLevels,
    ambient: Array,
    day_to_day: float,
    design: Array,
) -> tuple[ReferenceCondition, ...]:
    """Return the change at the reference temperatures and at the speeds of the data.

    Parameters
    ----------
    problem : Problem
        All runs.
    levels : RunLevels
        Levels of the constant and the viscous component.
    ambient : ndarray, shape (runs,)
        Ambient temperature. [°C]
    day_to_day : float
        Assumed day-to-day standard deviation. [%]
    design : ndarray, shape (runs, 2)
        Ones, and the time course of the change from 0 to 1.

    Returns
    -------
    tuple of ReferenceCondition
        One per temperature and speed.
    """
    parameters = problem.parameters
    load = float(np.sqrt(np.mean(np.square(problem.table.load))))
    coldest, warmest = _common_range(problem)
    conditions = []
    # friction that does not depend on temperature is the same at each
    falls = parameters.gamma > 0.0 and parameters.delta > 0.0
    for temperature in REFERENCE_TEMPERATURES if falls else REFERENCE_TEMPERATURES[1:2]:
        for speed in common_speeds(problem):
            friction = float(
                friction_torque(parameters, load=load, speed=speed, temperature=temperature)
            )
            decay = parameters.gamma * np.exp(-parameters.delta * temperature)
            weights = np.array([1.0, (parameters.beta + decay) * np.sqrt(speed)]) * 100 / friction
            per_run = np.kron(np.eye(len(design)), weights)
            within = per_run @ levels.covariance @ per_run.T
            model = LevelModel.of(within, ambient, day_to_day)
            fit = model.fit(levels.coefficients @ weights, design)
            conditions.append(
                ReferenceCondition(
                    temperature=float(temperature),
                    speed=speed,
                    load=load,
                    friction=friction,
                    change=fit.estimate(np.array([0.0, 1.0])),
                    extrapolated=not coldest - _TOLERANCE <= temperature <= warmest + _TOLERANCE,
                )
            )
    return tuple(conditions)


def common_speeds(problem: Problem) -> list[float]:
    """Return up to five speeds that all runs have, or the median speed if there are none.

    Parameters
    ----------
    problem : Problem
        All runs.

    Returns
    -------
    list of float
        Speeds. [deg/s]
    """
    layout, table = problem.layout, problem.table
    speed = layout.means(table.speed[:, np.newaxis])[:, 0]
    level = speed_level(speed)
    runs = len(problem.runs)
    levels = [one for one in np.unique(level) if len(np.unique(layout.run[level == one])) == runs]
    if not levels:
        return [float(np.median(speed))]
    chosen = np.unique(np.linspace(0, len(levels) - 1, min(len(levels), _MOST_SPEEDS)).round())
    return [float(np.median(speed[level == levels[int(number)]])) for number in chosen]


def _common_range(problem: Problem) -> tuple[float, float]:
    """Return the temperature range that all runs cover [°C]."""
    temperature, run = problem.table.temperature, problem.table.run
    of_runs = [temperature[run == number] for number in np.unique(run)]
    return max(float(one.min()) for one in of_runs), min(float(one.max()) for one in of_runs)
