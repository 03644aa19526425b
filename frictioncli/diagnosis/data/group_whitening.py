"""Pooled deviations of groups of neighbouring pairs made white.

Groups that cross the same bins at one speed have the same matrix: they are transformed together.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.data.within_noise import WithinNoise, whitening


@dataclass(frozen=True, slots=True)
class GroupWhitening:
    """Matrices that make the pooled deviations of each group white.

    Attributes
    ----------
    matrices : tuple of (ndarray, slice)
        Each matrix, shape (bins, bins), with the places of the deviations that it makes white: the
        first bin of each of its groups, then the second, and so on.
    place : ndarray of int, shape (deviations,)
        Place of each deviation, where these are ordered by group and bin.
    """

    matrices: tuple[tuple[Array, slice], ...]
    place: Indices

    @classmethod
    def of(
        cls,
        noise: WithinNoise,
        group: Indices,
        position: Array,
        speed: Array,
        block: Indices,
    ) -> "GroupWhitening":
        """Return the matrices for the noise within pairs.

        Parameters
        ----------
        noise : WithinNoise
            Noise within pairs.
        group : ndarray of int, shape (deviations,)
            Group of each pooled deviation, in order.
        position : ndarray, shape (deviations,)
            Centre of its bin, in order within the group. [deg]
        speed : ndarray, shape (pairs,)
            Speed of each pair. [deg/s]
        block : ndarray of int, shape (pairs,)
            Group of each pair.
        """
        mean_speed = np.bincount(block, speed) / np.bincount(block)
        known: dict[tuple[float, bytes], Array] = {}
        numbers: dict[tuple[float, bytes], list[Indices]] = {}
        heads = np.flatnonzero(np.diff(group, prepend=-1))
        for number, first, bins in zip(
            group[heads].tolist(), heads.tolist(), np.split(position, heads[1:]), strict=True
        ):
            at = float(mean_speed[number])
            key = (round(at, 1), bins.tobytes())
            if key not in known:
                known[key] = whitening(noise.correlation(bins, at))[0]
            numbers.setdefault(key, []).append(np.arange(first, first + len(bins)))
        orders = [np.column_stack(own).ravel() for own in numbers.values()]
        ends = np.cumsum([0, *map(len, orders)]).tolist()
        matrices = zip(known.values(), map(slice, ends, ends[1:]), strict=True)
        return cls(tuple(matrices), np.argsort(np.concatenate(orders)))

    def applied(self, pooled: Array) -> Array:
        """Return pooled deviations made white.

        Parameters
        ----------
        pooled : ndarray, shape (deviations, ...)
            Pooled deviations in their places.
        """
        found = np.empty(pooled.shape)
        for matrix, places in self.matrices:
            own = pooled[places].reshape(len(matrix), -1)
            np.matmul(matrix, own, out=found[places].reshape(own.shape))
        return found
