"""Columns of a model in the eigenvectors of the noise, each part transformed once.

Inner products of a channel are those of the columns that show in it: a function of the friction
channel has none in the load channel.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.columns import ModelColumns
from frictioncli.diagnosis.fit.products import BorderedProducts, Places, Products
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
    _precisions: dict[tuple[int, int], tuple[list[int], Array]] = field(default_factory=dict)

    def precisions(self, channel: int, time: int) -> tuple[list[int], Array]:
        """Return the noise models of a correlation time, and the precision of each mode.

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        time : int
            Number of the correlation time.

        Returns
        -------
        list of int, ndarray, shape (pairs, noise models)
            Numbers of the noise models, and one over the variances at scale 1.
        """
        if (channel, time) not in self._precisions:
            numbers = [number for number, index in enumerate(self.indices) if index[0] == time]
            variances = [self.variance(channel, number) for number in numbers]
            self._precisions[channel, time] = numbers, 1 / np.column_stack(variances)
        return self._precisions[channel, time]

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
    shown : (0,), (1,) or (0, 1)
        Channels in which they may show: 0 for friction, 1 for load.
    """

    columns: ModelColumns
    noises: NoiseModels
    shown: tuple[int, ...] = (0, 1)
    _modes: dict[tuple[int, int], Array] = field(default_factory=dict)
    _across: dict[tuple[int, int], tuple["Part", Array]] = field(default_factory=dict)

    def across(self, other: "Part", channel: int) -> Array:
        """Return inner products of pair means with those of another part.

        Parameters
        ----------
        other : Part
            The other part.
        channel : int
            0 for friction, 1 for load.

        Returns
        -------
        ndarray, shape (noise models, columns of the other, columns)
        """
        key = (channel, id(other))
        if key not in self._across:
            # the other part lives as long as its number
            self._across[key] = (other, _inner_products(other, self, channel))
        return self._across[key][1]

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
        counts = [part.columns.count for part in self.parts]
        shown = [part.shown for part in self.parts]
        friction, load, both = (
            np.flatnonzero(np.repeat([one == where for one in shown], counts))
            for where in ((0,), (1,), (0, 1))
        )
        return Places((friction, load), both)

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

    def products(self) -> Products:
        """Return inner products of all columns."""
        within = [one.T @ one for one in (self.within(0), self.within(1))]
        between = [
            _joined([[_inner_products(one, two, channel) for two in shown] for one in shown])
            for channel, shown in enumerate((self.shown(0), self.shown(1)))
        ]
        return Products(
            places=self.places,
            within=(within[0], within[1]),
            between=(between[0], between[1]),
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
        return self.beside(products, own).whole() if own else products

    def beside(self, products: Products, own: Sequence[Part]) -> BorderedProducts:
        """Return the same without copying what is known, for columns that are used once.

        Parameters
        ----------
        products : Products
            Inner products of these columns.
        own : sequence of Part
            The further columns, which may show in both channels.
        """
        new = TransformedColumns(tuple(own))
        within = [new.within(channel) for channel in (0, 1)]
        shown = self.shown(0), self.shown(1)
        across_within, across, of_own = (
            [
                np.vstack([one.columns.channels[channel].within.T @ columns for one in parts])
                for channel, (columns, parts) in enumerate(zip(within, shown, strict=True))
            ],
            *(
                [
                    _joined([[one.across(part, channel) for one in own] for part in parts])
                    for channel, parts in enumerate(both)
                ]
                for both in (shown, (own, own))
            ),
        )
        return BorderedProducts(
            known=products,
            across_within=(across_within[0], across_within[1]),
            own_within=(within[0].T @ within[0], within[1].T @ within[1]),
            across=(across[0], across[1]),
            own=(of_own[0], of_own[1]),
        )


def _joined(blocks: Sequence[Sequence[Array]]) -> Array:
    """Return rows of blocks as one array, shape (noise models, columns, columns)."""
    return np.concatenate([np.concatenate(row, axis=2) for row in blocks], axis=1)


def _inner_products(first: Part, second: Part, channel: int) -> Array:
    """Return inner products of pair means, shape (noise models, columns, columns)."""
    noises = first.noises
    found = np.zeros((len(noises.indices), first.columns.count, second.columns.count))
    rows, columns = (
        np.flatnonzero(one.columns.channels[channel].means.any(axis=0)) for one in (first, second)
    )
    if not (len(rows) and len(columns)):
        return found
    places = np.ix_(rows, columns)
    for time in range(len(noises.spectra[channel].spectra)):
        left = first.modes(channel, time)
        left = left if len(rows) == left.shape[1] else left[:, rows]
        right = second.modes(channel, time)[:, columns]
        numbers, precisions = noises.precisions(channel, time)
        if first is second:
            # the product of an array with itself takes half the time
            for number, precision in zip(numbers, precisions.T, strict=True):
                scaled = right * np.sqrt(precision)[:, np.newaxis]
                found[number][places] = scaled.T @ scaled
            continue
        weighted = precisions[:, :, np.newaxis] * right[:, np.newaxis]
        together = left.T @ weighted.reshape(len(right), -1)
        products = np.moveaxis(together.reshape(len(rows), len(numbers), -1), 1, 0)
        if len(rows) == found.shape[1] and len(columns) == found.shape[2]:
            found[numbers] = products
        else:
            found[np.ix_(np.array(numbers), rows, columns)] = products
    return found
