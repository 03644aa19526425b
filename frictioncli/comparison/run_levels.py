"""Level of friction and of the load torque in each run.

All runs share equation (16) and the thermal lag of a gear that is not as warm as the motor's
sensor: its temperature lies between those of motor and housing, or lags behind that of the motor.
Heating, cooling, cold days and long days are therefore no change by themselves. In addition, each
run has a level of its own, estimated together with the rest by generalised least squares under the
noise of :mod:`frictioncli.model.noise`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.day_to_day import LevelModel
from frictioncli.comparison.noise_averaged_fit import RANK, is_estimable, noise_averaged_fit
from frictioncli.diagnosis.data.gravity import without_offset
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects import thermal_lag
from frictioncli.effects.base import missing_columns
from frictioncli.linear_algebra import least_squares_residual
from frictioncli.model.noise import Noise, plausible_noise

LOAD_DAY_TO_DAY = 0.5
"""Assumed day-to-day standard deviation of the load torque. [%]"""

_LEAST_GRAVITY = 0.05
"""Least standard deviation of the gravity torque, relative to the mean friction."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunLevels:
    """Friction components of each run.

    Only differences between runs are meaningful: the common part belongs to the model.

    Attributes
    ----------
    coefficients : ndarray, shape (runs, components)
        Coefficient of each component in each run. [N·m for the constant component]
    covariance : ndarray, shape (runs * components, runs * components)
        Covariance by noise within the runs, in the order of the flattened coefficients.
    comparable : bool
        Whether the runs share enough conditions for all differences to be estimable.
    """

    coefficients: Array
    covariance: Array
    comparable: bool


def plausible_noises(problem: Problem, load_scale: Array) -> list[tuple[Noise, float]]:
    """Return noises that agree with the residuals when each run has its own levels.

    Parameters
    ----------
    problem, load_scale
        As for :func:`run_levels`.

    Returns
    -------
    list of (Noise, float)
        Noises and their plausibility.
    """
    layout = problem.layout
    misfit = _pair_misfit(problem, load_scale)
    design, _ = _design(problem, constant_and_viscous_components(problem), misfit)
    return plausible_noise(
        residual=misfit,
        design=design,
        time=layout.time,
        run=layout.run,
        bins=layout.bins,
        point=_point_noise(problem),
    )


def run_levels(
    problem: Problem,
    components: Array,
    noises: Sequence[tuple[Noise, float]],
    load_scale: Array,
) -> RunLevels:
    """Return the levels of friction in each run.

    Parameters
    ----------
    problem : Problem
        All runs of a joint, with the base model fitted to them.
    components : ndarray, shape (pairs, components)
        Friction components that may change from run to run: a column of ones is friction that
        changes by the same torque at every speed and temperature.
    noises : sequence of (Noise, float)
        Noises and their plausibility.
    load_scale : ndarray, shape (runs,)
        Load torque of each run relative to the common gravity torque: friction that increases with
        the weight of another payload is no change of the joint. [-]

    Returns
    -------
    RunLevels
        Levels with their covariance.
    """
    layout = problem.layout
    misfit = _pair_misfit(problem, load_scale)
    design, length = _design(problem, components, misfit)
    count = len(problem.runs) * components.shape[1]
    coefficients, covariance = noise_averaged_fit(
        design, misfit, noises, time=layout.time, run=layout.run, bins=layout.bins, count=count
    )
    scale = length[:count]
    return RunLevels(
        coefficients=(coefficients / scale).reshape(-1, components.shape[1]),
        covariance=covariance / np.outer(scale, scale),
        comparable=bool(components.any(axis=0).all())
        and is_estimable(design, _differences(length, count, components.shape[1])),
    )


def constant_component(problem: Problem) -> Array:
    """Return the component of a constant change of friction, shape (pairs, 1)."""
    return np.ones((len(problem.layout.time), 1))


def constant_and_viscous_components(problem: Problem) -> Array:
    """Return the components of constant and of viscous friction, shape (pairs, 2)."""
    table = problem.table
    viscous = (table.viscous * np.sqrt(table.speed))[:, np.newaxis]
    return np.hstack([constant_component(problem), problem.layout.means(viscous)])


def load_levels(problem: Problem) -> tuple[Array, LevelModel] | None:
    """Return the level of the load torque in each run, and its covariance without a change.

    The load torque of each run is fitted by the common gravity torque times a factor, plus an
    offset of the sensor.

    Parameters
    ----------
    problem : Problem
        All runs.

    Returns
    -------
    levels : ndarray, shape (runs,)
        Factors less 1. [%]
    model : LevelModel
        Their covariance without a change. None in place of both where the joint carries nearly no
        load.
    """
    table = problem.table
    gravity = without_offset(problem.load_base) @ problem.gravity
    if np.std(gravity) < _LEAST_GRAVITY * np.mean(np.abs(problem.friction)):
        return None
    runs = len(problem.runs)
    levels, variances = np.zeros(runs), np.zeros(runs)
    for run in range(runs):
        own = table.run == run
        columns = np.column_stack([gravity[own], np.ones(own.sum())])
        coefficients, squares, rank, _ = np.linalg.lstsq(columns, problem.load[own], rcond=1e-9)
        if rank < 2:
            return None
        pairs = len(np.unique(table.pair[own]))
        residual_variance = float(squares[0]) / own.sum() if len(squares) else 0.0
        levels[run] = 100 * (coefficients[0] - 1)
        # deviations that the bins of a pair share do not average out: a pair counts once
        variances[run] = 1e4 * residual_variance / (np.var(gravity[own]) * max(pairs - 2, 1))
    # gravity does not depend on the ambient temperature
    return levels, LevelModel.of(np.diag(variances), np.zeros(runs), LOAD_DAY_TO_DAY)


def _pair_misfit(problem: Problem, load_scale: Array) -> Array:
    """Return the misfit of each pair's mean friction, given the load of its run [N·m]."""
    load_term = problem.parameters.alpha * np.square(problem.table.load)
    added = load_term * (np.square(load_scale[problem.table.run]) - 1)
    return problem.layout.means((problem.friction_misfit - added)[:, np.newaxis])[:, 0]


def _design(problem: Problem, components: Array, misfit: Array) -> tuple[Array, Array]:
    """Return columns of length 1, those of the runs first, and their original lengths."""
    runs = (problem.layout.run[:, np.newaxis] == np.arange(len(problem.runs))).astype(float)
    changing = (runs[:, :, np.newaxis] * components[:, np.newaxis, :]).reshape(len(runs), -1)
    columns = np.hstack([changing, _shared_columns(problem, changing, misfit)])
    length = np.linalg.norm(columns, axis=0)
    length = np.where(length > 0, length, 1.0)
    return columns / length, length


def _shared_columns(problem: Problem, changing: Array, misfit: Array) -> Array:
    """Return the columns that all runs share: base model and gear temperature.

    The gear temperature lies between those of motor and housing; where the latter is not known, it
    follows that of the motor with the lag that fits best.
    """
    layout, table = problem.layout, problem.table
    base = layout.means(problem.friction_base)
    housing = table.temperature_slope * (table.housing_temperature - table.motor_temperature)
    if np.isfinite(housing).all():
        return np.hstack([base, layout.means(housing[:, np.newaxis])])
    effect = thermal_lag.EFFECT
    if missing_columns(effect, table):
        return base
    candidates = [
        np.hstack([base, layout.means(problem.basis(effect, shape).friction[:, :1])])
        for shape in effect.shapes(table)
    ]
    return min(
        candidates, key=lambda columns: _residual_square(np.hstack([changing, columns]), misfit)
    )


def _residual_square(design: Array, misfit: Array) -> float:
    """Return the residual sum of squares of a least-squares fit [(N·m)²]."""
    residual = least_squares_residual(design, misfit, tolerance=RANK)
    return float(residual @ residual)


def _point_noise(problem: Problem) -> float:
    """Return the standard deviation of single angle bins within their pairs [N·m]."""
    floor = 1e-6 * max(float(np.mean(np.abs(problem.friction))), 1e-12)
    return max(problem.layout.point_deviation(problem.friction_misfit), floor)


def _differences(length: Array, count: int, components: int) -> Array:
    """Return contrasts of the levels of each run with those of the first."""
    contrasts = np.zeros((count - components, len(length)))
    for number, row in enumerate(contrasts, start=components):
        first = number % components
        row[first], row[number] = -1 / length[first], 1 / length[number]
    return contrasts
