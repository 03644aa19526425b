"""Hypotheses with their columns, and inner products of these with the null hypothesis."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import compress, pairwise

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.columns import RANK, ModelColumns, joined
from frictioncli.diagnosis.fit.hypotheses import Hypothesis
from frictioncli.diagnosis.fit.mixed_model import Variances
from frictioncli.diagnosis.fit.transformed_columns import Part, TransformedColumns
from frictioncli.diagnosis.noise.significance import effective_shapes
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.linear_algebra import orthonormal_basis


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """Hypotheses with their columns.

    Attributes
    ----------
    precomputed : Precomputed
        The data.
    hypotheses : tuple of Hypothesis
        The hypotheses.
    places : tuple of slice
        Columns of each.
    part : Part
        Their columns, side by side.
    """

    precomputed: Precomputed
    hypotheses: tuple[Hypothesis, ...]
    places: tuple[slice, ...]
    part: Part
    _within: dict[tuple[int, int], tuple[Part, Array]] = field(default_factory=dict)
    _stacked: dict[tuple[int, int], tuple[TransformedColumns, Array]] = field(default_factory=dict)
    _own: dict[tuple[int, int], Array] = field(default_factory=dict)
    _directions: dict[int, float] = field(default_factory=dict)
    _parts: dict[tuple[int, int], Part] = field(default_factory=dict)
    _shown: dict[tuple[int, int], bool] = field(default_factory=dict)
    _spans: dict[tuple[bool, ...], Array] = field(default_factory=dict)

    @classmethod
    def of(cls, precomputed: Precomputed, hypotheses: Sequence[Hypothesis]) -> "Catalogue":
        """Return the catalogue of these hypotheses."""
        ends = np.cumsum([0, *(one.columns.count for one in hypotheses)]).tolist()
        none = precomputed.base.take(slice(0, 0))
        columns = joined([one.columns for one in hypotheses] or [none])
        return cls(
            precomputed=precomputed,
            hypotheses=tuple(hypotheses),
            places=tuple(slice(first, last) for first, last in pairwise(ends)),
            part=Part(columns, precomputed.noises),
        )

    def products(
        self, number: int, known: TransformedColumns, variances: Variances
    ) -> tuple[Array, Array]:
        """Return inner products of a hypothesis under given variance components.

        Parameters
        ----------
        number : int
            Number of the hypothesis.
        known : TransformedColumns
            Columns of the null hypothesis and the misfit.
        variances : Variances
            Variance components.

        Returns
        -------
        across : ndarray, shape (columns, shapes * width)
            With the columns of the null hypothesis and the misfit.
        own : ndarray, shape (shapes, width, width)
            Of each shape's columns.
        """
        hypothesis, place = self.hypotheses[number], self.places[number]
        shapes, width = len(hypothesis.shapes), hypothesis.width
        own = np.zeros((shapes, width, width))
        for channel in (0, 1):
            if not self._shows(channel, number):
                continue
            own += self._own_within(channel, number) / variances.within[channel]
            modes, weight = self._modes(channel, place, variances)
            own += _blocks(modes, weight, shapes, width)
        return self.across(number, known, variances), own

    def across(self, number: int, known: TransformedColumns, variances: Variances) -> Array:
        """Return inner products with known columns alone, as of :meth:`products`.

        Parameters
        ----------
        number : int
            Number of the hypothesis.
        known : TransformedColumns
            The known columns.
        variances : Variances
            Variance components.

        Returns
        -------
        ndarray, shape (columns, shapes * width)
        """
        place = self.places[number]
        across = np.zeros((known.count, place.stop - place.start))
        for channel in (0, 1):
            if not self._shows(channel, number):
                continue
            modes, weight = self._modes(channel, place, variances)
            time = self.precomputed.noises.indices[variances.noise[channel]][0]
            own = known.modes(channel, time).T @ (modes * weight[:, np.newaxis])
            own += self._across_within(channel, known, place) / variances.within[channel]
            across[known.places.shown(channel)] += own
        return across

    def _modes(self, channel: int, place: slice, variances: Variances) -> tuple[Array, Array]:
        """Return pair means in the eigenvectors of the noise, and the precision of each."""
        noises, noise = self.precomputed.noises, variances.noise[channel]
        weight = 1 / (noises.variance(channel, noise) * variances.between[channel])
        return self.part.modes(channel, noises.indices[noise][0])[:, place], weight

    def shape_part(self, number: int, shape: int) -> Part:
        """Return the columns of one shape of a hypothesis.

        Parameters
        ----------
        number, shape : int
            Number of the hypothesis, and of its shape.
        """
        if (number, shape) not in self._parts:
            width = self.hypotheses[number].width
            first = self.places[number].start + shape * width
            self._parts[number, shape] = self.part.take(slice(first, first + width))
        return self._parts[number, shape]

    def lengths(self, number: int, shape: int, variances: Variances) -> tuple[float, float]:
        """Return squared lengths of one shape of a hypothesis: within pairs, and of pair means."""
        width = self.hypotheses[number].width
        first = self.places[number].start + shape * width
        within = between = 0.0
        for channel in (0, 1):
            part = self.part.columns.channels[channel]
            deviations = part.within[:, first : first + width]
            within += float(np.sum(np.square(deviations))) / variances.within[channel]
            means = part.means[:, first : first + width]
            centred = means - means.mean(axis=0)
            between += float(np.sum(np.square(centred))) / variances.between[channel]
        return within, between

    def directions(self, number: int) -> float:
        """Return the effective number of independent shapes of a hypothesis.

        From what the base leaves of their columns before anything else is fitted.
        """
        if number not in self._directions:
            alone = len(self.hypotheses[number].shapes) == 1
            self._directions[number] = 1.0 if alone else self._independent(number)
        return self._directions[number]

    def _independent(self, number: int) -> float:
        own = self._over_noise(self.part.columns.take(self.places[number]))
        shown = tuple(bool(one.any()) for one in own)
        if not any(shown):
            return 1.0
        stacked = np.vstack(list(compress(own, shown)))
        if shown not in self._spans:
            beside = np.vstack(list(compress(self._over_noise(self.precomputed.base), shown)))
            self._spans[shown] = orthonormal_basis(beside, tolerance=RANK)
        span = self._spans[shown]
        left = stacked - span @ (span.T @ stacked)
        return effective_shapes(left.T @ left, self.hypotheses[number].width)

    def _over_noise(self, columns: ModelColumns) -> list[Array]:
        """Return the parts of columns over their noise before anything is fitted."""
        start, found = self.precomputed.start, []
        for channel, part in enumerate(columns.channels):
            found.append(part.within / np.sqrt(start.within[channel]))
            found.append(part.means / np.sqrt(start.between[channel]))
        return found

    def _shows(self, channel: int, number: int) -> bool:
        """Return whether a hypothesis has any torque in a channel."""
        if (channel, number) not in self._shown:
            part, place = self.part.columns.channels[channel], self.places[number]
            shown = part.within[:, place].any() or part.means[:, place].any()
            self._shown[channel, number] = bool(shown)
        return self._shown[channel, number]

    def _across_within(self, channel: int, known: TransformedColumns, place: slice) -> Array:
        """Return inner products of deviations with those of known columns that show."""
        if (channel, id(known)) not in self._stacked:
            found = [self._within_products(channel, part) for part in known.shown(channel)]
            # the known columns live as long as their number
            self._stacked[channel, id(known)] = (known, np.vstack(found))
        return self._stacked[channel, id(known)][1][:, place]

    def _within_products(self, channel: int, part: Part) -> Array:
        """Return inner products of deviations with those of a part of known columns."""
        key = (channel, id(part))
        if key not in self._within:
            own = self.part.columns.channels[channel].within
            product = part.columns.channels[channel].within.T @ own
            self._within[key] = (part, product)  # the part lives as long as its number
        return self._within[key][1]

    def _own_within(self, channel: int, number: int) -> Array:
        if (channel, number) not in self._own:
            hypothesis = self.hypotheses[number]
            part = self.part.columns.channels[channel].within[:, self.places[number]]
            self._own[channel, number] = _blocks(
                part, None, len(hypothesis.shapes), hypothesis.width
            )
        return self._own[channel, number]


def _blocks(columns: Array, weight: Array | None, shapes: int, width: int) -> Array:
    """Return inner products within each shape, shape (shapes, width, width)."""
    grouped = columns.reshape(len(columns), shapes, width)
    weights = np.ones(len(columns)) if weight is None else weight
    found = np.empty((shapes, width, width))
    for first in range(width):
        for second in range(first, width):
            products = grouped[:, :, first] * grouped[:, :, second]
            found[:, first, second] = found[:, second, first] = weights @ products
    return found
