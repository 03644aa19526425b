"""Division of rows into pairs: means of pairs and deviations within them.

Rows are angle bins. Noise within a pair is white; noise of the pair means is correlated in time.
Deviations within neighbouring pairs at one speed are pooled by angle, which keeps their inner
products with every effect that is the same in these pairs.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.sparse import csr_array

from frictioncli.arrays import Array, Indices

_POOLED = 5
"""Neighbouring pairs at one speed whose deviations are pooled."""

_SAME_SPEED = 0.02
"""Relative width of a speed level."""


def speed_level(speed: Array) -> Indices:
    """Return the level of each speed; speeds of one level differ by 2 % at the most.

    Parameters
    ----------
    speed : ndarray, shape (pairs,)
        Speeds. [deg/s]

    Examples
    --------
    >>> import numpy as np
    >>> level = speed_level(np.array([20.0, 20.1, 40.0]))
    >>> bool(level[0] == level[1]), bool(level[1] == level[2])
    (True, False)
    """
    return np.round(np.log(np.maximum(speed, 1e-9)) / _SAME_SPEED).astype(np.intp)


@dataclass(frozen=True, slots=True, kw_only=True)
class PairLayout:
    """Rows of each pair, with its run, time and speed.

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
        Speed level of each pair.
    pooling : sparse matrix, shape (groups, rows)
        Sums over a group of neighbouring pairs at one speed and angle, over the root of their
        number; its rows are orthonormal, so that white deviations stay white.
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
        """Return deviations from the pair means, pooled over neighbouring pairs.

        Neighbouring pairs at one speed pass the same angles at nearly the same temperature, so that
        pooling loses nothing of an effect and reduces the number of rows.

        Parameters
        ----------
        rows : ndarray, shape (rows, columns)
            Values of each angle bin.

        Returns
        -------
        ndarray, shape (groups, columns)
            Sums of the deviations of each group over the root of their number.
        """
        deviations = rows - self.means(rows)[self.row_pair]
        return np.asarray(self.pooling @ deviations)

    def means(self, rows: Array) -> Array:
        """Return the mean of each pair's rows, shape (pairs, ...)."""
        starts = np.concatenate([[0], np.cumsum(self.bins[:-1])]).astype(np.intp)
        total = np.add.reduceat(rows, starts, axis=0)
        return np.asarray((total.T / self.bins).T)

    def point_deviation(self, residual: Array) -> float:
        """Return the standard deviation of an angle bin about the mean of its pair [N·m].

        Parameters
        ----------
        residual : ndarray, shape (rows,)
            Residual torque. [N·m]
        """
        within = residual - self.means(residual[:, np.newaxis])[:, 0][self.row_pair]
        freedom = max(len(within) - len(self.bins), 1)
        return float(np.sqrt(within @ within / freedom))
