"""Which rows make up which pair, and what of them is told apart: inside pairs and between."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.sparse import csr_array

from frictioncli.arrays import Array, Indices

_POOLED = 5
"""Neighbouring pairs at one speed whose deviations are pooled."""

_SAME_SPEED = 0.02
"""Speeds closer than this share are one level."""


def speed_level(speed: Array) -> Indices:
    """Return the level of each speed [deg/s]; speeds of one level differ by 2 % at the most."""
    return np.round(np.log(np.maximum(speed, 1e-9)) / _SAME_SPEED).astype(np.intp)


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

    row_pair: Indices
    bins: Array
    run: Indices
    time: Array
    level: Indices
    pooling: csr_array

    @classmethod
    def of(
        cls,
        *,
        row_pair: Indices,
        run: Indices,
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
        level = speed_level(speed)
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
