"""Columns of a model in the eigenvectors of the noise, each part transformed once."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.columns import ModelColumns
from frictioncli.diagnosis.fit.mixed_model import Products
from frictioncli.diagnosis.noise.spectra import STRENGTHS, NoiseIndex, Spectra


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

    def variance(self, channel: int, number: int) -> Array:
        """Return the variance of each mode under a noise model at scale 1, shape (pairs,)."""
        time, strength = self.indices[number]
        return np.asarray(1 + STRENGTHS[strength] * self.spectra[channel].spectra[time].values)

    def determinants(self, channel: int) -> Array:
        """Return the logarithm of the determinant of each noise model, shape (noise models,)."""
        return np.array(
            [np.sum(np.log(self.variance(channel, i))) for i in range(len(self.indices))]
        )

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
    """

    columns: ModelColumns
    noises: NoiseModels
    _modes: dict[tuple[int, int], Array] = field(default_factory=dict)

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

    @property
    def noises(self) -> NoiseModels:
        """Noise models of the pair means."""
        return self.parts[0].noises

    @property
    def count(self) -> int:
        """Number of columns."""
        return sum(part.columns.count for part in self.parts)

    def modes(self, channel: int, time: int) -> Array:
        """Return pair means in the eigenvectors of a correlation time, shape (pairs, columns)."""
        if (channel, time) not in self._modes:
            self._modes[channel, time] = np.hstack(
                [part.modes(channel, time) for part in self.parts]
            )
        return self._modes[channel, time]

    def within(self, channel: int) -> Array:
        """Return deviations within pairs, shape (contrasts, columns)."""
        return np.hstack([part.columns.channels[channel].within for part in self.parts])

    def products(self) -> Products:
        """Return inner products of all columns."""
        within = [one.T @ one for one in (self.within(0), self.within(1))]
        return Products(
            within=(within[0], within[1]),
            between=(_between(self, self, 0), _between(self, self, 1)),
        )

    def bordered(self, products: Products, own: Sequence[Part]) -> Products:
        """Return inner products with further columns before the last one, the misfit.

        Parameters
        ----------
        products : Products
            Inner products of these columns.
        own : sequence of Part
            The further columns.
        """
        if not own:
            return products
        new = TransformedColumns(tuple(own))
        within, between = [], []
        for channel in (0, 1):
            columns = new.within(channel)
            across = np.vstack(
                [part.columns.channels[channel].within.T @ columns for part in self.parts]
            )
            within.append(_bordered(products.within[channel], across, columns.T @ columns))
            between.append(
                _bordered(
                    products.between[channel],
                    _between(self, new, channel),
                    _between(new, new, channel),
                )
            )
        return Products(within=(within[0], within[1]), between=(between[0], between[1]))


def _between(first: TransformedColumns, second: TransformedColumns, channel: int) -> Array:
    """Return inner products of pair means, shape (noise models, columns, columns)."""
    noises = first.noises
    found = np.zeros((len(noises.indices), first.count, second.count))
    columns = np.flatnonzero(
        np.hstack([part.columns.channels[channel].means.any(axis=0) for part in second.parts])
    )
    if not len(columns):
        return found
    for time in range(len(noises.spectra[channel].spectra)):
        left = first.modes(channel, time).T
        right = second.modes(channel, time)[:, columns]
        for number, index in enumerate(noises.indices):
            if index[0] == time:
                weighted = right / noises.variance(channel, number)[:, np.newaxis]
                found[number][:, columns] = left @ weighted
    return found


def _bordered(old: Array, across: Array, own: Array) -> Array:
    """Return inner products with columns inserted before the last one."""
    count, width = old.shape[-1] - 1, own.shape[-1]
    found = np.empty((*old.shape[:-2], count + width + 1, count + width + 1))
    found[..., :count, :count] = old[..., :count, :count]
    found[..., :count, -1] = old[..., :count, -1]
    found[..., -1, :count] = old[..., -1, :count]
    found[..., -1, -1] = old[..., -1, -1]
    middle = slice(count, count + width)
    found[..., :count, middle] = across[..., :count, :]
    found[..., -1, middle] = across[..., -1, :]
    found[..., middle, :count] = across[..., :count, :].swapaxes(-1, -2)
    found[..., middle, -1] = across[..., -1, :]
    found[..., middle, middle] = own
    return found
