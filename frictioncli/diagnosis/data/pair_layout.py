"""Division of rows into pairs: means of pairs and deviations within them.

Rows are angle bins. Noise of the pair means is correlated in time, noise within a pair along the
move (:mod:`frictioncli.diagnosis.data.within_noise`). Deviations within neighbouring pairs at one
speed are pooled by angle, which keeps their inner products with every effect that is the same in
these pairs, and made white.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.group_whitening import GroupWhitening
from frictioncli.diagnosis.data.pair_neighbours import (
    jumps_of,
    neighbours,
    same_bins,
    stretches_of,
)
from frictioncli.diagnosis.data.within_noise import (
    LEAST_FREEDOM,
    WithinNoise,
    whitening,
    within_noise_of,
)

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
    stretch : ndarray of int, shape (pairs,)
        Number of the stretch of each pair: the course over the angle of the pairs of a run at one
        speed changes suddenly between two stretches, as by another payload.
    averaging : sparse matrix, shape (pairs, rows)
        Means of pairs.
    pooling : sparse matrix, shape (groups, rows)
        Sums over a group of neighbouring pairs at one speed and angle, over the root of their
        number: white deviations of variance 1 stay so.
    pooled_means : sparse matrix, shape (groups, pairs)
        The same sums of means of pairs.
    white : GroupWhitening or None
        Makes the sums white; None where they are so.
    noise : WithinNoise
        Noise within pairs.
    blocks : tuple of ndarray of int
        Rows of each set of neighbouring pairs at one speed that cross the same bins, shape (pairs,
        bins).
    """

    row_pair: Indices
    bins: Array
    run: Indices
    time: Array
    level: Indices
    stretch: Indices
    speed: Array
    averaging: csr_array
    pooling: csr_array
    pooled_means: csr_array
    white: GroupWhitening | None
    noise: WithinNoise
    blocks: tuple[Indices, ...]

    @property
    def distance(self) -> float:
        """Median time from pair to pair within a run [s]."""
        gaps = np.diff(self.time)[np.diff(self.run) == 0]
        return max(float(np.median(gaps)), 1e-3) if gaps.size else 1.0

    @classmethod
    def of(
        cls,
        *,
        row_pair: Indices,
        run: Indices,
        time: Array,
        speed: Array,
        position: Array,
        noise: WithinNoise | None = None,
        stretch: Indices | None = None,
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
        noise : WithinNoise, optional
            Noise within pairs; by default it is white.
        stretch : ndarray of int, shape (pairs,), optional
            Number of the stretch of each pair; by default all are of one.
        """
        level = speed_level(speed)
        stretch = np.zeros(len(run), np.intp) if stretch is None else stretch
        block = neighbours(run, level, stretch)
        centres, centre = np.unique(position, return_inverse=True)
        crossed, group = np.unique(block[row_pair] * len(centres) + centre, return_inverse=True)
        noise = noise or WithinNoise()
        group_of, bin_of = np.divmod(crossed, len(centres))
        own = noise, group_of, centres[bin_of], speed, block
        white = GroupWhitening.of(*own) if noise.share > 0 else None
        group = group if white is None else white.place[group]
        weight = 1 / np.sqrt(np.bincount(group))
        pooling = csr_array(
            (weight[group], (group, np.arange(len(group)))), shape=(len(weight), len(group))
        )
        bins = np.bincount(row_pair).astype(float)
        place = np.arange(len(row_pair)), row_pair
        of_pair = csr_array((np.ones(len(row_pair)), place), shape=(len(row_pair), len(bins)))
        return cls(
            row_pair=row_pair,
            bins=bins,
            run=run,
            time=time,
            level=level,
            stretch=stretch,
            speed=speed,
            averaging=csr_array((of_pair / bins).T),
            pooling=pooling,
            pooled_means=csr_array(pooling @ of_pair),
            white=white,
            noise=noise,
            blocks=same_bins(row_pair, block, position),
        )

    def pure_error(self, rows: Array) -> list[tuple[float, Indices, Array]]:
        """Return the scatter of neighbouring pairs about their common course over the angle.

        Parameters
        ----------
        rows : ndarray, shape (rows, columns)
            Values of each angle bin.

        Returns
        -------
        list of (float, ndarray, ndarray)
            Of each block: the speed [deg/s], its rows, shape (pairs, bins), and the scatter, shape
            (columns, pairs, bins).
        """
        deviations = rows - self.means(rows)[self.row_pair]
        found = []
        for chosen in self.blocks:
            values = np.moveaxis(deviations[chosen], -1, 0)
            speed = float(self.speed[self.row_pair[chosen[0, 0]]])
            found.append((speed, chosen, values - values.mean(axis=1, keepdims=True)))
        return found

    def split_at_jumps(self, rows: Array, position: Array) -> "PairLayout":
        """Return the layout with a new stretch wherever the course over the angle changes suddenly.

        That is where two neighbours that cross the same bins at one speed differ far more than
        others at this speed.

        Parameters
        ----------
        rows : ndarray, shape (rows, channels)
            Measured torque in each channel. [N·m]
        position : ndarray, shape (rows,)
            Centre of each row's angle bin. [deg]
        """
        deviations = rows - self.means(rows)[self.row_pair]
        jumps = jumps_of(deviations, self.row_pair, self.run, self.level, position)
        if not jumps.any():
            return self
        return self._again(position, self.noise, stretches_of(jumps, self.run, self.level))

    def _again(self, position: Array, noise: WithinNoise, stretch: Indices) -> "PairLayout":
        return PairLayout.of(
            row_pair=self.row_pair,
            run=self.run,
            time=self.time,
            speed=self.speed,
            position=position,
            noise=noise,
            stretch=stretch,
        )

    def with_noise_from(self, rows: Array, position: Array) -> "PairLayout":
        """Return the layout with the noise within pairs that is estimated from some rows.

        Parameters
        ----------
        rows : ndarray, shape (rows, channels)
            Measured torque in each channel. [N·m]
        position : ndarray, shape (rows,)
            Centre of each row's angle bin. [deg]
        """
        noise = within_noise_of(
            [
                (speed, position[chosen[0]], scatter)
                for speed, chosen, scatter in self.pure_error(rows)
            ]
        )
        return self._again(position, noise, self.stretch)

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
        return self.contrasts_and_means(rows)[0]

    def contrasts_and_means(self, rows: Array) -> tuple[Array, Array]:
        """Return what :meth:`contrasts` and :meth:`means` do.

        Parameters
        ----------
        rows : ndarray, shape (rows, columns)
            Values of each angle bin.
        """
        # most columns that are not zero are so in their first row
        if not (rows[:1].any() or rows.any()):
            shape = rows.shape[1:]
            return np.zeros((self.pooling.shape[0], *shape)), np.zeros((len(self.bins), *shape))
        means = self.means(rows)
        pooled = np.asarray(self.pooling @ rows - self.pooled_means @ means)
        return pooled if self.white is None else self.white.applied(pooled), means

    def means(self, rows: Array) -> Array:
        """Return the mean of each pair's rows, shape (pairs, ...)."""
        return np.asarray(self.averaging @ rows)

    @property
    def within_freedom(self) -> int:
        """Degrees of freedom of the pooled deviations from the pair means."""
        blocks = int(neighbours(self.run, self.level, self.stretch).max(initial=-1)) + 1
        return max(self.pooling.shape[0] - blocks, 1)

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

    def pure_deviation(self, rows: Array, position: Array) -> Array | None:
        """Return the standard deviation of an angle bin from pure error, shape (columns,) [N·m].

        Parameters
        ----------
        rows : ndarray, shape (rows, columns)
            Measured torque. [N·m]
        position : ndarray, shape (rows,)
            Centre of each row's angle bin. [deg]

        Returns
        -------
        ndarray or None
            None where too few neighbouring pairs cross the same bins.
        """
        square, freedom = np.zeros(rows.shape[1]), 0
        known: dict[tuple[float, bytes], Array] = {}
        for speed, chosen, scatter in self.pure_error(rows):
            bins = position[chosen[0]]
            key = (round(speed, 1), bins.tobytes())
            if key not in known:
                white = whitening(self.noise.correlation(bins, speed))[0]
                known[key] = white @ white
            square += np.einsum("cpi,ij,cpj->c", scatter, known[key], scatter)
            freedom += (scatter.shape[1] - 1) * (scatter.shape[2] - 1)
        if freedom < LEAST_FREEDOM:
            return None
        return np.sqrt(square / freedom)
