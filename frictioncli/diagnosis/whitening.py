"""Whitening by the noise model: what is left is white if the model is right.

A channel's rows split exactly into deviations from their pair's mean, which are white after
division by the point noise, and the pair means, whose correlated noise is removed by the
innovations of its state-space form.

References
----------
.. [1] A. C. Harvey, Forecasting, Structural Time Series Models and the Kalman Filter, 1990,
   doi:10.1017/CBO9781107049994 (innovations and the prediction-error decomposition).
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.sparse import csr_array

from frictioncli.model.noise import Noise

Array = NDArray[np.float64]

_POOLED = 5
"""Neighbouring pairs at one speed whose deviations are pooled."""

_SAME_SPEED = 0.02
"""Speeds closer than this share are one level."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PairLayout:
    """Which rows make up which pair, and when.

    Attributes
    ----------
    row_pair : ndarray of int, shape (rows,)
        Pair of each row; rows of a pair stand together, pairs are in order of run and time.
    bins : ndarray, shape (pairs,)
        Rows of each pair.
    run : ndarray of int, shape (pairs,)
        Run of each pair.
    time : ndarray, shape (pairs,)
        Middle of each pair. [s]
    level : ndarray of int, shape (pairs,)
        Speed of each pair as a level; pairs of one speed have the same.
    pooling : sparse matrix, shape (groups, rows)
        Adds up the rows of a group of neighbouring pairs at one speed and angle; its rows are
        orthonormal, so white deviations stay white.
    """

    row_pair: NDArray[np.intp]
    bins: Array
    run: NDArray[np.intp]
    time: Array
    level: NDArray[np.intp]
    pooling: csr_array

    @classmethod
    def of(
        cls,
        *,
        row_pair: NDArray[np.intp],
        run: NDArray[np.intp],
        time: Array,
        speed: Array,
        position: Array,
    ) -> "PairLayout":
        """Return the layout of rows whose pairs are numbered from 0 in order.

        Parameters
        ----------
        row_pair : ndarray of int, shape (rows,)
            Pair of each row.
        run, time, speed : ndarray, shape (pairs,)
            Of each pair. [-], [s], [deg/s]
        position : ndarray, shape (rows,)
            Centre of each row's angle bin. [deg]
        """
        level = np.round(np.log(np.maximum(speed, 1e-9)) / _SAME_SPEED).astype(np.int64)
        pairs = pd.DataFrame({"run": run, "level": level})
        pairs["block"] = pairs.groupby(["run", "level"]).cumcount() // _POOLED
        keys = pairs.iloc[row_pair].assign(position=position)
        group = keys.groupby(["run", "level", "block", "position"]).ngroup().to_numpy()
        weight = 1 / np.sqrt(np.bincount(group))
        pooling = csr_array(
            (weight[group], (group, np.arange(len(group)))), shape=(len(weight), len(group))
        )
        return cls(
            row_pair=row_pair,
            bins=np.bincount(row_pair).astype(float),
            run=run,
            time=time,
            level=level,
            pooling=pooling,
        )

    def contrasts(self, rows: Array) -> Array:
        """Return deviations from the pair means, each mean of neighbours times its weight.

        Neighbouring pairs at one speed see the same angles at nearly the same temperature, so the
        mean of a few loses nothing that an effect could show, and costs a fraction.
        """
        deviations = rows - self.means(rows)[self.row_pair]
        return np.asarray(self.pooling @ deviations)

    def means(self, rows: Array) -> Array:
        """Return the mean of each pair's rows, shape (pairs, ...)."""
        starts = np.concatenate([[0], np.cumsum(self.bins[:-1])]).astype(np.intp)
        total = np.add.reduceat(rows, starts, axis=0)
        return np.asarray((total.T / self.bins).T)


@dataclass(frozen=True, slots=True)
class Whitener:
    """Turns rows of one channel into white ones.

    Attributes
    ----------
    layout : PairLayout
        The pairs.
    point : float
        Standard deviation of a row about its pair. [N·m]
    between : ndarray, shape (pairs, pairs)
        Turns pair means into white innovations. [1/(N·m)]
    """

    layout: PairLayout
    point: float
    between: Array

    @classmethod
    def of(cls, layout: PairLayout, noise: Noise, extra: Array) -> "Whitener":
        """Return the whitener of a channel.

        Parameters
        ----------
        layout : PairLayout
            The pairs.
        noise : Noise
            The channel's noise. [N·m]
        extra : ndarray, shape (pairs,)
            Further variance of the pair means, as of an uncertain temperature. [(N·m)²]
        """
        return cls(layout, noise.point, innovations(layout, noise, extra))

    @classmethod
    def weighing(cls, layout: PairLayout, noise: Noise, extra: Array) -> "Whitener":
        """Return a whitener that weighs pairs by their variance and does not look at drift.

        Estimates that must predict are made with it: where a slow error is forgiven as drift, a
        model may miss by as much. Parameters are those of :meth:`of`.
        """
        variance = noise.pair**2 + noise.drift**2 + noise.point**2 / layout.bins + extra
        return cls(layout, noise.point, np.diag(1 / np.sqrt(variance)))

    @property
    def length(self) -> int:
        """Number of white rows."""
        return self.layout.pooling.shape[0] + len(self.between)

    def size(self, white: Array) -> float:
        """Return the RMS torque per row of a white vector of this channel. [N·m]."""
        inside, means = np.split(white, [self.layout.pooling.shape[0]])
        spread = 1 / float(np.median(np.diag(self.between)))
        rows = len(self.layout.row_pair)
        return float(
            np.sqrt(
                self.point**2 * (inside @ inside) / rows
                + spread**2 * (means @ means) / len(self.between)
            )
        )

    def whiten(self, rows: Array) -> Array:
        """Return white rows: the deviations inside pairs, then one innovation per pair.

        Parameters
        ----------
        rows : ndarray, shape (rows, columns)
            Data, or derivatives of the model. [N·m]
        """
        inside = self.layout.contrasts(rows) / self.point
        return np.concatenate([inside, self.between @ self.layout.means(rows)])


@dataclass(frozen=True, slots=True)
class Channels:
    """Both channels' whiteners; rows of both become one tall white matrix."""

    friction: Whitener
    load: Whitener

    def whiten(self, friction: Array, load: Array) -> Array:
        """Return the white columns of rows of both channels, friction above load."""
        return np.concatenate([self.friction.whiten(friction), self.load.whiten(load)])


def innovations(layout: PairLayout, noise: Noise, extra: Array) -> Array:
    """Return the lower triangular matrix that whitens pair means, shape (pairs, pairs)."""
    white = noise.pair**2 + noise.point**2 / layout.bins + extra
    stationary = noise.drift**2
    pairs = len(layout.time)
    found = np.zeros((pairs, pairs))
    state, spread = np.zeros(pairs), stationary
    for i in range(pairs):
        if i == 0 or layout.run[i] != layout.run[i - 1]:
            state, spread = np.zeros(pairs), stationary
        else:
            keep = np.exp(-max(layout.time[i] - layout.time[i - 1], 0.0) / noise.drift_time)
            state = keep * state
            spread = keep**2 * spread + (1 - keep**2) * stationary
        variance = spread + white[i]
        surprise = -state
        surprise[i] += 1.0
        found[i] = surprise / np.sqrt(variance)
        gain = spread / variance
        state = state + gain * surprise
        spread = (1 - gain) * spread
    return found
