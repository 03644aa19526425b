"""Inner products of the columns of a mixed model, and of the same with further columns.

Those of a channel are of the columns that show in it, of which those that show in no other come
first. Those of pair means are worked out for the noise models that are asked for.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.transformed_columns import Part, Places, TransformedColumns


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenProducts:
    """Inner products of the columns of a model under one noise model of each channel.

    Attributes
    ----------
    places : Places
        Where the columns show.
    within, between : (ndarray, ndarray), shape (shown, shown)
        Of deviations within pairs and of pair means, of the columns that show in friction and in
        load.
    """

    places: Places
    within: tuple[Array, Array]
    between: tuple[Array, Array]

    def weighted(self, within: tuple[float, float], between: tuple[float, float]) -> list[Array]:
        """Return the sum of the products over their variances, of friction and load.

        Parameters
        ----------
        within, between : (float, float)
            Variance of the deviations, and of the pair means, in friction and load. [(N·m)²]
        """
        parts = zip(self.within, within, self.between, between, strict=True)
        found = []
        for one, of_one, two, of_two in parts:
            both = one / of_one
            both += two / of_two
            found.append(both)
        return found

    def squares(self, combination: Array) -> tuple[list[float], list[float]]:
        """Return the squared lengths of a combination of all columns, of friction and load.

        Parameters
        ----------
        combination : ndarray, shape (columns,)
            The combination.

        Returns
        -------
        list of float, list of float
            Of deviations within pairs, and of pair means.
        """
        shown = [combination[self.places.shown(channel)] for channel in (0, 1)]
        return (
            [float(one @ part @ one) for one, part in zip(shown, self.within, strict=True)],
            [float(one @ part @ one) for one, part in zip(shown, self.between, strict=True)],
        )

    def traces(self, covariances: tuple[Array, Array]) -> tuple[list[float], list[float]]:
        """Return the traces of the products times covariances of coefficients.

        Parameters
        ----------
        covariances : (ndarray, ndarray), shape (shown - 1, shown - 1)
            Covariance of the coefficients of the columns that show in friction and in load, but
            the misfit.

        Returns
        -------
        list of float, list of float
            Of deviations within pairs, and of pair means.
        """
        parts = list(zip(covariances, self.within, self.between, strict=True))
        return (
            [float(np.vdot(within[:-1, :-1], one)) for one, within, _ in parts],
            [float(np.vdot(between[:-1, :-1], one)) for one, _, between in parts],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Products:
    """Inner products of the columns of a model that show in a channel, the misfit last.

    Attributes
    ----------
    columns : TransformedColumns
        The columns.
    within : (ndarray, ndarray), shape (shown, shown)
        Of the deviations within pairs in friction and load.
    of_means : callable
        Those of the pair means, from the numbers of a channel and a noise model.
    """

    columns: TransformedColumns
    within: tuple[Array, Array]
    of_means: Callable[[int, int], Array]
    _between: dict[tuple[int, int], Array] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(cls, columns: TransformedColumns) -> "Products":
        """Return the inner products of columns.

        Parameters
        ----------
        columns : TransformedColumns
            The columns, the misfit last.
        """

        def of_means(channel: int, noise: int) -> Array:
            time, precision = columns.noises.time_and_precision(channel, noise)
            scaled = columns.modes(channel, time) * np.sqrt(precision)[:, np.newaxis]
            return np.asarray(scaled.T @ scaled)

        friction, load = (columns.within(channel) for channel in (0, 1))
        return cls(
            columns=columns, within=(friction.T @ friction, load.T @ load), of_means=of_means
        )

    def beside(self, own: Sequence[Part]) -> "Products":
        """Return the inner products with further columns before the last one, the misfit.

        Parameters
        ----------
        own : sequence of Part
            The further columns, which may show in both channels.
        """
        if not own:
            return self
        known, new = self.columns, TransformedColumns(tuple(own))

        def of_means(channel: int, noise: int) -> Array:
            time, precision = known.noises.time_and_precision(channel, noise)
            modes = new.modes(channel, time)
            if not modes.any():
                none = np.zeros((modes.shape[1],) * 2)
                return bordered(self.between(channel, noise), 0.0, none)
            weighted = modes * precision[:, np.newaxis]
            across = known.modes(channel, time).T @ weighted
            return bordered(self.between(channel, noise), across, modes.T @ weighted)

        within = []
        for channel, before in enumerate(self.within):
            deviations = new.within(channel)
            if not deviations.any():
                none = np.zeros((deviations.shape[1],) * 2)
                within.append(bordered(before, 0.0, none))
                continue
            across = np.vstack(
                [
                    one.columns.channels[channel].within.T @ deviations
                    for one in known.shown(channel)
                ]
            )
            within.append(bordered(before, across, deviations.T @ deviations))
        return Products(columns=known.beside(own), within=(within[0], within[1]), of_means=of_means)

    def between(self, channel: int, noise: int) -> Array:
        """Return the inner products of pair means, shape (shown, shown).

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        noise : int
            Number of the noise model.
        """
        if (channel, noise) not in self._between:
            self._between[channel, noise] = self.of_means(channel, noise)
        return self._between[channel, noise]

    def chosen(self, noise: tuple[int, int]) -> ChosenProducts:
        """Return the inner products under chosen noise models.

        Parameters
        ----------
        noise : (int, int)
            Number of the noise model of friction and load.
        """
        friction, load = (self.between(channel, number) for channel, number in enumerate(noise))
        return ChosenProducts(
            places=self.columns.places, within=self.within, between=(friction, load)
        )


def bordered(old: Array, across: Array | float, own: Array) -> Array:
    """Return inner products with columns inserted before the last one.

    Parameters
    ----------
    old : ndarray, shape (columns, columns)
        Without them.
    across : ndarray, shape (columns, width), or 0.0
        Of the old columns with them; 0 where they do not show.
    own : ndarray, shape (width, width)
        Of them with each other.
    """
    last, width = len(old) - 1, len(own)
    found = np.empty((last + width + 1,) * 2)
    before = np.append(np.arange(last), last + width)
    middle = slice(last, last + width)
    found[before[:, np.newaxis], before] = old
    found[before, middle] = across
    found[middle, before] = np.transpose(across)
    found[middle, middle] = own
    return found
