"""One step of the search: base and accepted effects against every rival, in both channels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from frictioncli.diagnosis.bench import Bench, Catalogue, Modes, modes_of, point_noise
from frictioncli.diagnosis.columns import (
    Columns,
    Hypothesis,
    basis_columns,
    hypothesis_of,
    joined,
    left_of_base,
    main_channel,
)
from frictioncli.diagnosis.joint import Fitted, Side, noise_of, solved
from frictioncli.diagnosis.judged import Judged, Score
from frictioncli.diagnosis.problem import Problem
from frictioncli.diagnosis.scan import (
    Null,
    Scan,
    Setting,
    drawn_inside,
    null_of,
    scan,
    weighted_gram,
)
from frictioncli.diagnosis.significance import Chance, chance_of, log_evidence
from frictioncli.diagnosis.weighing import Weighing, Weights
from frictioncli.effects.base import Effect
from frictioncli.model.noise import Noise

Array = NDArray[np.float64]
Settings = tuple[Setting, Setting]

DRAWS = 200
"""Draws of noise from which it is learned what chance gives."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """Base and accepted effects under the noise that suits them.

    Attributes
    ----------
    bench : Bench
        The data and their noises.
    accepted : tuple of Score
        Effects accepted so far.
    base : Columns
        Columns of the base and of those effects.
    point : (float, float)
        Noise of a row about its pair in friction and load. [N·m]
    null : (Null, Null)
        The base with those effects alone, in friction and load.
    known : (Modes, Modes)
        Modes of the base's columns and the misfit, at each correlation time.
    fit : Fitted
        The same in both channels together.
    """

    bench: Bench
    accepted: tuple[Score, ...]
    base: Columns
    point: tuple[float, float]
    null: tuple[Null, Null]
    known: tuple[Modes, Modes]
    fit: Fitted

    @classmethod
    def of(cls, bench: Bench, accepted: Sequence[Score]) -> "Step":
        """Return the step with these effects accepted."""
        problem = bench.problem
        bases = [problem.basis(score.effect, score.shape) for score in accepted]
        base = joined([bench.base, *(basis_columns(problem, basis) for basis in bases)])
        point = (
            point_noise(problem, problem.friction_misfit, [b.friction for b in bases], "friction"),
            point_noise(problem, problem.load_misfit, [b.load for b in bases], "load"),
        )
        friction, load = (
            null_of(spectra, part.means, misfit.means)
            for spectra, part, misfit in zip(
                bench.spectra, base.channels, bench.misfit.channels, strict=True
            )
        )
        known = modes_of(bench, joined([base, bench.misfit]))
        null = (friction, load)
        settings = (friction.best, load.best)
        nothing = base.take(slice(0, 0))
        none = tuple(part.means[:, :0] for part in base.channels)
        fit = _solved(bench, point, null, settings, base, known, nothing, (none[0], none[1]))
        return cls(
            bench=bench,
            accepted=tuple(accepted),
            base=base,
            point=point,
            null=null,
            known=known,
            fit=fit,
        )

    @property
    def problem(self) -> Problem:
        """The data."""
        return self.bench.problem

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
        generator = np.random.default_rng(seed)
        scans = tuple(
            scan(spectra, null, modes, catalogue.groups, draws, generator)
            for spectra, null, modes in zip(
                self.bench.spectra, self.null, catalogue.modes, strict=True
            )
        )
        drawn = sum(one.drawn for one in scans)
        if draws:
            base, rivals = (
                np.vstack(
                    [
                        part.inside / point
                        for part, point in zip(columns.channels, self.point, strict=True)
                    ]
                )
                for columns in (self.base, catalogue.columns)
            )
            drawn = drawn + drawn_inside(base, rivals, catalogue.groups, draws, generator)
        found, first = {}, 0
        for hypothesis in catalogue.hypotheses:
            last = first + len(hypothesis.shapes)
            fits = []
            for group in range(first, last):
                chosen = catalogue.groups.columns(group)
                settings = _setting(scans[0], group), _setting(scans[1], group)
                modes = tuple(
                    part[setting[0]][:, chosen]
                    for part, setting in zip(catalogue.modes, settings, strict=True)
                )
                fits.append(
                    self._fitted(catalogue.columns.take(chosen), (modes[0], modes[1]), settings)
                )
            chance = chance_of(np.asarray(drawn)[first:last].max(axis=0, initial=0.0))
            found[hypothesis.name] = self._judged(
                hypothesis, fits, chance, len(catalogue.hypotheses)
            )
            first = last
        return found

    def noise(self) -> tuple[Noise, Noise]:
        """Return the noise of friction and load that suits base and accepted effects."""
        friction, load = (
            noise_of(spectra, null.best, scale, point)
            for spectra, null, scale, point in zip(
                self.bench.spectra, self.null, self.fit.scales, self.point, strict=True
            )
        )
        return friction, load

    def weighing(self) -> Weighing:
        """Return the weights of estimates that must predict."""
        layout, extra = self.problem.layout, self.problem.temperature_variance
        friction, load = self.noise()
        return Weighing(
            Weights.of(layout, friction, extra), Weights.of(layout, load, np.zeros_like(extra))
        )

    def refined(self, found: Score) -> Score:
        """Return a score with its shape searched off the grid, under the noise that suits it."""
        effect, axes = found.effect, found.effect.shape
        if not axes or effect.moments is not None:
            # every moment worth trying has been tried
            return self._scored(effect, found.shape, self._suited(effect, found.shape))
        settings = self._suited(effect, found.shape)
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
        scans = [
            scan(spectra, null, modes, alone.groups, 0, np.random.default_rng(0))
            for spectra, null, modes in zip(self.bench.spectra, self.null, alone.modes, strict=True)
        ]
        return _setting(scans[0], 0), _setting(scans[1], 0)

    def _scored(self, effect: Effect, shape: dict[str, float], settings: Settings) -> Score:
        """Return an effect's score at one shape; its statistic is 0 if it is not physical."""
        hypothesis = hypothesis_of(effect, self.problem, [shape])
        modes = tuple(
            spectra.modes(spectra.spectra[setting[0]], spectra.scaled(part.means))
            for spectra, setting, part in zip(
                self.bench.spectra, settings, hypothesis.columns.channels, strict=True
            )
        )
        fit = self._fitted(hypothesis.columns, (modes[0], modes[1]), settings)
        base = self.base.count
        coefficients, covariance = fit.coefficients[base:], fit.covariance[base:, base:]
        allowed = hypothesis.allows(coefficients, covariance)
        statistic = 2 * (fit.likelihood - self.fit.likelihood) if allowed else 0.0
        return Score(effect, shape, coefficients, covariance, statistic)

    def _judged(
        self, hypothesis: Hypothesis, fits: Sequence[Fitted], chance: Chance, rivals: int
    ) -> Judged:
        base = self.base.count
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

    def _fitted(self, columns: Columns, modes: tuple[Array, Array], settings: Settings) -> Fitted:
        return _solved(
            self.bench, self.point, self.null, settings, self.base, self.known, columns, modes
        )

    def size(self, score: Score) -> float:
        """Return the RMS torque of an effect in the channel where it shows most. [N·m].

        Several columns of an effect may cancel each other and leave the rest to the base; so only
        the part that the base cannot take has a size, unless it is the effect's only column.
        """
        if len(score.coefficients) > 1:
            return self.visible(score)
        basis = self.problem.basis(score.effect, score.shape)
        torque = main_channel(basis, score.effect) @ score.coefficients
        return float(np.sqrt(np.mean(np.square(torque))))

    def visible(self, score: Score) -> float:
        """Return the RMS torque of an effect that the base model cannot take. [N·m]."""
        basis = self.problem.basis(score.effect, score.shape)
        torque = main_channel(basis, score.effect) @ score.coefficients
        left = left_of_base(self.problem, torque, score.effect.channel)
        return float(np.sqrt(np.mean(np.square(left))))


def _solved(
    bench: Bench,
    point: tuple[float, float],
    null: tuple[Null, Null],
    settings: Settings,
    base: Columns,
    known: tuple[Modes, Modes],
    rival: Columns,
    modes: tuple[Array, Array],
) -> Fitted:
    """Fit base and a rival under given noises of friction and load."""
    inside, between, sides = [], [], []
    for number, (time, strength) in enumerate(settings):
        own, other, misfit = (part.channels[number].inside for part in (base, rival, bench.misfit))
        rows = np.hstack([own, other, misfit])
        inside.append(np.asarray(rows.T @ rows) / point[number] ** 2)
        first = known[number][time]
        whole = np.hstack([first[:, :-1], modes[number], first[:, -1:]])
        spectra, setting = bench.spectra[number], (time, strength)
        between.append(weighted_gram(spectra, setting, whole))
        determinant = float(null[number].determinant[setting])
        sides.append(Side(determinant, null[number].freedom))
    return solved((sides[0], sides[1]), inside, between, base.count)


def _setting(found: Scan, group: int) -> Setting:
    return int(found.of_group[group, 0]), int(found.of_group[group, 1])
