"""Columns of a model in the eigenvectors of the noise, each part transformed once.

Inner products of a channel are those of the columns that show in it: a function of the friction
channel has none in the load channel.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.fit.columns import ModelColumns
from frictioncli.diagnosis.noise.spectra import STRENGTHS, InverseCovariances, NoiseIndex, Spectra


@dataclass(frozen=True, slots=True)
class Places:
    """Where the columns of a model show.

    Attributes
    ----------
    own : (ndarray of int, ndarray of int)
        Numbers of the columns that show in friction alone, and in load alone.
    shared : ndarray of int
        Numbers of all others: those of the base come first, and the misfit last.
    """

    own: tuple[Indices, Indices]
    shared: Indices

    @property
    def count(self) -> int:
        """Number of columns, the misfit included."""
        return int(self.shared[-1]) + 1

    def shown(self, channel: int) -> Indices:
        """Return the numbers of the columns that show in a channel: its own, then the others."""
        return np.concatenate([self.own[channel], self.shared])


@dataclass(frozen=True, slots=True)
class NoiseModels:
    """Noise models of the pair means of both channels.

    Attributes
    ----------
    spectra : (Spectra, Spectra)
        Of friction and load.
    indices : tuple of (int, int)
        Correlation time and strength of the drift of each noise model.
    """

    spectra: tuple[Spectra, Spectra]
    indices: tuple[NoiseIndex, ...]
    _inverses: dict[int, InverseCovariances] = field(default_factory=dict)

    def inverses(self, channel: int) -> InverseCovariances:
        """Return the inverse covariances of scaled pair means at scale 1.

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        """
        if channel not in self._inverses:
            spectra = self.spectra[channel]
            self._inverses[channel] = InverseCovariances.of(spectra, self.indices)
        return self._inverses[channel]

    def time_and_precision(self, channel: int, number: int) -> tuple[int, Array]:
        """Return the correlation time of a noise model, and the precision of each mode.

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        number : int
            Number of the noise model.

        Returns
        -------
        int, ndarray, shape (pairs,)
            Number of the correlation time, and one over the variances at scale 1.
        """
        return self.indices[number][0], 1 / self.variance(channel, number)

    def variance(self, channel: int, number: int) -> Array:
        """Return the variance of each mode under a noise model at scale 1, shape (pairs,)."""
        time, strength = self.indices[number]
        return np.asarray(1 + STRENGTHS[strength] * self.spectra[channel].spectra[time].values)

    def determinants(self, channel: int) -> Array:
        """Return the logarithm of the determinant of each noise model, shape (noise models,)."""
        return self.inverses(channel).determinants

    def drifts(self, channel: int) -> Array:
        """Return the variance of the drift within the runs at scale 1, shape (noise models,)."""
        within = [spectrum.within for spectrum in self.spectra[channel].spectra]
        return np.array([STRENGTHS[strength] * within[time] for time, strength in self.indices])


@dataclass(frozen=True, slots=True)
class Part:
    """Columns that are transformed together.

    Attributes
    ----------
    columns : ModelColumns
        The columns.
    noises : NoiseModels
        Noise models of their pair means.
    shown : (0,), (1,) or (0, 1)
        Channels in which they may show: 0 for friction, 1 for load.
    """

    columns: ModelColumns
    noises: NoiseModels
    shown: tuple[int, ...] = (0, 1)
    _modes: dict[tuple[int, int], Array] = field(default_factory=dict)

    def take(self, chosen: slice | list[int]) -> "Part":
        """Return some of the columns."""
        modes = {key: values[:, chosen] for key, values in self._modes.items()}
        return Part(self.columns.take(chosen), self.noises, self.shown, modes)

    def modes(self, channel: int, time: int) -> Array:
        """Return pair means in the eigenvectors of a correlation time, shape (pairs, columns)."""
        if (channel, time) not in self._modes:
            means = self.columns.channels[channel].means
            present = means.any(axis=0)
            modes = np.zeros_like(means)
            spectra = self.noises.spectra[channel]
            modes[:, present] = spectra.modes_at(time, means[:, present])
            self._modes[channel, time] = modes
        return self._modes[channel, time]


@dataclass(frozen=True, slots=True)
class TransformedColumns:
    """Columns of a model, the misfit last, made of parts.

    Attributes
    ----------
    parts : tuple of Part
        The parts, side by side.
    """

    parts: tuple[Part, ...]
    _modes: dict[tuple[int, int], Array] = field(default_factory=dict)
    _places: list[Places] = field(default_factory=list)

    @property
    def noises(self) -> NoiseModels:
        """Noise models of the pair means."""
        return self.parts[0].noises

    @property
    def count(self) -> int:
        """Number of columns."""
        return sum(part.columns.count for part in self.parts)

    @property
    def places(self) -> Places:
        """Where the columns show."""
        if not self._places:
            counts = [part.columns.count for part in self.parts]
            shown = [part.shown for part in self.parts]
            friction, load, both = (
                np.flatnonzero(np.repeat([one == where for one in shown], counts))
                for where in ((0,), (1,), (0, 1))
            )
            self._places.append(Places((friction, load), both))
        return self._places[0]

    def shown(self, channel: int) -> list[Part]:
        """Return the parts that show in a channel, those that show in no other first."""
        shown = [part for part in self.parts if channel in part.shown]
        return sorted(shown, key=lambda part: len(part.shown))

    def modes(self, channel: int, time: int) -> Array:
        """Return pair means in the eigenvectors of a correlation time, shape (pairs, shown)."""
        if (channel, time) not in self._modes:
            self._modes[channel, time] = np.hstack(
                [part.modes(channel, time) for part in self.shown(channel)]
            )
        return self._modes[channel, time]

    def within(self, channel: int) -> Array:
        """Return deviations within pairs of the columns that show, shape (contrasts, shown)."""
        return np.hstack([part.columns.channels[channel].within for part in self.shown(channel)])

    def within_products(self, other: Part, channel: int) -> Array:
        """Return inner products of deviations within pairs with those of another part.

        Parameters
        ----------
        other : Part
            The other part.
        channel : int
            0 for friction, 1 for load.

        Returns
        -------
        ndarray, shape (shown, columns of the other)
        """
        columns = other.columns.channels[channel].within
        shown = self.shown(channel)
        return np.vstack([one.columns.channels[channel].within.T @ columns for one in shown])

    def combined(self, channel: int, combination: Array) -> Array:
        """Return the scaled pair means of a combination of the columns, shape (pairs,).

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        combination : ndarray, shape (columns,)
            The combination.
        """
        ends = np.cumsum([one.columns.count for one in self.parts])
        shares = zip(self.parts, np.split(combination, ends[:-1]), strict=True)
        means = sum(
            one.columns.channels[channel].means @ share
            for one, share in shares
            if channel in one.shown
        )
        return self.noises.spectra[channel].scaled(np.asarray(means))

    def beside(self, own: Sequence[Part]) -> "TransformedColumns":
        """Return the columns with further ones before the last one, the misfit.

        Parameters
        ----------
        own : sequence of Part
            The further columns.
        """
        *before, misfit = self.parts
        return TransformedColumns((*before, *own, misfit))
