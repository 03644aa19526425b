"""Likelihood of one channel: base and accepted effects, and candidates tested beside them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.fit.columns import ChannelColumns
from frictioncli.diagnosis.fit.two_channel_fit import NormalEquations, noise_of
from frictioncli.diagnosis.noise.likelihood_scan import NullFit, Scan, fit_null, scan
from frictioncli.diagnosis.noise.orthonormal_groups import Groups
from frictioncli.diagnosis.noise.spectra import Modes, NoiseIndex, Spectra, weighted_gram
from frictioncli.model.noise import Noise


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelLikelihood:
    """The null hypothesis of one step of the search in the friction or the load channel.

    Attributes
    ----------
    spectra : Spectra
        The channel's noise models.
    point : float
        Standard deviation of an angle bin about the mean of its pair. [N·m]
    base : ChannelColumns
        Columns of the base and of the accepted effects.
    misfit : ChannelColumns
        The misfit of the simulated torque, one column.
    known : Modes
        Modes of the base's columns and of the misfit, at each correlation time.
    null : NullFit
        Base and accepted effects alone.
    """

    spectra: Spectra
    point: float
    base: ChannelColumns
    misfit: ChannelColumns
    known: Modes
    null: NullFit

    @classmethod
    def of(
        cls, spectra: Spectra, point: float, base: ChannelColumns, misfit: ChannelColumns
    ) -> "ChannelLikelihood":
        """Return the likelihood of a channel with the noise model that suits the base best."""
        return cls(
            spectra=spectra,
            point=point,
            base=base,
            misfit=misfit,
            known=spectra.all_modes(np.hstack([base.means, misfit.means])),
            null=fit_null(spectra, base.means, misfit.means),
        )

    def noise(self, scale: float) -> Noise:
        """Return the noise under the null hypothesis from its scale [(N·m)²]."""
        return noise_of(self.spectra, self.null.best, scale, self.point)

    def scan(
        self, candidates: Modes, groups: Groups, draws: int, generator: np.random.Generator
    ) -> Scan:
        """Compare groups of columns with the base under every noise model, as :func:`scan`."""
        return scan(self.spectra, self.null, candidates, groups, draws, generator)

    def normal_equations(
        self, candidate: ChannelColumns, modes: Array, noise: NoiseIndex
    ) -> NormalEquations:
        """Return the inner products of base, candidate and misfit under one noise model.

        Parameters
        ----------
        candidate : ChannelColumns
            The candidate's columns.
        modes : ndarray, shape (pairs, columns)
            Their modes at the correlation time of the noise.
        noise : (int, int)
            Index of the noise model.
        """
        columns = np.arange(candidate.count)[np.newaxis]
        alone = self.normal_equations_each(candidate, modes, columns, noise)
        return replace(alone, within=alone.within[0], between=alone.between[0])

    def normal_equations_each(
        self, candidates: ChannelColumns, modes: Array, columns: Indices, noise: NoiseIndex
    ) -> NormalEquations:
        """Return the inner products of base, each of many candidates, and misfit.

        Parameters
        ----------
        candidates : ChannelColumns
            Columns of the candidates.
        modes : ndarray, shape (pairs, columns)
            Their modes at the correlation time of the noise.
        columns : ndarray of int, shape (candidates, width)
            Which columns belong to which candidate.
        noise : (int, int)
            Index of the noise model.
        """
        known = np.hstack([self.base.within, self.misfit.within])
        return NormalEquations(
            within=_bordered(_inner, known, candidates.within, columns) / self.point**2,
            between=_bordered(
                partial(weighted_gram, self.spectra, noise),
                self.known[noise[0]],
                modes,
                columns,
            ),
            determinant=float(self.null.determinant[noise]),
            freedom=self.null.freedom,
        )


def _inner(first: Array, second: Array) -> Array:
    return np.asarray(first.swapaxes(-1, -2) @ second)


def _bordered(
    product: Callable[[Array, Array], Array],
    known: Array,
    candidates: Array,
    columns: Indices,
) -> Array:
    """Return inner products of the base's columns, each candidate's, and the misfit.

    Parameters
    ----------
    product : callable
        Inner products of the columns of one array with those of another.
    known : ndarray, shape (rows, base + 1)
        The base's columns, then the misfit; their products are the same for all candidates.
    candidates : ndarray, shape (rows, columns)
        Columns of the candidates.
    columns : ndarray of int, shape (candidates, width)
        Which columns belong to which candidate.

    Returns
    -------
    ndarray, shape (candidates, base + width + 1, base + width + 1)
        The base's columns first, the misfit last.
    """
    grouped = np.moveaxis(candidates[:, columns], 1, 0)
    across = product(grouped, known)
    base, width = known.shape[1] - 1, columns.shape[1]
    found = np.empty((len(columns), base + width + 1, base + width + 1))
    middle = slice(base, base + width)
    place = np.delete(np.arange(base + width + 1), middle)
    found[:, place[:, np.newaxis], place] = product(known, known)
    found[:, middle, middle] = product(grouped, grouped)
    found[:, middle, place] = across
    found[:, place, middle] = across.swapaxes(-1, -2)
    return found
