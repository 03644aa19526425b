"""Inner products of the columns of a mixed model, and of the same with further columns."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Products:
    """Inner products of all columns of a model, the misfit last.

    Attributes
    ----------
    within : (ndarray, ndarray), shape (columns, columns)
        Of the deviations within pairs in friction and load.
    between : (ndarray, ndarray), shape (noise models, columns, columns)
        Of the pair means under each noise model.
    """

    within: tuple[Array, Array]
    between: tuple[Array, Array]

    def chosen(self, noise: tuple[int, int]) -> Array:
        """Return the inner products under chosen noise models, shape (4, columns, columns).

        Within pairs and of pair means: of friction, then of load.

        Parameters
        ----------
        noise : (int, int)
            Number of the noise model of friction and load.
        """
        parts = zip(self.within, self.between, noise, strict=True)
        return np.stack([one for within, between, at in parts for one in (within, between[at])])

    def of_base(self, base: int) -> tuple[Array, Array]:
        """Return those of the first columns alone, shape (noise models, columns, columns) each."""
        return self.between[0][:, :base, :base], self.between[1][:, :base, :base]

    def with_rest(self, channel: int, base: int, rest: Array) -> Array:
        """Return products of all columns with a combination of those that follow the base.

        Parameters
        ----------
        channel : int
            0 for friction, 1 for load.
        base : int
            Number of columns of the base.
        rest : ndarray, shape (columns - base,)
            The combination.

        Returns
        -------
        ndarray, shape (noise models, columns)
            Of the pair means.
        """
        return np.asarray(self.between[channel][:, :, base:] @ rest)


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

    def whole(self) -> Products:
        """Return them as one."""
        known = self.known
        within = [
            bordered(*one)
            for one in zip(known.within, self.across_within, self.own_within, strict=True)
        ]
        between = [bordered(*one) for one in zip(known.between, self.across, self.own, strict=True)]
        return Products(within=(within[0], within[1]), between=(between[0], between[1]))

    def chosen(self, noise: tuple[int, int]) -> Array:
        """Return what :meth:`Products.chosen` does."""
        found = []
        for channel, at in enumerate(noise):
            found += [
                bordered(
                    self.known.within[channel],
                    self.across_within[channel],
                    self.own_within[channel],
                ),
                bordered(
                    self.known.between[channel][at],
                    self.across[channel][at],
                    self.own[channel][at],
                ),
            ]
        return np.stack(found)

    def of_base(self, base: int) -> tuple[Array, Array]:
        """Return what :meth:`Products.of_base` does."""
        return self.known.of_base(base)

    def with_rest(self, channel: int, base: int, rest: Array) -> Array:
        """Return what :meth:`Products.with_rest` does."""
        across, own = self.across[channel], self.own[channel]
        width = own.shape[-1]
        before, further = np.append(rest[: -width - 1], rest[-1]), rest[-width - 1 : -1]
        old = self.known.with_rest(channel, base, before) + across @ further
        new = (before @ across[:, base:]) + own @ further
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
