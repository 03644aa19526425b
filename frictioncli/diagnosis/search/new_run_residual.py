r"""What the runs seen leave of a new run's torque, and the amplitude of a cause in it.

The new run's misfit less the base and the other causes, as fitted to the runs seen, is

.. math:: r = N z + a\, u + e, \quad z \sim N(0, I), \quad e \sim N(0, V)

with the torque :math:`u` that the cause adds as fitted to the runs seen, the errors of base and
other causes :math:`N = X \Sigma^{1/2}` and the noise :math:`V`. The precision of *r* without *z* is

.. math:: M = V^{-1} - V^{-1} N (I + N^\mathsf{T} V^{-1} N)^{-1} N^\mathsf{T} V^{-1}

and the amplitude :math:`a = u^\mathsf{T} M r / u^\mathsf{T} M u` by generalised least squares.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.extension import misfits, refit, with_shapes
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.effects.base import Effect
from frictioncli.effects.history import history, presence
from frictioncli.model.noise import Noise, plausible_noise


@dataclass(frozen=True, slots=True)
class NewRunResidual:
    """The residual of a run kept out, and the torque that a cause would add there.

    Attributes
    ----------
    new : Problem
        The run.
    effect : Effect
        The cause.
    channels : (ChannelResidual, ChannelResidual)
        Friction and load.
    inverse : ndarray, shape (columns, columns)
        :math:`(I + N^T V^{-1} N)^{-1}` of both channels together.
    """

    new: Problem
    effect: Effect
    channels: tuple["ChannelResidual", "ChannelResidual"]
    inverse: Array

    @classmethod
    def of(
        cls,
        fit: EffectFit,
        problem: Problem,
        new: Problem,
        weighted_fit: WeightedFit,
        noises: tuple[Noise, Noise],
        others: Sequence[EffectFit],
        *,
        own_errors: bool = False,
    ) -> "NewRunResidual":
        """Return the residual of a run.

        Parameters
        ----------
        fit : EffectFit
            The cause.
        problem, new : Problem
            The runs seen, and the held-out run with the base model of the former.
        weighted_fit : WeightedFit
            Weights of the runs seen.
        noises : (Noise, Noise)
            Noise of friction and load there.
        others : sequence of EffectFit
            The other causes.
        own_errors : bool, optional
            Whether the errors of the cause's own coefficients and shape count, too: where it is
            there, its torque is that much off.
        """
        fitted = refit(problem, weighted_fit, [*others, fit])
        *rest, own = fitted.effects
        columns_of = with_shapes if own_errors else model_columns
        covariance = weighted_fit.error_covariance(*columns_of(problem, fitted.effects))
        ordered = [*rest, own]
        if not own_errors:
            kept = slice(0, -len(own.coefficients))
            ordered, covariance = rest, covariance[kept, kept]
        root = square_root(covariance)
        # a change is evaluated where it is there throughout, and multiplied by its history later
        shape = history([(0.0, 1.0)]) if fit.effect.moments is not None else fit.shape
        extra = (new.temperature_variance, np.zeros_like(new.layout.time))
        friction, load = (
            ChannelResidual.of(new, noise, known, torque @ own.coefficients, misfit, columns @ root)
            for noise, known, torque, misfit, columns in zip(
                noises,
                extra,
                new.basis(fit.effect, shape),
                misfits(new, replace(fitted, effects=tuple(rest))),
                columns_of(new, ordered),
                strict=True,
            )
        )
        return cls(new, fit.effect, (friction, load), _inverse(friction, load))

    def amplitude(self, shape: Mapping[str, float]) -> tuple[float, float]:
        """Return the amplitude of the cause at a shape, and its standard error [-].

        Parameters
        ----------
        shape : mapping of str to float
            The shape; of a change its history. The error is infinite where it adds no torque.
        """
        along, squared = self._products(shape)
        if not squared > 0:
            return 0.0, float("inf")
        return along / squared, float(1 / np.sqrt(squared))

    def evidence(self, shape: Mapping[str, float]) -> float:
        """Return the log likelihood of the cause as found, over that of its absence [-].

        Parameters
        ----------
        shape : mapping of str to float
            The shape; of a change its history.
        """
        along, squared = self._products(shape)
        return along - squared / 2

    def with_own_noise(self, shape: Mapping[str, float]) -> "NewRunResidual":
        """Return the same under a noise that counts what the model leaves of this run.

        A model predicts another day less well than the noise of the days seen allows. The noise of
        pair means is estimated anew with the cause in place, and taken where it is greater.

        Parameters
        ----------
        shape : mapping of str to float
            Shape of the cause.
        """
        there = self._there(shape)
        friction, load = (channel.with_own_noise(self.new, there) for channel in self.channels)
        return replace(self, channels=(friction, load), inverse=_inverse(friction, load))

    def without_drift(self) -> "NewRunResidual":
        """Return the same under a noise of pairs that are independent of each other."""
        friction, load = (channel.without_drift(self.new) for channel in self.channels)
        return replace(self, channels=(friction, load), inverse=_inverse(friction, load))

    def _there(self, shape: Mapping[str, float]) -> Array:
        """Return 1 where the cause is there, shape (rows,)."""
        if self.effect.moments is None:
            return np.ones(len(self.new.rows))
        return presence(self.new.all_runs, shape)[self.new.rows]

    def _products(self, shape: Mapping[str, float]) -> tuple[float, float]:
        """Return products of a shape's torque with the residual and with itself, under M."""
        there = self._there(shape)
        products = [channel.products(there) for channel in self.channels]
        along, squared, across = (sum(parts) for parts in zip(*products, strict=True))
        crossed = sum(channel.crossed for channel in self.channels)
        reduced = across @ self.inverse
        return float(along - reduced @ crossed), float(squared - reduced @ across)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelResidual:
    """One channel of a run kept out.

    Attributes
    ----------
    noise : Noise
        Its noise.
    extra : ndarray, shape (pairs,)
        Further variance of the pair means. [(N·m)²]
    weights : Weights
        Weights of its rows.
    torque, residual : ndarray, shape (rows,)
        Torque of the cause where it is there, and the residual. [N·m]
    nuisance : ndarray, shape (rows, columns)
        N, columns of base and other causes per standard error. [N·m]
    solved : ndarray, shape (contrasts and pairs, columns + 1)
        Inverse covariance of the noise times the nuisance and the residual.
    information : ndarray, shape (columns, columns)
        :math:`N^T V^{-1} N`.
    """

    noise: Noise
    extra: Array
    weights: Weights
    torque: Array
    residual: Array
    nuisance: Array
    solved: Array
    information: Array

    @classmethod
    def of(
        cls,
        new: Problem,
        noise: Noise,
        extra: Array,
        torque: Array,
        residual: Array,
        nuisance: Array,
    ) -> "ChannelResidual":
        """Return a channel under a noise."""
        weights = Weights.of(new.layout, noise, extra)
        columns = reduced_rows(weights, np.column_stack([nuisance, residual]))
        solved = solved_rows(weights, columns)
        return cls(
            noise=noise,
            extra=extra,
            weights=weights,
            torque=torque,
            residual=residual,
            nuisance=nuisance,
            solved=solved,
            information=columns[:, :-1].T @ solved[:, :-1],
        )

    @property
    def crossed(self) -> Array:
        """Products of the nuisance with the residual, shape (columns,)."""
        columns = reduced_rows(self.weights, self.residual[:, np.newaxis])
        return np.asarray(self.solved[:, :-1].T @ columns[:, 0])

    def products(self, there: Array) -> tuple[float, float, Array]:
        """Return products of the torque with the residual, with itself and with the nuisance.

        Parameters
        ----------
        there : ndarray, shape (rows,)
            1 where the cause is there.
        """
        torque = self.torque * there
        if not np.any(torque):
            return 0.0, 0.0, np.zeros(self.nuisance.shape[1])
        own = reduced_rows(self.weights, torque[:, np.newaxis])
        across = self.solved.T @ own[:, 0]
        squared = float(own[:, 0] @ solved_rows(self.weights, own)[:, 0])
        return float(across[-1]), squared, across[:-1]

    def with_own_noise(self, new: Problem, there: Array) -> "ChannelResidual":
        """Return the same under the noise that suits its residual, where that is greater."""
        if not np.any(self.torque):
            return self
        layout = new.layout
        columns = np.column_stack([self.nuisance, self.torque * there, self.residual])
        means = layout.means(columns)
        found = plausible_noise(
            residual=means[:, -1],
            design=means[:, :-1],
            time=layout.time,
            run=layout.run,
            bins=layout.bins,
            point=self.noise.point,
            extra=self.extra,
        )[0][0]
        return self._under(new, greater_noise(self.noise, found))

    def without_drift(self, new: Problem) -> "ChannelResidual":
        """Return the same with the variance of the drift as noise of pairs."""
        pair = float(np.hypot(self.noise.pair, self.noise.drift))
        return self._under(new, replace(self.noise, pair=pair, drift=0.0))

    def _under(self, new: Problem, noise: Noise) -> "ChannelResidual":
        return ChannelResidual.of(new, noise, self.extra, self.torque, self.residual, self.nuisance)


def model_columns(problem: Problem, effects: Sequence[EffectFit]) -> tuple[Array, Array]:
    """Return the columns of base and effects in friction and load, shape (rows, columns) each."""
    bases = [base_rows(problem), *(problem.basis(one.effect, one.shape) for one in effects)]
    friction, load = (np.hstack([basis[channel] for basis in bases]) for channel in (0, 1))
    return friction, load


def reduced_rows(weights: Weights, rows: Array) -> Array:
    """Return deviations within pairs and, below them, pair means, shape (n, columns)."""
    return np.vstack(weights.layout.contrasts_and_means(rows))


def solved_rows(weights: Weights, columns: Array) -> Array:
    """Return the inverse covariance of the noise times reduced columns, shape (n, columns)."""
    within, means = np.split(columns, [-len(weights.deviation)])
    return np.vstack([within / weights.point**2, weights.covariance.solve(means)])


def _inverse(friction: ChannelResidual, load: ChannelResidual) -> Array:
    information = friction.information + load.information
    return np.asarray(np.linalg.inv(np.eye(len(information)) + information))


def square_root(covariance: Array) -> Array:
    """Return a matrix whose product with its transpose is a covariance, in any units."""
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    size = np.where(deviation > 0, deviation, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
    return np.asarray(deviation[:, np.newaxis] * vectors * np.sqrt(np.maximum(values, 0.0)))


def greater_noise(first: Noise, second: Noise) -> Noise:
    """Return the noise with the greater deviations, and the time of the greater drift."""
    slower = first if first.drift >= second.drift else second
    return replace(
        first, pair=max(first.pair, second.pair), drift=slower.drift, drift_time=slower.drift_time
    )
