"""How high the friction of each run lies above what all runs have in common.

All runs share equation (16), and a gear that is not as warm as the motor's sensor: its temperature
lies between motor and housing, or lags behind the motor. So heating and cooling, cold days and long
ones are no change by themselves. About that, each run gets a level of its own, estimated together
with the rest by generalised least squares. Noise is that of :mod:`frictioncli.model.noise`: points,
pairs and a slow drift within each run.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.noise_averaged_fit import RANK, averaged_fit, estimable
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects import thermal_lag
from frictioncli.effects.availability import missing_columns
from frictioncli.linear_algebra import least_squares_residual
from frictioncli.model.noise import Noise, plausible_noise


@dataclass(frozen=True, slots=True, kw_only=True)
class Levels:
    """The friction of each run against what all runs share.

    Only differences between runs have a meaning: what they have in common belongs to the model.

    Attributes
    ----------
    coefficients : ndarray, shape (runs, shapes)
        Of what may change, for each run. [N·m for a constant]
    covariance : ndarray, shape (runs * shapes, runs * shapes)
        By noise within the runs, in the order of the flattened coefficients.
    comparable : bool
        Whether the runs share enough conditions for all of that to be compared.
    """

    coefficients: Array
    covariance: Array
    comparable: bool


def noises_of(problem: Problem, load_scale: Array) -> list[tuple[Noise, float]]:
    """Return noises that agree with what is left when every run has levels of its own.

    Parameters
    ----------
    problem, load_scale
        As of :func:`run_levels`.
    """
    layout = problem.layout
    misfit = _misfit(problem, load_scale)
    design, _ = _design(problem, constant_and_viscous(problem), misfit)
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
    shapes: Array,
    noises: Sequence[tuple[Noise, float]],
    load_scale: Array,
) -> Levels:
    """Return the levels of each run.

    Parameters
    ----------
    problem : Problem
        All runs of a joint, with the base model fitted to them.
    shapes : ndarray, shape (pairs, shapes)
        What may change from run to run, as one value per pair: a column of ones is friction that
        changes by the same torque at every speed and temperature.
    noises : sequence of (Noise, float)
        Noises and how plausible they are.
    load_scale : ndarray, shape (runs,)
        Load torque of each run against the common gravity: friction that grows with another
        payload's weight is no change of the joint. [-]
    """
    layout = problem.layout
    misfit = _misfit(problem, load_scale)
    design, size = _design(problem, shapes, misfit)
    count = len(problem.runs) * shapes.shape[1]
    found, covariance = averaged_fit(
        design, misfit, noises, time=layout.time, run=layout.run, bins=layout.bins, count=count
    )
    scale = size[:count]
    return Levels(
        coefficients=(found / scale).reshape(-1, shapes.shape[1]),
        covariance=covariance / np.outer(scale, scale),
        comparable=bool(shapes.any(axis=0).all())
        and estimable(design, _differences(size, count, shapes.shape[1])),
    )


def _misfit(problem: Problem, load_scale: Array) -> Array:
    """Return the misfit of the pairs' mean friction, each run with the load that it had. [N·m]."""
    weight = problem.parameters.alpha * np.square(problem.table.load)
    heavier = weight * (np.square(load_scale[problem.table.run]) - 1)
    return problem.layout.means((problem.friction_misfit - heavier)[:, np.newaxis])[:, 0]


def _design(problem: Problem, shapes: Array, misfit: Array) -> tuple[Array, Array]:
    """Return unit columns, those of the runs first, and the lengths that they had."""
    own = (problem.layout.run[:, np.newaxis] == np.arange(len(problem.runs))).astype(float)
    changing = (own[:, :, np.newaxis] * shapes[:, np.newaxis, :]).reshape(len(own), -1)
    whole = np.hstack([changing, _shared(problem, changing, misfit)])
    size = np.linalg.norm(whole, axis=0)
    size = np.where(size > 0, size, 1.0)
    return whole / size, size


def constant(problem: Problem) -> Array:
    """Return the shape of friction that changes by the same torque everywhere."""
    return np.ones((len(problem.layout.time), 1))


def constant_and_viscous(problem: Problem) -> Array:
    """Return the shapes of friction whose constant and viscous parts change on their own."""
    table = problem.table
    viscous = (table.viscous * np.sqrt(table.speed))[:, np.newaxis]
    return np.hstack([constant(problem), problem.layout.means(viscous)])


def _shared(problem: Problem, changing: Array, misfit: Array) -> Array:
    """Return columns that all runs share: of the base, and of the gear's own temperature.

    That lies somewhere on the way from motor to housing; where the housing's temperature is not
    known, it follows the motor's with the delay that explains most.
    """
    layout, table = problem.layout, problem.table
    base = layout.means(problem.friction_base)
    housing = table.temperature_slope * (table.housing_temperature - table.motor_temperature)
    if np.isfinite(housing).all():
        return np.hstack([base, layout.means(housing[:, np.newaxis])])
    effect = thermal_lag.EFFECT
    if missing_columns(effect, table):
        return base
    tried = [
        np.hstack([base, layout.means(problem.basis(effect, shape).friction[:, :1])])
        for shape in effect.shapes(table)
    ]
    return min(tried, key=lambda columns: _left(np.hstack([changing, columns]), misfit))


def _left(design: Array, misfit: Array) -> float:
    """Return the sum of squares that a least-squares fit leaves. [(N·m)²]."""
    left = least_squares_residual(design, misfit, tolerance=RANK)
    return float(left @ left)


def _point_noise(problem: Problem) -> float:
    """Return the standard deviation of one angle bin about its pair. [N·m]."""
    layout, misfit = problem.layout, problem.friction_misfit
    inside = misfit - layout.means(misfit[:, np.newaxis])[layout.row_pair, 0]
    freedom = max(len(inside) - len(layout.bins), 1)
    floor = 1e-6 * max(float(np.mean(np.abs(problem.friction))), 1e-12)
    return max(float(np.sqrt(inside @ inside / freedom)), floor)


def _differences(size: Array, count: int, shapes: int) -> Array:
    """Return the differences between the levels of each run and those of the first."""
    rows = np.zeros((count - shapes, len(size)))
    for number, row in enumerate(rows, start=shapes):
        row[number % shapes], row[number] = -1 / size[number % shapes], 1 / size[number]
    return rows
