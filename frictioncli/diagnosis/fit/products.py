"""Inner products of the columns of a mixed model, and of the same with further columns.

Those of a channel are of the columns that show in it, of which those that show in no other come
first.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices


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

    def bordered(self, width: int) -> "Places":
        """Return the places with further columns, shown in both channels, before the misfit."""
        last = int(self.shared[-1])
        further = np.arange(last, last + width + 1)
        return Places(self.own, np.concatenate([self.shared[:-1], further]))


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
        return [one / of_one + two / of_two for one, of_one, two, of_two in parts]

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
    places : Places
        Where the columns show.
    within : (ndarray, ndarray), shape (shown, shown)
        Of the deviations within pairs in friction and load.
    between : (ndarray, ndarray), shape (noise models, shown, shown)
        Of the pair means under each noise model.
    """

    places: Places
    within: tuple[Array, Array]
    between: tuple[Array, Array]

    def chosen(self, noise: tuple[int, int]) -> ChosenProducts:
        """Return the inner products under chosen noise models.

        Parameters
        ----------
        noise : (int, int)
            Number of the noise model of friction and load.
        """
        friction, load = (one[at] for one, at in zip(self.between, noise, strict=True))
        return ChosenProducts(places=self.places, within=self.within, between=(friction, load))

    def of_base(self, base: int) -> tuple[Array, Array]:
        """Return those of the first columns alone, shape (noise models, columns, columns) each."""
        first, second = (slice(len(own), len(own) + base) for own in self.places.own)
        return self.between[0][:, first, first], self.between[1][:, second, second]

    def with_combination(self, channel: int, combination: Array) -> Array:
        """Return products of the columns that show with a combination of them.

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        combination : ndarray, shape (shown,)
            The combination.

        Returns
        -------
        ndarray, shape (noise models, shown)
            Of the pair means.
        """
        return np.asarray(self.between[channel] @ combination)


@dataclass(frozen=True, slots=True, kw_only=True)
class BorderedProducts:
    """The same with further columns before the last one; without copying what is known.

    Attributes
    ----------
    known : Products
        Without these columns.
    across_within, own_within : (ndarray, ndarray)
        Products of the known columns with them, and of them with each other, of the deviations
        within pairs in friction and load.
    across, own : (ndarray, ndarray)
        The same of the pair means, under each noise model.
    """

    known: Products
    across_within: tuple[Array, Array]
    own_within: tuple[Array, Array]
    across: tuple[Array, Array]
    own: tuple[Array, Array]

    @property
    def places(self) -> Places:
        """Where the columns show: the further ones in both channels."""
        return self.known.places.bordered(self.own[0].shape[-1])

    def whole(self) -> Products:
        """Return them as one."""
        parts = zip(self.known.between, self.across, self.own, strict=True)
        friction, load = (bordered(*one) for one in parts)
        return Products(places=self.places, within=self._within(), between=(friction, load))

    def chosen(self, noise: tuple[int, int]) -> ChosenProducts:
        """Return what :meth:`Products.chosen` does."""
        friction, load = (
            bordered(known[at], across[at], own[at])
            for known, across, own, at in zip(
                self.known.between, self.across, self.own, noise, strict=True
            )
        )
        return ChosenProducts(places=self.places, within=self._within(), between=(friction, load))

    def _within(self) -> tuple[Array, Array]:
        """Return the products of the deviations within pairs as one."""
        parts = zip(self.known.within, self.across_within, self.own_within, strict=True)
        friction, load = (bordered(*one) for one in parts)
        return friction, load

    def of_base(self, base: int) -> tuple[Array, Array]:
        """Return what :meth:`Products.of_base` does."""
        return self.known.of_base(base)

    def with_combination(self, channel: int, combination: Array) -> Array:
        """Return what :meth:`Products.with_combination` does."""
        across, own = self.across[channel], self.own[channel]
        width = own.shape[-1]
        before = np.append(combination[: -width - 1], combination[-1])
        further = combination[-width - 1 : -1]
        old = self.known.with_combination(channel, before) + across @ further
        new = before @ across + own @ further
        return np.concatenate([old[:, :-1], new, old[:, -1:]], axis=1)


AnyProducts = Products | BorderedProducts


def bordered(old: Array, across: Array, own: Array) -> Array:
    """Return inner products with columns inserted before the last one.

    Parameters
    ----------
    old : ndarray, shape (..., columns, columns)
        Without them.
    across : ndarray, shape (..., columns, width)
        Of the old columns with them.
    own : ndarray, shape (..., width, width)
        Of them with each other.
    """
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
