"""The change of friction at given temperatures and speeds."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.day_to_day import LevelEstimate, Scatter
from frictioncli.comparison.run_levels import Levels
from frictioncli.diagnosis.data.pair_layout import speed_level
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.model.friction import friction_torque
from frictioncli.schemas import REFERENCE_TEMPERATURES

_MOST_SPEEDS = 5

_REACHED = 0.5
"""A temperature is measured if a run comes so near: controllers register whole degrees. [°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """Friction at one temperature and speed, at the usual load, and how it changed.

    Attributes
    ----------
    temperature, speed : float
        Where. [°C], [deg/s]
    load : float
        Root mean square of the load torque in the data: how the load term changed on its own is not
        asked. [torque unit, or that of the log's load channel]
    friction : float
        Of the model that all runs share. [torque unit]
    change : LevelEstimate
        From the first run to the last. [%]
    extrapolated : bool
        Whether not all runs have measured this temperature.
    """

    temperature: float
    speed: float
    load: float
    friction: float
    change: LevelEstimate
    extrapolated: bool


def changes_at(
    problem: Problem,
    levels: Levels,
    surroundings: Array,
    day_to_day: float,
    design: Array,
) -> tuple[Condition, ...]:
    """Return the change at the reference temperatures and the speeds of the data.

    Parameters
    ----------
    problem : Problem
        All runs.
    levels : Levels
        Of a constant and a viscous part.
    surroundings : ndarray, shape (runs,)
        Temperature around the joint. [°C]
    day_to_day : float
        Assumed scatter. [%]
    design : ndarray, shape (runs, 2)
        Ones, and the course that the change takes from 0 to 1.
    """
    parameters = problem.parameters
    load = float(np.sqrt(np.mean(np.square(problem.table.load))))
    coldest, warmest = _common_range(problem)
    found = []
    for temperature in REFERENCE_TEMPERATURES:
        for speed in common_speeds(problem):
            friction = float(
                friction_torque(parameters, load=load, speed=speed, temperature=temperature)
            )
            fall = parameters.gamma * np.exp(-parameters.delta * temperature)
            weights = np.array([1.0, (parameters.beta + fall) * np.sqrt(speed)]) * 100 / friction
            spread = np.kron(np.eye(len(design)), weights)
            scatter = Scatter.of(spread @ levels.covariance @ spread.T, surroundings, day_to_day)
            fitted = scatter.fitted(levels.coefficients @ weights, design)
            found.append(
                Condition(
                    temperature=float(temperature),
                    speed=speed,
                    load=load,
                    friction=friction,
                    change=fitted.estimate(np.array([0.0, 1.0])),
                    extrapolated=not coldest - _REACHED <= temperature <= warmest + _REACHED,
                )
            )
    return tuple(found)


def common_speeds(problem: Problem) -> list[float]:
    """Return speeds that all runs have, at most five; the median of all where they have none."""
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
    """Return the temperatures that all runs have reached. [°C]."""
    temperature, run = problem.table.temperature, problem.table.run
    reached = [temperature[run == number] for number in np.unique(run)]
    return max(float(one.min()) for one in reached), min(float(one.max()) for one in reached)
