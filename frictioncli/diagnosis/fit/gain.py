"""By how much the RMS of a misfit is reduced, with a block-bootstrap interval."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK
from frictioncli.diagnosis.fit.extension import Extension, misfits
from frictioncli.linear_algebra import least_squares_residual

BLOCK = 12
"""Pairs per block of the bootstrap: the misfits of neighbouring pairs are not independent."""

_BLOCKS = 6
"""Least number of blocks: those of a run of few pairs are shorter."""

_DRAWS = 1000
"""Bootstrap samples."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Gain:
    """Reduction of the misfit by an extension.

    Attributes
    ----------
    basis : {"new_run", "within_run"}
        Whether the data were new to the extension.
    before, after : float
        RMS misfit of the simulated torque without and with it. [N·m]
    reduction : float
        Relative reduction of the RMS misfit.
    interval : (float, float)
        95 % interval of the reduction.
    floor : float
        RMS of the noise that is new with each pair, which no model can predict. [N·m]
    without_level : (float, float), optional
        The misfits before and after, each without its mean in both channels. [N·m]
    beside_days : (float, float), optional
        The same without what days differ by: the mean in both channels, and viscous friction. [N·m]
    """

    basis: str
    before: float
    after: float
    reduction: float
    interval: tuple[float, float]
    floor: float
    without_level: tuple[float, float] | None = None
    beside_days: tuple[float, float] | None = None


def measured_gain(
    problem: Problem,
    extension: Extension,
    *,
    base: Problem,
    basis: str,
    floor: float,
    seed: int,
) -> Gain:
    """Return by how much an extension reduces the misfit of the simulated torque.

    Parameters
    ----------
    problem : Problem
        Rows to be predicted, with the base model of the extension's own problem.
    extension : Extension
        The extension.
    base : Problem
        The same rows with the base model at the measured temperature.
    basis : {"new_run", "within_run"}
        Whether these rows were new to it.
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    seed : int
        Seed of the block bootstrap.
    """
    missed = (base.friction_misfit, base.load_misfit), misfits(problem, extension)
    before, after = (problem.squared(*both) for both in missed)
    gain = gain_of(problem, before, after, basis=basis, floor=floor, seed=seed)
    first, last = (rms_about_mean(problem, *both) for both in missed)
    before_days, after_days = (_rms_beside_days(problem, *both) for both in missed)
    return replace(gain, without_level=(first, last), beside_days=(before_days, after_days))


def gain_of(
    problem: Problem, before: Array, after: Array, *, basis: str, floor: float, seed: int
) -> Gain:
    """Return by how much a squared misfit is reduced.

    Parameters
    ----------
    problem : Problem
        The rows.
    before, after : ndarray, shape (rows,)
        Squared misfit without and with what is judged. [(N·m)²]
    basis : {"new_run", "within_run"}
        Whether these rows were new to it.
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    seed : int
        Seed of the block bootstrap.
    """
    first, last = float(np.sqrt(np.mean(before))), float(np.sqrt(np.mean(after)))
    return Gain(
        basis=basis,
        before=first,
        after=last,
        reduction=1 - last / max(first, 1e-300),
        interval=reduction_interval(problem, before, after, seed),
        floor=floor,
    )


def rms_about_mean(problem: Problem, friction: Array, load: Array) -> float:
    """Return the RMS of a misfit without its mean in either channel [N·m].

    Parameters
    ----------
    problem : Problem
        The rows.
    friction, load : ndarray, shape (rows,)
        The misfit in both channels. [N·m]
    """
    square = problem.squared(friction - np.mean(friction), load - np.mean(load))
    return float(np.sqrt(np.mean(square)))


def _rms_beside_days(problem: Problem, friction: Array, load: Array) -> float:
    """Return the RMS of a misfit without its mean, and without viscous friction [N·m]."""
    constant = np.ones((len(load), 1))
    viscous = problem.table.viscous * np.sqrt(problem.table.speed)
    square = problem.squared(
        least_squares_residual(np.column_stack([constant, viscous]), friction, tolerance=RANK),
        least_squares_residual(constant, load, tolerance=RANK),
    )
    return float(np.sqrt(np.mean(square)))


def reduction_interval(
    problem: Problem, before: Array, after: Array, seed: int
) -> tuple[float, float]:
    """Return the 95 % interval of the relative reduction of RMS misfit, by block bootstrap.

    Blocks of neighbouring pairs are drawn together, the same ones before and after.

    Parameters
    ----------
    problem : Problem
        The rows.
    before, after : ndarray, shape (rows,)
        Squared misfit without and with the extension. [(N·m)²]
    seed : int
        Seed of the block bootstrap.
    """
    pair = problem.layout.row_pair
    sums = np.column_stack([np.bincount(pair, weights=values) for values in (before, after)])
    length = max(min(BLOCK, len(sums) // _BLOCKS), 1)
    blocks = np.add.reduceat(sums, np.arange(0, len(sums), length), axis=0)
    generator = np.random.default_rng(seed)
    drawn = blocks[generator.integers(0, len(blocks), (_DRAWS, len(blocks)))].sum(axis=1)
    share = 1 - np.sqrt(drawn[:, 1] / np.maximum(drawn[:, 0], 1e-300))
    low, high = np.quantile(share, [0.025, 0.975])
    return float(low), float(high)
