"""Lack-of-fit tests along every axis of the experiment, whatever the cause.

General-purpose columns, harmonics of the angle, levels of speed and temperature, slow functions of
time and products of these, are tested against base and accepted effects. They name no cause; they
show that the model is wrong where no effect of the catalogue explains how.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import reduced
from frictioncli.diagnosis.fit.hypotheses import Hypothesis
from frictioncli.diagnosis.fit.left_by_base import left_by, span_of, visible_size
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis
from frictioncli.linear_algebra import orthonormal_basis

_HARMONICS = 12
"""Harmonics of the joint angle."""

_WAVES = 6
"""Cosines over the time of the experiment."""

_LEVELS = 8
"""Quantile bins of a continuous quantity."""

_SLOW_HARMONICS = 4
"""Harmonics of the angle in products with another quantity."""

_MOST_OF_PAIRS = 0.5
"""Greatest number of columns that differ from pair to pair, as a share of the pairs."""

_MOST_LEVELS = 16
"""Speed levels with a column of their own."""


_SIGNIFICANT = 1e-3
"""Greatest p-value of structure that no effect explains."""

_NO_DOUBT = 1e-12
"""P-value below which there is no doubt that structure is there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """Lack of fit along one axis of the experiment.

    Attributes
    ----------
    axes : tuple of str
        The axis, or the two axes, along which it shows: ``position``, ``speed``, ``temperature``,
        ``time`` or ``load``.
    channel : {"friction", "load"}
        The channel.
    p_value : float
        Probability that noise explains as much, corrected for the number of axes (Bonferroni).
    statistic : float
        Twice the log likelihood ratio to base and accepted effects.
    freedom : int
        Number of coefficients that the data determine.
    size : float
        RMS of what base and effects leave of the structure, less what noise contributes. [N·m]
    interval : (float, float)
        95 % interval of that. [N·m]
    """

    axes: tuple[str, ...]
    channel: str
    p_value: float
    statistic: float
    freedom: int
    size: float
    interval: tuple[float, float]

    @property
    def axis(self) -> str:
        """The axes in words."""
        return " and ".join(self.axes)


def unnamed_structure(step: Step, margin: float, alpha: float) -> Structure | None:
    """Return the most significant structure beside the causes that is above the margin.

    Surely above it, or most probably where there is no doubt that it is there.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    margin : float
        Smallest size worth a name. [N·m]
    alpha : float
        Significance level.
    """
    for one in structures(step):
        least = one.size if one.p_value < _NO_DOUBT else one.interval[0]
        if one.p_value < min(_SIGNIFICANT, alpha) and least > margin:
            return one
    return None


def structures(step: Step) -> list[Structure]:
    """Return the lack of fit along every axis, ordered by p-value.

    The discrepancy counts with the amplitude that is expected of it, so that what is larger than
    any model's small errors stands out.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    """
    problem, precomputed = step.problem, step.precomputed
    axes = {
        place: _orthogonal(columns)
        for place, columns in _axes(problem).items()
        if _can_be_judged(problem, columns)
    }
    hypotheses = [_hypothesis(problem, *place, columns) for place, columns in axes.items()]
    catalogue = Catalogue.of(precomputed, hypotheses)
    tests = step.tested_against_expected(catalogue)
    accepted = [problem.basis(one.effect, one.shape) for one in step.accepted]
    span = span_of(problem, [*precomputed.measurement, *accepted])
    found = []
    for (names, channel), columns in axes.items():
        one = tests[_name(names, channel)]
        zeros = np.zeros_like(columns)
        basis = Basis(columns, zeros) if channel == "friction" else Basis(zeros, columns)
        left = left_by(span, basis)
        size, low, high = visible_size(left, one.coefficients, one.covariance)
        found.append(
            Structure(
                axes=names,
                channel=channel,
                p_value=one.p_value,
                statistic=one.statistic,
                freedom=one.freedom,
                size=size,
                interval=(low, high),
            )
        )
    return sorted(found, key=lambda structure: structure.p_value)


def _can_be_judged(problem: Problem, columns: Array) -> bool:
    """Return whether columns leave enough pairs to know the noise of the pair means by."""
    means = problem.layout.means(columns)
    rank = orthonormal_basis(means, tolerance=1e-7).shape[1]
    return rank <= _MOST_OF_PAIRS * len(means)


def _name(axes: tuple[str, ...], channel: str) -> str:
    return f"{' and '.join(axes)}, {channel}"


def _orthogonal(columns: Array) -> Array:
    """Return orthogonal columns of RMS 1 and the same span; harmonics overlap on part of a turn."""
    return orthonormal_basis(columns, tolerance=1e-7) * np.sqrt(len(columns))


def _hypothesis(
    problem: Problem, axes: tuple[str, ...], channel: str, columns: Array
) -> Hypothesis:
    """Return the hypothesis of free coefficients of columns in one channel."""
    zeros = np.zeros_like(columns)
    friction, load = (columns, zeros) if channel == "friction" else (zeros, columns)
    return Hypothesis(
        name=_name(axes, channel),
        shapes=({},),
        width=columns.shape[1],
        columns=reduced(problem.layout, friction, load),
        rms=np.sqrt(np.mean(np.square(columns), axis=0))[np.newaxis],
        lower=np.full(columns.shape[1], -np.inf),
        upper=np.full(columns.shape[1], np.inf),
    )


def _axes(problem: Problem) -> dict[tuple[tuple[str, ...], str], Array]:
    """Return columns by axis and channel, shape (rows, columns) each."""
    table = problem.table
    angle = np.radians(table.position)
    harmonics = np.column_stack(
        [wave(n * angle) for n in range(1, _HARMONICS + 1) for wave in (np.sin, np.cos)]
    )
    speed = _indicators(problem.layout.level)[problem.layout.row_pair]
    temperature = _levels(table.temperature)
    unit = (table.clock - table.clock.min()) / max(float(np.ptp(table.clock)), 1e-9)
    time = np.column_stack([np.cos(np.pi * n * unit) for n in range(1, _WAVES + 1)])
    rising = _rising(problem)[:, np.newaxis]
    squared = np.square(table.load)[:, np.newaxis] / max(float(np.max(np.square(table.load))), 1e-9)
    waves = harmonics[:, : 2 * _SLOW_HARMONICS]
    relative_temperature = ((table.temperature - table.temperature.mean()) / 10.0)[:, np.newaxis]
    relative_speed = (table.speed / table.speed.mean())[:, np.newaxis]
    return {
        (("speed",), "friction"): speed,
        (("temperature",), "friction"): np.hstack(
            [temperature * rising, temperature * (1 - rising)]
        ),
        (("position",), "friction"): harmonics,
        (("position",), "load"): harmonics,
        (("time",), "friction"): time,
        (("time",), "load"): np.hstack([time, time * np.cos(angle)[:, np.newaxis]]),
        (("load", "speed"), "friction"): squared * speed,
        (("load", "temperature"), "friction"): squared * temperature,
        (("speed", "temperature"), "friction"): _products(_levels(table.speed), temperature),
        (("position", "temperature"), "friction"): waves * relative_temperature,
        (("position", "speed"), "friction"): waves * relative_speed,
        (("position", "time"), "friction"): _products(waves, time[:, :2]),
        (("position", "speed"), "load"): waves * relative_speed,
        (("speed",), "load"): speed,
        (("temperature",), "load"): np.hstack(
            [temperature, temperature * np.cos(angle)[:, np.newaxis]]
        ),
    }


def _levels(values: Array) -> Array:
    """Return an indicator column per level of a quantity, at most eight, equally filled."""
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
    """Return the product of each column of one array with each of another, shape (rows, -1)."""
    return np.einsum("ij,ik->ijk", first, second).reshape(len(first), -1)


def _rising(problem: Problem) -> Array:
    """Return 1 where the temperature rises over nine neighbouring pairs, else 0, shape (rows,)."""
    layout = problem.layout
    temperature = layout.means(problem.table.temperature[:, np.newaxis])[:, 0]
    trend = np.gradient(
        np.convolve(np.pad(temperature, 4, mode="edge"), np.full(9, 1 / 9), "valid")
    )
    return (trend > 0).astype(float)[layout.row_pair]
