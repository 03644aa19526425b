"""The base model with the causes found: refitted together, judged on data that it has not seen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.judgement import Score
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.effects.base import Basis, Parameter

_BLOCK = 12
"""Pairs drawn together when the gain's interval is made: neighbours are not independent."""

_DRAWS = 1000

_NUDGE = 0.01
"""Share of a shape parameter's range over which its derivative is taken."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Refit:
    """Changes of the base model, and effects, fitted together.

    The extended friction is the base's, plus its derivatives by the parameters times their changes,
    plus the effects: linear about the base, as the effects themselves are.

    Attributes
    ----------
    names : tuple of str
        Friction parameters that were fitted.
    changes : ndarray, shape (names,)
        Their changes from the base.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of the gravity torque, as of the problem. [N·m], [N·m/kg]
    effects : tuple of Score
        Effects with their shapes and coefficients.
    """

    names: tuple[str, ...]
    changes: Array
    gravity: Array
    effects: tuple[Score, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Extension(Refit):
    """A refit with its errors.

    Attributes
    ----------
    errors : ndarray
        Standard errors of the changes, the gravity and the effects' coefficients, in this order.
    shape_errors : ndarray
        Standard errors of the effects' shape parameters, effect after effect; 0 where the data
        cannot tell it.
    """

    errors: Array
    shape_errors: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Gain:
    """What an extension is worth.

    Attributes
    ----------
    basis : {"new_run", "within_run"}
        Whether the data were new to the extension.
    before, after : float
        RMS misfit of the simulated torque without and with it. [N·m]
    reduction : float
        Share of the misfit that it takes away.
    interval : (float, float)
        95 % interval of that share.
    floor : float
        RMS of what no model can predict: point and pair noise. [N·m]
    """

    basis: str
    before: float
    after: float
    reduction: float
    interval: tuple[float, float]
    floor: float


def refit(problem: Problem, weighing: WeightedFit, effects: Sequence[Score]) -> Refit:
    """Fit the base and effects together by weighted least squares; shapes stay as they were found.

    Parameters
    ----------
    problem : Problem
        Data with the base model.
    weighing : WeightedFit
        Weights of both channels.
    effects : sequence of Score
        Effects with the shapes found.
    """
    friction, load = _columns(problem, effects)
    step = weighing.coefficients(friction, load, (problem.friction_misfit, problem.load_misfit))
    widths = [len(one.effect.coefficients) for one in effects]
    ends = np.cumsum([len(problem.names), len(problem.gravity), *widths])
    changes, gravity, *own, _ = np.split(step, ends)
    return Refit(
        names=problem.names,
        changes=changes,
        gravity=problem.gravity + gravity,
        effects=tuple(
            replace(one, coefficients=values) for one, values in zip(effects, own, strict=True)
        ),
    )


def extend(problem: Problem, weighing: WeightedFit, effects: Sequence[Score]) -> Extension:
    """Fit the base and effects together, with errors; parameters as :func:`refit`.

    That shapes are uncertain too widens the errors of everything that depends on them, by the
    derivatives of the effects by their shapes.
    """
    fitted = refit(problem, weighing, effects)
    columns = _columns(problem, fitted.effects)
    slopes = [_slope(problem, one, axis) for one in fitted.effects for axis in one.effect.shape]
    friction, load = (
        np.column_stack([columns[channel], *(slope[channel] for slope in slopes)])
        for channel in (0, 1)
    )
    errors = np.sqrt(np.maximum(np.diag(weighing.error_covariance(friction, load)), 0.0))
    count = columns[0].shape[1]
    return Extension(
        names=fitted.names,
        changes=fitted.changes,
        gravity=fitted.gravity,
        effects=fitted.effects,
        errors=errors[:count],
        shape_errors=errors[count:],
    )


def _columns(problem: Problem, effects: Sequence[Score]) -> tuple[Array, Array]:
    """Return the columns of base and effects in friction and load, shape (rows, columns) each."""
    bases = [base_rows(problem), *(problem.basis(one.effect, one.shape) for one in effects)]
    friction, load = (np.hstack([basis[channel] for basis in bases]) for channel in (0, 1))
    return friction, load


def _slope(problem: Problem, one: Score, axis: Parameter) -> Basis:
    """Return what an effect changes by per unit of a shape parameter, shape (rows,) each."""
    place = axis.share(one.shape[axis.name])
    ends = [axis.at(min(max(place + step, 0.0), 1.0)) for step in (-_NUDGE, _NUDGE)]
    low, high = (problem.basis(one.effect, one.shape | {axis.name: value}) for value in ends)
    width = ends[1] - ends[0]
    return Basis(
        (high.friction - low.friction) @ one.coefficients / width,
        (high.load - low.load) @ one.coefficients / width,
    )


def misfits(problem: Problem, fitted: Refit) -> tuple[Array, Array]:
    """Return what base and effects leave of both channels, shape (rows,) each. [N·m]."""
    changes = np.concatenate([fitted.changes, fitted.gravity - problem.gravity])
    base_friction, base_load = base_rows(problem)
    friction = problem.friction_misfit - base_friction @ changes
    load = problem.load_misfit - base_load @ changes
    for one in fitted.effects:
        basis = problem.basis(one.effect, one.shape)
        friction = friction - basis.friction @ one.coefficients
        load = load - basis.load @ one.coefficients
    return friction, load


def measured_gain(
    problem: Problem, extension: Extension, *, basis: str, floor: float, seed: int
) -> Gain:
    """Return what an extension takes away of the misfit of the simulated torque.

    Parameters
    ----------
    problem : Problem
        Rows to be judged on, with the base model of the extension's own problem.
    extension : Extension
        The extension.
    basis : {"new_run", "within_run"}
        Whether these rows were new to it.
    floor : float
        RMS of point and pair noise. [N·m]
    seed : int
        Seed of the drawn blocks.
    """
    before = problem.squared(problem.friction_misfit, problem.load_misfit)
    after = problem.squared(*misfits(problem, extension))
    low, high = reduction_interval(problem, before, after, seed)
    old, new = float(np.sqrt(np.mean(before))), float(np.sqrt(np.mean(after)))
    return Gain(
        basis=basis,
        before=old,
        after=new,
        reduction=1 - new / max(old, 1e-300),
        interval=(low, high),
        floor=floor,
    )


def reduction_interval(
    problem: Problem, before: Array, after: Array, seed: int
) -> tuple[float, float]:
    """Return the 95 % interval of the share of RMS misfit that is taken away.

    Blocks of neighbouring pairs are drawn together, before and after alike.

    Parameters
    ----------
    problem : Problem
        The rows.
    before, after : ndarray, shape (rows,)
        Squared misfit without and with what is judged. [(N·m)²]
    seed : int
        Seed of the drawn blocks.
    """
    pair = problem.layout.row_pair
    sums = np.column_stack([np.bincount(pair, weights=values) for values in (before, after)])
    blocks = np.add.reduceat(sums, np.arange(0, len(sums), _BLOCK), axis=0)
    generator = np.random.default_rng(seed)
    drawn = blocks[generator.integers(0, len(blocks), (_DRAWS, len(blocks)))].sum(axis=1)
    share = 1 - np.sqrt(drawn[:, 1] / np.maximum(drawn[:, 0], 1e-300))
    low, high = np.quantile(share, [0.025, 0.975])
    return float(low), float(high)
