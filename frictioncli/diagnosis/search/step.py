"""One step of the search: base and accepted effects against every rival, in both channels."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.channel_likelihood import ChannelLikelihood
from frictioncli.diagnosis.fit.columns import (
    ChannelColumns,
    Hypothesis,
    ModelColumns,
    basis_columns,
    hypothesis_of,
    joined,
    left_of_base,
    main_channel,
)
from frictioncli.diagnosis.fit.judgement import Judged, Score
from frictioncli.diagnosis.fit.two_channel_fit import TwoChannelFit, solved, solved_each
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.noise.likelihood_scan import Setting, drawn_inside
from frictioncli.diagnosis.noise.significance import Chance, chance_of, log_evidence
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed, point_noise
from frictioncli.effects.base import Effect
from frictioncli.model.noise import Noise

Settings = tuple[Setting, Setting]
"""Places of the noises of friction and load."""

DRAWS = 200
"""Draws of noise from which it is learned what chance gives."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """Base and accepted effects under the noise that suits them.

    Attributes
    ----------
    bench : Precomputed
        The data and their noises.
    accepted : tuple of Score
        Effects accepted so far.
    sides : (ChannelLikelihood, Side)
        Base and those effects in friction and load.
    fit : TwoChannelFit
        The same in both channels together.
    """

    bench: Precomputed
    accepted: tuple[Score, ...]
    sides: tuple[ChannelLikelihood, ChannelLikelihood]
    fit: TwoChannelFit

    @classmethod
    def of(cls, bench: Precomputed, accepted: Sequence[Score]) -> "Step":
        """Return the step with these effects accepted."""
        problem = bench.problem
        bases = [problem.basis(score.effect, score.shape) for score in accepted]
        base = joined([bench.base, *(basis_columns(problem, basis) for basis in bases)])
        friction, load = (
            ChannelLikelihood.of(spectra, point, part, misfit)
            for spectra, point, part, misfit in zip(
                bench.spectra,
                point_noise(problem, bases),
                base.channels,
                bench.misfit.channels,
                strict=True,
            )
        )
        sides, best = (friction, load), (friction.null.best, load.null.best)
        nothing = base.take(slice(0, 0))
        fit = _fitted(sides, nothing, _modes(sides, nothing, best), best)
        return cls(bench=bench, accepted=tuple(accepted), sides=sides, fit=fit)

    @property
    def problem(self) -> Problem:
        """The data."""
        return self.bench.problem

    @property
    def base_count(self) -> int:
        """Number of columns of the base and the accepted effects."""
        return self.sides[0].base.count

    def judged(self, catalogue: Catalogue, seed: int, draws: int) -> dict[str, Judged]:
        """Return every hypothesis as it stands beside the base, by name.

        Parameters
        ----------
        catalogue : Catalogue
            Hypotheses.
        seed : int
            Seed of the draws.
        draws : int
            Number of draws of noise; without any all p-values are 1.
        """
        suited, drawn = self._scanned(catalogue, seed, draws)
        fits = self._fits(catalogue, suited)
        found, first = {}, 0
        for hypothesis in catalogue.hypotheses:
            own = slice(first, first + len(hypothesis.shapes))
            chance = chance_of(drawn[own].max(axis=0, initial=0.0))
            found[hypothesis.name] = self._judged(
                hypothesis, fits[own], chance, len(catalogue.hypotheses)
            )
            first = own.stop
        return found

    def _scanned(self, catalogue: Catalogue, seed: int, draws: int) -> tuple[list[Settings], Array]:
        """Return the noises that suit each group best, and what chance gives the groups.

        The latter has shape (groups, draws).
        """
        generator = np.random.default_rng(seed)
        friction, load = (
            side.scan(modes, catalogue.groups, draws, generator)
            for side, modes in zip(self.sides, catalogue.modes, strict=True)
        )
        drawn = friction.drawn + load.drawn
        if draws:
            base = self._white_inside([side.base for side in self.sides])
            rivals = self._white_inside(catalogue.columns.channels)
            drawn = drawn + drawn_inside(base, rivals, catalogue.groups, draws, generator)
        return list(zip(friction.settings, load.settings, strict=True)), drawn

    def _white_inside(self, channels: Sequence[ChannelColumns]) -> Array:
        """Return deviations inside pairs in units of their noise, load's below friction's."""
        return np.vstack(
            [part.inside / side.point for part, side in zip(channels, self.sides, strict=True)]
        )

    def _fits(self, catalogue: Catalogue, suited: Sequence[Settings]) -> list[TwoChannelFit]:
        """Return the fit of base and each group of a catalogue's columns under its noises.

        Groups as wide under the same noises are fitted at once.
        """
        alike = defaultdict(list)
        for group, settings in enumerate(suited):
            alike[settings, catalogue.groups.width[group]].append(group)
        found: dict[int, TwoChannelFit] = {}
        for (settings, width), groups in alike.items():
            columns = catalogue.groups.start[groups][:, np.newaxis] + np.arange(width)
            friction, load = (
                side.equations_each(part, modes[setting[0]], columns, setting)
                for side, part, modes, setting in zip(
                    self.sides,
                    catalogue.columns.channels,
                    catalogue.modes,
                    settings,
                    strict=True,
                )
            )
            fits = solved_each((friction, load), self.base_count)
            found |= dict(zip(groups, fits, strict=True))
        return [found[group] for group in range(len(suited))]

    def noise(self) -> tuple[Noise, Noise]:
        """Return the noise of friction and load that suits base and accepted effects."""
        friction, load = (
            side.noise(scale) for side, scale in zip(self.sides, self.fit.scales, strict=True)
        )
        return friction, load

    def weighing(self) -> WeightedFit:
        """Return the weights of estimates that must predict."""
        layout, extra = self.problem.layout, self.problem.temperature_variance
        friction, load = self.noise()
        return WeightedFit(
            Weights.of(layout, friction, extra), Weights.of(layout, load, np.zeros_like(extra))
        )

    def refined(self, found: Score) -> Score:
        """Return a score with its shape searched off the grid, under the noise that suits it."""
        effect, axes = found.effect, found.effect.shape
        settings = self._suited(effect, found.shape)
        if not axes or effect.moments is not None:
            # every moment worth trying has been tried
            return self._scored(effect, found.shape, settings)
        start = np.array([axis.share(found.shape[axis.name]) for axis in axes])
        step = np.array([0.5 / axis.points for axis in axes])

        def shape_at(unit: Array) -> dict[str, float]:
            return {axis.name: axis.at(float(u)) for axis, u in zip(axes, unit, strict=True)}

        search = minimize(
            lambda unit: -self._scored(effect, shape_at(unit), settings).statistic,
            start,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * len(axes),
            options={
                "initial_simplex": np.vstack(
                    [start, start + np.diag(np.where(start > 0.5, -step, step))]
                ),
                "maxfev": 25 * len(axes),
                "xatol": 2e-3,
                "fatol": 2e-2,
            },
        )
        shape = shape_at(search.x)
        return self._scored(effect, shape, self._suited(effect, shape))

    def _suited(self, effect: Effect, shape: dict[str, float]) -> Settings:
        """Return the noise that suits an effect at one shape."""
        alone = Catalogue.of(self.bench, [hypothesis_of(effect, self.problem, [shape])])
        return self._scanned(alone, 0, 0)[0][0]

    def _scored(self, effect: Effect, shape: dict[str, float], settings: Settings) -> Score:
        """Return an effect's score at one shape; its statistic is 0 if it is not physical."""
        hypothesis = hypothesis_of(effect, self.problem, [shape])
        columns, base = hypothesis.columns, self.base_count
        fit = _fitted(self.sides, columns, _modes(self.sides, columns, settings), settings)
        coefficients, covariance = fit.coefficients[base:], fit.covariance[base:, base:]
        allowed = hypothesis.allows(coefficients, covariance)
        statistic = 2 * (fit.likelihood - self.fit.likelihood) if allowed else 0.0
        return Score(effect, shape, coefficients, covariance, statistic)

    def _judged(
        self, hypothesis: Hypothesis, fits: Sequence[TwoChannelFit], chance: Chance, rivals: int
    ) -> Judged:
        base = self.base_count
        grid = np.array([2 * (fit.likelihood - self.fit.likelihood) for fit in fits])
        able = [
            fit.freedom > 0
            and hypothesis.allows(fit.coefficients[base:], fit.covariance[base:, base:])
            for fit in fits
        ]
        grid = np.where(able, np.maximum(grid, 0.0), 0.0)
        best = int(np.argmax(grid))
        fit = fits[best]
        return Judged(
            name=hypothesis.name,
            shape=hypothesis.shapes[best],
            coefficients=fit.coefficients[base:],
            covariance=fit.covariance[base:, base:],
            statistic=float(grid[best]),
            p_value=min(1.0, rivals * chance.beyond(float(grid[best]))),
            evidence=log_evidence(grid, fit.freedom),
            freedom=fit.freedom,
            chance=chance,
            size_scale=float(
                np.linalg.norm(hypothesis.raw[best])
                / max(float(np.linalg.norm(fit.visible)), 1e-300)
            ),
        )

    def size(self, score: Score) -> float:
        """Return the RMS torque of an effect in the channel where it shows most. [N·m].

        Several columns of an effect may cancel each other and leave the rest to the base; so only
        the part that the base cannot take has a size, unless it is the effect's only column.
        """
        if len(score.coefficients) > 1:
            return self.visible(score)
        return float(np.sqrt(np.mean(np.square(self._torque(score)))))

    def visible(self, score: Score) -> float:
        """Return the RMS torque of an effect that the base model cannot take. [N·m]."""
        left = left_of_base(self.problem, self._torque(score), score.effect.channel)
        return float(np.sqrt(np.mean(np.square(left))))

    def _torque(self, score: Score) -> Array:
        """Return the torque of an effect in the channel where it shows most, shape (rows,)."""
        basis = self.problem.basis(score.effect, score.shape)
        return np.asarray(main_channel(basis, score.effect) @ score.coefficients)


def _modes(
    sides: tuple[ChannelLikelihood, ChannelLikelihood], columns: ModelColumns, settings: Settings
) -> tuple[Array, Array]:
    """Return the modes of columns in friction and load, each at its noise's correlation time."""
    friction, load = (
        side.spectra.modes_at(time, part.means)
        for side, part, (time, _) in zip(sides, columns.channels, settings, strict=True)
    )
    return friction, load


def _fitted(
    sides: tuple[ChannelLikelihood, ChannelLikelihood],
    rival: ModelColumns,
    modes: tuple[Array, Array],
    settings: Settings,
) -> TwoChannelFit:
    """Return the fit of base and rival under given noises of friction and load."""
    friction, load = (
        side.equations(part, own, setting)
        for side, part, own, setting in zip(sides, rival.channels, modes, settings, strict=True)
    )
    return solved((friction, load), sides[0].base.count)
