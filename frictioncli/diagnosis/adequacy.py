"""Tells whether any structure is left, whatever its cause.

General-purpose columns over every axis of the experiment are tested against the white misfit. They
name nothing; they tell that something is wrong where no effect of the catalogue explains it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from frictioncli.diagnosis.candidates import Channels, Projector, explained
from frictioncli.diagnosis.problem import Problem

Array = NDArray[np.float64]

_HARMONICS = 12
_WAVES = 6
_LEVELS = 8


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
        Reduction of the white sum of squares.
    freedom : int
        Columns that were tried.
    size : float
        RMS of what the base leaves of the structure, without what noise gives. [N·m]
    """

    axis: str
    channel: str
    p_value: float
    statistic: float
    freedom: int
    size: float


def structures(
    problem: Problem, channels: Channels, projector: Projector, misfit: Array
) -> list[Structure]:
    """Return the structure along every axis, the least likely by chance first.

    Parameters
    ----------
    problem, channels : Problem, Channels
        Data and whiteners.
    projector : Projector
        Takes out the base and the effects accepted.
    misfit : ndarray
        White misfit off them.
    """
    axes = _axes(problem)
    found = []
    for (axis, channel), raw in axes.items():
        nothing = np.zeros_like(raw)
        pair = (raw, nothing) if channel == "friction" else (nothing, raw)
        white = channels.whiten(*pair)
        part = projector.off(white)
        size = np.linalg.norm(part, axis=0)
        kept = size > 1e-3 * np.maximum(np.linalg.norm(white, axis=0), 1e-300)
        if not kept.any():
            continue
        statistic, coefficients, _ = explained(part[:, kept] / size[kept], misfit)
        freedom = int(np.linalg.matrix_rank(part[:, kept] / size[kept], tol=1e-6))
        once = float(stats.chi2.sf(statistic, freedom))
        excess = max(statistic - freedom, 0.0) / max(statistic, 1e-300)
        shown = channels.visible_size(part[:, kept] / size[kept] @ coefficients, channel)
        found.append(
            Structure(
                axis=axis,
                channel=channel,
                p_value=min(1.0, len(axes) * once),
                statistic=statistic,
                freedom=freedom,
                size=float(np.sqrt(excess) * shown),
            )
        )
    return sorted(found, key=lambda structure: structure.p_value)


def _axes(problem: Problem) -> dict[tuple[str, str], Array]:
    table = problem.table
    angle = np.radians(table.position)
    harmonics = np.column_stack(
        [wave(n * angle) for n in range(1, _HARMONICS + 1) for wave in (np.sin, np.cos)]
    )
    speed = _levels(table.speed)
    warm = _levels(table.temperature)
    unit = (table.clock - table.clock.min()) / max(float(np.ptp(table.clock)), 1e-9)
    time = np.column_stack([np.cos(np.pi * n * unit) for n in range(1, _WAVES + 1)])
    rising = _rising(problem)[:, np.newaxis]
    squared = np.square(table.load)[:, np.newaxis] / max(float(np.max(np.square(table.load))), 1e-9)
    return {
        ("speed", "friction"): speed,
        ("temperature", "friction"): np.hstack([warm * rising, warm * (1 - rising)]),
        ("angle", "friction"): harmonics,
        ("angle", "load"): harmonics,
        ("time", "friction"): time,
        ("time", "load"): np.hstack([time, time * np.cos(angle)[:, np.newaxis]]),
        ("load and speed", "friction"): squared * speed,
        ("load and temperature", "friction"): squared * warm,
        ("speed and temperature", "friction"): _products(speed, warm),
        ("speed", "load"): speed,
        ("temperature", "load"): np.hstack([warm, warm * np.cos(angle)[:, np.newaxis]]),
    }


def _levels(values: Array) -> Array:
    """Return an indicator column per level of a quantity, at most eight of even weight."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _LEVELS + 1)[1:-1]))
    return np.eye(len(edges) + 1)[np.searchsorted(edges, values, side="left")]


def _products(first: Array, second: Array) -> Array:
    return np.einsum("ij,ik->ijk", first, second).reshape(len(first), -1)


def _rising(problem: Problem) -> Array:
    """Return 1 where the temperature rises over the pairs about a row, else 0."""
    layout = problem.layout
    warm = layout.means(problem.table.temperature[:, np.newaxis])[:, 0]
    trend = np.gradient(np.convolve(np.pad(warm, 4, mode="edge"), np.full(9, 1 / 9), "valid"))
    return (trend > 0).astype(float)[layout.row_pair] if len(warm) > 1 else np.zeros(len(warm))
