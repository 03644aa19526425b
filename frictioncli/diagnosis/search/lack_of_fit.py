"""Tells whether any structure is left, whatever its cause.

General-purpose columns over every axis of the experiment are tested against the white misfit. They
name nothing; they tell that something is wrong where no effect of the catalogue explains it.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import Hypothesis, left_of_base, reduced
from frictioncli.diagnosis.search.precomputed import Catalogue
from frictioncli.diagnosis.search.step import DRAWS, Step
from frictioncli.linear_algebra import orthonormal_basis

_HARMONICS = 12
_WAVES = 6
_LEVELS = 8
_SLOW_HARMONICS = 4
_MOST_LEVELS = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """Structure along one axis of the experiment.

    Attributes
    ----------
    axis : str
        Where it shows.
    channel : str
        ``friction`` or ``load``.
    p_value : float
        Chance that noise gives as much, corrected for the number of axes.
    statistic : float
        Twice the log likelihood ratio to the base and the effects accepted.
    freedom : int
        Columns that the data can tell.
    size : float
        RMS of what base and effects leave of the structure, without what noise gives. [N·m]
    """

    axis: str
    channel: str
    p_value: float
    statistic: float
    freedom: int
    size: float


def structures(step: Step, seed: int) -> list[Structure]:
    """Return the structure along every axis, the least likely by chance first.

    Parameters
    ----------
    step : Step
        Base and the effects accepted.
    seed : int
        Seed of the noise that tells what chance gives.
    """
    problem = step.problem
    accepted = [problem.basis(score.effect, score.shape) for score in step.accepted]
    axes = {place: _even(raw) for place, raw in _axes(problem).items()}
    hypotheses = [_hypothesis(problem, axis, channel, raw) for (axis, channel), raw in axes.items()]
    judged = step.judged(Catalogue.of(step.bench, hypotheses), seed, DRAWS)
    found = []
    for (axis, channel), raw in axes.items():
        one = judged[f"{axis}, {channel}"]
        excess = max(one.statistic - one.freedom, 0.0) / max(one.statistic, 1e-300)
        shown = left_of_base(problem, raw @ one.coefficients, channel, accepted)
        found.append(
            Structure(
                axis=axis,
                channel=channel,
                p_value=one.p_value,
                statistic=one.statistic,
                freedom=one.freedom,
                size=float(np.sqrt(excess * np.mean(np.square(shown)))),
            )
        )
    return sorted(found, key=lambda structure: structure.p_value)


def _even(raw: Array) -> Array:
    """Return orthonormal columns of the same span: waves over part of a turn are much alike."""
    return orthonormal_basis(raw, tolerance=1e-7) * np.sqrt(len(raw))


def _hypothesis(problem: Problem, axis: str, channel: str, raw: Array) -> Hypothesis:
    nothing = np.zeros_like(raw)
    friction, load = (raw, nothing) if channel == "friction" else (nothing, raw)
    return Hypothesis(
        name=f"{axis}, {channel}",
        shapes=({},),
        width=raw.shape[1],
        columns=reduced(problem.layout, friction, load),
        raw=np.sqrt(np.mean(np.square(raw), axis=0))[np.newaxis],
        lower=np.full(raw.shape[1], -np.inf),
        upper=np.full(raw.shape[1], np.inf),
    )


def _axes(problem: Problem) -> dict[tuple[str, str], Array]:
    table = problem.table
    angle = np.radians(table.position)
    harmonics = np.column_stack(
        [wave(n * angle) for n in range(1, _HARMONICS + 1) for wave in (np.sin, np.cos)]
    )
    speed = _indicators(problem.layout.level)[problem.layout.row_pair]
    warm = _levels(table.temperature)
    unit = (table.clock - table.clock.min()) / max(float(np.ptp(table.clock)), 1e-9)
    time = np.column_stack([np.cos(np.pi * n * unit) for n in range(1, _WAVES + 1)])
    rising = _rising(problem)[:, np.newaxis]
    squared = np.square(table.load)[:, np.newaxis] / max(float(np.max(np.square(table.load))), 1e-9)
    waves = harmonics[:, : 2 * _SLOW_HARMONICS]
    warmth = ((table.temperature - table.temperature.mean()) / 10.0)[:, np.newaxis]
    fast = (table.speed / table.speed.mean())[:, np.newaxis]
    return {
        ("speed", "friction"): speed,
        ("temperature", "friction"): np.hstack([warm * rising, warm * (1 - rising)]),
        ("angle", "friction"): harmonics,
        ("angle", "load"): harmonics,
        ("time", "friction"): time,
        ("time", "load"): np.hstack([time, time * np.cos(angle)[:, np.newaxis]]),
        ("load and speed", "friction"): squared * speed,
        ("load and temperature", "friction"): squared * warm,
        ("speed and temperature", "friction"): _products(_levels(table.speed), warm),
        ("angle and temperature", "friction"): waves * warmth,
        ("angle and speed", "friction"): waves * fast,
        ("angle and time", "friction"): _products(waves, time[:, :2]),
        ("angle and speed", "load"): waves * fast,
        ("speed", "load"): speed,
        ("temperature", "load"): np.hstack([warm, warm * np.cos(angle)[:, np.newaxis]]),
    }


def _levels(values: Array) -> Array:
    """Return an indicator column per level of a quantity, at most eight of even weight."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _LEVELS + 1)[1:-1]))
    return np.eye(len(edges) + 1)[np.searchsorted(edges, values, side="left")]


def _indicators(level: Indices) -> Array:
    """Return an indicator column per level, the rarest ones together beyond sixteen."""
    names, place, count = np.unique(level, return_inverse=True, return_counts=True)
    common = np.argsort(-count)[:_MOST_LEVELS]
    column = np.full(len(names), len(common))
    column[common] = np.arange(len(common))
    return np.eye(len(common) + 1)[column[place]]


def _products(first: Array, second: Array) -> Array:
    return np.einsum("ij,ik->ijk", first, second).reshape(len(first), -1)


def _rising(problem: Problem) -> Array:
    """Return 1 where the temperature rises over the pairs about a row, else 0."""
    layout = problem.layout
    warm = layout.means(problem.table.temperature[:, np.newaxis])[:, 0]
    trend = np.gradient(np.convolve(np.pad(warm, 4, mode="edge"), np.full(9, 1 / 9), "valid"))
    return (trend > 0).astype(float)[layout.row_pair] if len(warm) > 1 else np.zeros(len(warm))
