"""Inner products of the columns of a model with a torque that is planted into its misfit."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.mixed_model import Variances
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import Part, TransformedColumns


@dataclass(frozen=True, slots=True)
class WithinProducts:
    """Inner products of deviations within pairs with those of a part, under no weight.

    Attributes
    ----------
    across : (ndarray, ndarray), shape (shown, columns of the part)
        Of the other columns that show in friction and load with those of the part.
    own : (ndarray, ndarray), shape (columns of the part, columns of the part)
        Of its columns with each other.
    """

    across: tuple[Array, Array]
    own: tuple[Array, Array]

    @classmethod
    def of(cls, columns: TransformedColumns, other: Part) -> "WithinProducts":
        """Return the products of columns with a part, for any variance components.

        Parameters
        ----------
        columns : TransformedColumns
            The columns.
        other : Part
            The part.
        """
        friction, load = (one.within for one in other.columns.channels)
        return cls(
            (columns.within_products(other, 0), columns.within_products(other, 1)),
            (friction.T @ friction, load.T @ load),
        )


def weighted_products(
    columns: TransformedColumns, other: Part, variances: Variances, known: WithinProducts
) -> tuple[Array, Array]:
    """Return inner products of columns with a part under given variance components.

    Parameters
    ----------
    columns : TransformedColumns
        The columns.
    other : Part
        The other part.
    variances : Variances
        Variance components.
    known : WithinProducts
        Their products of deviations within pairs.

    Returns
    -------
    across : ndarray, shape (columns, columns of the other)
        With its columns.
    own : ndarray, shape (columns of the other, columns of the other)
        Of its columns with each other.
    """
    count = other.columns.count
    across, own = np.zeros((columns.count, count)), np.zeros((count, count))
    for channel, noise in enumerate(variances.noise):
        own += known.own[channel] / variances.within[channel]
        time = columns.noises.indices[noise][0]
        modes = other.modes(channel, time)
        variance = columns.noises.variance(channel, noise) * variances.between[channel]
        scaled = modes / variance[:, np.newaxis]
        across[columns.places.shown(channel)] += (
            known.across[channel] / variances.within[channel]
            + columns.modes(channel, time).T @ scaled
        )
        own += modes.T @ scaled
    return across, own


def with_torque(products: Products, torque: Part) -> Products:
    """Return inner products of columns with a torque added to the last of these, the misfit.

    Parameters
    ----------
    products : Products
        Inner products of the columns.
    torque : Part
        The torque, one column.
    """
    columns, within = products.columns, []
    for channel in (0, 1):
        deviations = torque.columns.channels[channel].within[:, 0]
        across = columns.within_products(torque, channel)[:, 0]
        own = float(np.sum(np.square(deviations)))
        within.append(_with_last(products.within[channel], across, own))

    def of_means(channel: int, noise: int) -> Array:
        time, precision = columns.noises.time_and_precision(channel, noise)
        modes = torque.modes(channel, time)[:, 0]
        across = (modes * precision) @ columns.modes(channel, time)
        own = float(np.square(modes) @ precision)
        return _with_last(products.between(channel, noise), across, own)

    *parts, misfit = columns.parts
    added = Part(misfit.columns.plus(torque.columns), columns.noises)
    return Products(
        columns=TransformedColumns((*parts, added)),
        within=(within[0], within[1]),
        of_means=of_means,
    )


def _with_last(gram: Array, across: Array, own: float) -> Array:
    """Return inner products of columns with another one added to the last of them."""
    found = gram.copy()
    found[-1] += across
    found[:, -1] += across
    found[-1, -1] += own
    return found
