"""One step of the search: every hypothesis tested against base and accepted effects."""

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
    ModelColumns,
    basis_columns,
    joined,
    main_channel,
    residual_of_base,
)
from frictioncli.diagnosis.fit.hypotheses import (
    EffectFit,
    Hypothesis,
    HypothesisTest,
    hypothesis_of,
)
from frictioncli.diagnosis.fit.two_channel_fit import TwoChannelFit, fit_candidates, fit_channels
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.noise.likelihood_scan import drawn_within
from frictioncli.diagnosis.noise.significance import (
    NullDistribution,
    fit_null_distribution,
    log_bayes_factor,
)
from frictioncli.diagnosis.noise.spectra import NoiseIndex
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed, point_noise
from frictioncli.effects.base import Effect
from frictioncli.model.noise import Noise

NoiseIndices = tuple[NoiseIndex, NoiseIndex]
"""Indices of the noise models of friction and load."""

DRAWS = 200
"""Draws of noise from which the null distribution of each statistic is estimated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """The null hypothesis of one step: base and accepted effects under the noise that suits them.

    Attributes
    ----------
    precomputed : Precomputed
        The data and the noise models.
    accepted : tuple of EffectFit
        Effects accepted so far.
    channels : (ChannelLikelihood, ChannelLikelihood)
        Base and those effects in friction and load.
    fit : TwoChannelFit
        The same in both channels together.
    """

    precomputed: Precomputed
    accepted: tuple[EffectFit, ...]
    channels: tuple[ChannelLikelihood, ChannelLikelihood]
    fit: TwoChannelFit

    @classmethod
    def of(cls, precomputed: Precomputed, accepted: Sequence[EffectFit]) -> "Step":
        """Return the step with these effects accepted."""
        problem = precomputed.problem
        bases = [problem.basis(one.effect, one.shape) for one in accepted]
        base = joined([precomputed.base, *(basis_columns(problem, basis) for basis in bases)])
        friction, load = (
            ChannelLikelihood.of(spectra, point, part, misfit)
            for spectra, point, part, misfit in zip(
                precomputed.spectra,
                point_noise(problem, bases),
                base.channels,
                precomputed.misfit.channels,
                strict=True,
            )
        )
        channels, best = (friction, load), (friction.null.best, load.null.best)
        empty = base.take(slice(0, 0))
        fit = _fitted(channels, empty, best)
        return cls(precomputed=precomputed, accepted=tuple(accepted), channels=channels, fit=fit)

    @property
    def problem(self) -> Problem:
        """The data."""
        return self.precomputed.problem

    @property
    def base_count(self) -> int:
        """Number of columns of the base and the accepted effects."""
        return self.channels[0].base.count

    def tested(self, catalogue: Catalogue, seed: int, draws: int) -> dict[str, HypothesisTest]:
        """Return the test of every hypothesis against the null hypothesis, by name.

        Parameters
        ----------
        catalogue : Catalogue
            Hypotheses.
        seed : int
            Seed of the draws.
        draws : int
            Number of draws of noise; without any all p-values are 1.
        """
        noises, drawn = self._scanned(catalogue, seed, draws)
        fits = self._fits(catalogue, noises)
        found, first = {}, 0
        for hypothesis in catalogue.hypotheses:
            groups = slice(first, first + len(hypothesis.shapes))
            null = fit_null_distribution(drawn[groups].max(axis=0, initial=0.0))
            found[hypothesis.name] = self._test(
                hypothesis, fits[groups], null, len(catalogue.hypotheses)
            )
            first = groups.stop
        return found

    def _scanned(
        self, catalogue: Catalogue, seed: int, draws: int
    ) -> tuple[list[NoiseIndices], Array]:
        """Return the noise models that suit each group best, and its statistics in noise alone.

        The latter have shape (groups, draws).
        """
        generator = np.random.default_rng(seed)
        friction, load = (
            channel.scan(modes, catalogue.groups, draws, generator)
            for channel, modes in zip(self.channels, catalogue.modes, strict=True)
        )
        drawn = friction.drawn + load.drawn
        if draws:
            base = self._white_deviations([channel.base for channel in self.channels])
            candidates = self._white_deviations(catalogue.columns.channels)
            drawn = drawn + drawn_within(base, candidates, catalogue.groups, draws, generator)
        return list(zip(friction.noises, load.noises, strict=True)), drawn

    def _white_deviations(self, columns: Sequence[ChannelColumns]) -> Array:
        """Return deviations within pairs in units of their noise, load's below friction's."""
        return np.vstack(
            [
                part.within / channel.point
                for part, channel in zip(columns, self.channels, strict=True)
            ]
        )

    def _fits(self, catalogue: Catalogue, noises: Sequence[NoiseIndices]) -> list[TwoChannelFit]:
        """Return the fit of base and each group of a catalogue's columns under its noise models.

        Groups of one width under the same noise models are fitted at once.
        """
        alike = defaultdict(list)
        for group, indices in enumerate(noises):
            alike[indices, catalogue.groups.width[group]].append(group)
        found: dict[int, TwoChannelFit] = {}
        for (indices, width), groups in alike.items():
            columns = catalogue.groups.start[groups][:, np.newaxis] + np.arange(width)
            friction, load = (
                channel.normal_equations_each(part, modes[index[0]], columns, index)
                for channel, part, modes, index in zip(
                    self.channels,
                    catalogue.columns.channels,
                    catalogue.modes,
                    indices,
                    strict=True,
                )
            )
            fits = fit_candidates((friction, load), self.base_count)
            found |= dict(zip(groups, fits, strict=True))
        return [found[group] for group in range(len(noises))]

    def noise(self) -> tuple[Noise, Noise]:
        """Return the noise of friction and load that suits base and accepted effects best."""
        friction, load = (
            channel.noise(scale)
            for channel, scale in zip(self.channels, self.fit.scales, strict=True)
        )
        return friction, load

    def weighted_fit(self) -> WeightedFit:
        """Return the weighted least squares by which predictions are made under this noise."""
        layout, extra = self.problem.layout, self.problem.temperature_variance
        friction, load = self.noise()
        return WeightedFit(
            Weights.of(layout, friction, extra), Weights.of(layout, load, np.zeros_like(extra))
        )

    def refined(self, found: EffectFit) -> EffectFit:
        """Return an effect with its shape optimised off the grid.

        The noise model stays that of the shape given during the search, and is chosen anew at the
        end.

        Parameters
        ----------
        found : EffectFit
            The effect at a shape of the grid, or near it.
        """
        effect, axes = found.effect, found.effect.shape
        noises = self._best_noises(effect, found.shape)
        if not axes or effect.moments is not None:
            # the grid already has every moment worth trying
            return self._effect_fit(effect, found.shape, noises)
        start = np.array([axis.share(found.shape[axis.name]) for axis in axes])
        step = np.array([0.5 / axis.points for axis in axes])

        def shape_at(unit: Array) -> dict[str, float]:
            return {axis.name: axis.at(float(u)) for axis, u in zip(axes, unit, strict=True)}

        search = minimize(
            lambda unit: -self._effect_fit(effect, shape_at(unit), noises).statistic,
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
        return self._effect_fit(effect, shape, self._best_noises(effect, shape))

    def _best_noises(self, effect: Effect, shape: dict[str, float]) -> NoiseIndices:
        """Return the noise models that suit an effect at one shape best."""
        alone = Catalogue.of(self.precomputed, [hypothesis_of(effect, self.problem, [shape])])
        return self._scanned(alone, 0, 0)[0][0]

    def _effect_fit(
        self, effect: Effect, shape: dict[str, float], noises: NoiseIndices
    ) -> EffectFit:
        """Return an effect fitted at one shape; its statistic is 0 if it is not physical."""
        hypothesis = hypothesis_of(effect, self.problem, [shape])
        columns, base = hypothesis.columns, self.base_count
        fit = _fitted(self.channels, columns, noises)
        coefficients, covariance = fit.coefficients[base:], fit.covariance[base:, base:]
        allowed = hypothesis.allows(coefficients, covariance)
        statistic = 2 * (fit.likelihood - self.fit.likelihood) if allowed else 0.0
        return EffectFit(effect, shape, coefficients, covariance, statistic)

    def _test(
        self,
        hypothesis: Hypothesis,
        fits: Sequence[TwoChannelFit],
        null: NullDistribution,
        hypotheses: int,
    ) -> HypothesisTest:
        """Return the test of a hypothesis from its fits at each shape, of so many hypotheses."""
        base = self.base_count
        grid = np.array([2 * (fit.likelihood - self.fit.likelihood) for fit in fits])
        physical = [
            fit.freedom > 0
            and hypothesis.allows(fit.coefficients[base:], fit.covariance[base:, base:])
            for fit in fits
        ]
        grid = np.where(physical, np.maximum(grid, 0.0), 0.0)
        best = int(np.argmax(grid))
        fit = fits[best]
        return HypothesisTest(
            name=hypothesis.name,
            shape=hypothesis.shapes[best],
            coefficients=fit.coefficients[base:],
            covariance=fit.covariance[base:, base:],
            statistic=float(grid[best]),
            p_value=min(1.0, hypotheses * null.p_value(float(grid[best]))),
            log_bayes_factor=log_bayes_factor(grid, fit.freedom),
            freedom=fit.freedom,
            null=null,
            size_scale=float(
                np.linalg.norm(hypothesis.rms[best])
                / max(float(np.linalg.norm(fit.visible)), 1e-300)
            ),
        )

    def size(self, fit: EffectFit) -> float:
        """Return the RMS torque of an effect in the channel where it shows most [N·m].

        Several columns of an effect may cancel each other and leave the rest to the base; so only
        the residual of the base counts, unless the effect has a single column.
        """
        if len(fit.coefficients) > 1:
            return self.visible(fit)
        return float(np.sqrt(np.mean(np.square(self._torque(fit)))))

    def visible(self, fit: EffectFit) -> float:
        """Return the RMS of an effect's torque after a fit of the base model to it [N·m]."""
        residual = residual_of_base(self.problem, self._torque(fit), fit.effect.channel)
        return float(np.sqrt(np.mean(np.square(residual))))

    def _torque(self, fit: EffectFit) -> Array:
        """Return the torque of an effect in the channel where it shows most, shape (rows,)."""
        basis = self.problem.basis(fit.effect, fit.shape)
        return np.asarray(main_channel(basis, fit.effect) @ fit.coefficients)


def _fitted(
    channels: tuple[ChannelLikelihood, ChannelLikelihood],
    candidate: ModelColumns,
    noises: NoiseIndices,
) -> TwoChannelFit:
    """Return the fit of base and candidate under given noise models of friction and load."""
    friction, load = (
        channel.normal_equations(part, channel.spectra.modes_at(index[0], part.means), index)
        for channel, part, index in zip(channels, candidate.channels, noises, strict=True)
    )
    return fit_channels((friction, load), channels[0].base.count)
