"""One step of the search: noise, whiteners and misfit with some effects accepted."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.candidates import (
    Channels,
    Projector,
    Score,
    base_columns,
    effect_columns,
    explained,
    refined,
    score,
    visible,
)
from frictioncli.diagnosis.problem import Problem
from frictioncli.diagnosis.significance import chance, log_evidence, tries
from frictioncli.diagnosis.whitening import Whitener
from frictioncli.effects.base import Basis, Effect
from frictioncli.model.noise import Noise, plausible_noise

Array = NDArray[np.float64]

_PLAUSIBLE = 0.05
"""Noises less plausible than this are not asked."""

_TOLERANCE = 2.0
"""A coefficient may miss its physical bound by as many standard errors."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """An effect as it stands at one step of the search.

    Attributes
    ----------
    score : Score
        What it explains.
    p_value : float
        Probability that noise explains as much, corrected for shapes and for the catalogue.
    evidence : float
        Logarithm of its Bayes factor.
    tries : float
        Independent tries that its shapes are worth.
    freedom : int
        Coefficients that the data can tell.
    size_scale : float
        RMS of the effect in its channel for a white norm of 1. [N·m]
    """

    score: Score
    p_value: float
    evidence: float
    tries: float
    freedom: int
    size_scale: float


@dataclass(frozen=True, slots=True)
class View:
    """The data under one plausible noise: whitened, base and accepted effects taken out."""

    channels: Channels
    projector: Projector
    misfit: Array
    weight: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """The data with some effects accepted, seen under every plausible noise, likeliest first."""

    problem: Problem
    noise: tuple[Noise, Noise]
    views: tuple[View, ...]

    @property
    def channels(self) -> Channels:
        """Whiteners under the most plausible noise."""
        return self.views[0].channels

    @property
    def projector(self) -> Projector:
        """What takes out base and accepted effects under the most plausible noise."""
        return self.views[0].projector

    @property
    def misfit(self) -> Array:
        """White misfit off them under the most plausible noise."""
        return self.views[0].misfit

    @classmethod
    def of(cls, problem: Problem, accepted: Sequence[Score]) -> "Step":
        """Return the step with these effects accepted: noise estimated, base projected out."""
        bases = [problem.basis(score.effect, score.shape) for score in accepted]
        friction, load = _noises(problem, bases)
        layout, extra = problem.layout, problem.temperature_variance
        quiet = np.zeros_like(extra)
        load_whitener = Whitener.of(layout, load[0][0], quiet)
        kept = [(noise, weight) for noise, weight in friction if weight >= _PLAUSIBLE]
        views = []
        for noise, weight in kept:
            channels = Channels(Whitener.of(layout, noise, extra), load_whitener)
            projector, misfit = _projected(problem, channels, accepted)
            views.append(View(channels, projector, misfit, weight))
        return cls(problem=problem, noise=(kept[0][0], load[0][0]), views=tuple(views))

    def judged(self, effect: Effect, catalogue: int, seed: int) -> Candidate:
        """Return the candidate that an effect makes at this step."""
        found, columns = score(effect, self.problem, self.channels, self.projector, self.misfit)
        generator = np.random.default_rng([seed, *effect.name.encode()])
        count, freedom = tries(columns, generator)
        p_value = min(1.0, catalogue * self._chance(found, freedom, count))
        basis = self.problem.basis(effect, found.shape)
        raw = np.sqrt(np.mean(np.square(main_channel(basis, effect)), axis=0))
        size = np.linalg.norm(columns[:, _index(found)], axis=0)
        return Candidate(
            score=found,
            p_value=p_value,
            evidence=log_evidence(found.grid, freedom),
            tries=count,
            freedom=freedom,
            size_scale=float(np.sqrt(np.sum(raw**2)) / max(np.sqrt(np.sum(size**2)), 1e-300)),
        )

    @property
    def weighing(self) -> Channels:
        """Whiteners that only weigh, for estimates that must predict."""
        layout, extra = self.problem.layout, self.problem.temperature_variance
        friction, load = self.noise
        return Channels(
            Whitener.weighing(layout, friction, extra),
            Whitener.weighing(layout, load, np.zeros_like(extra)),
        )

    def refined(self, found: Score) -> Score:
        """Return a score with its shape searched off the grid."""
        return refined(found, self.problem, self.channels, self.projector, self.misfit)

    def size(self, found: Score) -> float:
        """Return the RMS torque of an effect in the channel where it shows most. [N·m].

        Several columns of an effect may cancel each other and leave the rest to the base; of such
        an effect only the part that the base cannot take has a size.
        """
        effect = found.effect
        if len(found.coefficients) == 1:
            columns = main_channel(self.problem.basis(effect, found.shape), effect)
            return float(np.sqrt(np.mean(np.square(columns @ found.coefficients))))
        white = effect_columns(effect, self.problem, self.channels, found.shape)
        return self.channels.visible_size(
            visible(white, self.projector) @ found.coefficients, effect.channel
        )

    def _chance(self, found: Score, freedom: int, count: float) -> float:
        """Return the chance of a score, averaged over the noises that agree with the data."""
        once = chance(found.statistic, freedom, count)
        if once > 0.05 or len(self.views) == 1:
            return once
        total = weight_sum = 0.0
        for view in self.views:
            columns = effect_columns(found.effect, self.problem, view.channels, found.shape)
            statistic = explained(visible(columns, view.projector), view.misfit)[0]
            total += view.weight * chance(statistic, freedom, count)
            weight_sum += view.weight
        return total / weight_sum


def _index(found: Score) -> int:
    return int(np.argmax(found.grid))


def main_channel(basis: Basis, effect: Effect) -> Array:
    """Return an effect's columns in the channel where it shows most."""
    return basis.friction if effect.channel == "friction" else basis.load


def physical(found: Score) -> bool:
    """Return whether the coefficients lie within their physical bounds, but for their error."""
    errors = np.sqrt(np.maximum(np.diag(found.covariance), 0.0))
    return all(
        parameter.lower - _TOLERANCE * error <= value <= parameter.upper + _TOLERANCE * error
        for parameter, value, error in zip(
            found.effect.coefficients, found.coefficients, errors, strict=True
        )
    )


def _projected(
    problem: Problem, channels: Channels, accepted: Sequence[Score]
) -> tuple[Projector, Array]:
    columns = [effect_columns(s.effect, problem, channels, s.shape) for s in accepted]
    projector = Projector.of(base_columns(problem, channels, columns))
    raw = channels.whiten(
        problem.friction_misfit[:, np.newaxis], problem.load_misfit[:, np.newaxis]
    )
    return projector, projector.off(raw)[:, 0]


def _noises(
    problem: Problem, bases: Sequence[Basis]
) -> tuple[list[tuple[Noise, float]], list[tuple[Noise, float]]]:
    """Return the plausible noises of both channels, with the accepted effects taken out."""
    friction = np.hstack([problem.friction_base, *(basis.friction for basis in bases)])
    load = np.hstack([problem.load_base, *(basis.load for basis in bases)])
    return (
        _noise(problem, problem.friction_misfit, friction, problem.temperature_variance),
        _noise(problem, problem.load_misfit, load, np.zeros_like(problem.temperature_variance)),
    )


def _noise(
    problem: Problem, misfit: Array, design: Array, extra: Array
) -> list[tuple[Noise, float]]:
    layout = problem.layout
    design = design[:, np.linalg.norm(design, axis=0) > 0]
    design = design / np.linalg.norm(design, axis=0)
    residual = misfit - design @ np.linalg.lstsq(design, misfit, rcond=1e-9)[0]
    means = layout.means(residual[:, np.newaxis])[:, 0]
    inside = residual - means[layout.row_pair]
    freedom = max(len(inside) - len(means), 1)
    point = max(float(np.sqrt(inside @ inside / freedom)), 1e-9)
    return plausible_noise(
        residual=means,
        design=layout.means(design),
        time=layout.time,
        run=layout.run,
        bins=layout.bins,
        point=point,
        extra=extra,
    )
