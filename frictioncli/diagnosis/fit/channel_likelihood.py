"""One channel of a step: base and accepted effects there, under the noise that suits them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.fit.columns import ChannelColumns
from frictioncli.diagnosis.fit.two_channel_fit import NormalEquations, noise_of
from frictioncli.diagnosis.noise.likelihood_scan import (
    Null,
    Scan,
    Setting,
    null_of,
    scan,
    weighted_gram,
)
from frictioncli.diagnosis.noise.orthonormal_groups import Groups
from frictioncli.diagnosis.noise.spectra import Modes, Spectra
from frictioncli.model.noise import Noise


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelLikelihood:
    """Friction or load in a step.

    Attributes
    ----------
    spectra : Spectra
        The channel's noises.
    point : float
        Noise of a row about its pair. [N·m]
    base : ChannelColumns
        Columns of the base and of the accepted effects.
    misfit : ChannelColumns
        The misfit of the simulated torque, one column.
    known : Modes
        Modes of the base's columns and the misfit, at each correlation time.
    null : Null
        The base with the accepted effects alone.
    """

    spectra: Spectra
    point: float
    base: ChannelColumns
    misfit: ChannelColumns
    known: Modes
    null: Null

    @classmethod
    def of(
        cls, spectra: Spectra, point: float, base: ChannelColumns, misfit: ChannelColumns
    ) -> "ChannelLikelihood":
        """Return the side with the noise that suits the base."""
        return cls(
            spectra=spectra,
            point=point,
            base=base,
            misfit=misfit,
            known=spectra.all_modes(np.hstack([base.means, misfit.means])),
            null=null_of(spectra, base.means, misfit.means),
        )

    def noise(self, scale: float) -> Noise:
        """Return the noise that suits base and accepted effects, from its scale. [(N·m)²]."""
        return noise_of(self.spectra, self.null.best, scale, self.point)

    def scan(
        self, rivals: Modes, groups: Groups, draws: int, generator: np.random.Generator
    ) -> Scan:
        """Set groups of columns against the base under every noise, as :func:`scan`."""
        return scan(self.spectra, self.null, rivals, groups, draws, generator)

    def equations(self, rival: ChannelColumns, modes: Array, setting: Setting) -> NormalEquations:
        """Return the inner products of base, rival and misfit under one noise.

        Parameters
        ----------
        rival : ChannelColumns
            The rival's columns.
        modes : ndarray, shape (pairs, columns)
            Their modes at the noise's correlation time.
        setting : (int, int)
            Place of the noise.
        """
        alone = self.equations_each(rival, modes, np.arange(rival.count)[np.newaxis], setting)
        return replace(alone, inside=alone.inside[0], between=alone.between[0])

    def equations_each(
        self, rivals: ChannelColumns, modes: Array, columns: Indices, setting: Setting
    ) -> NormalEquations:
        """Return the inner products of base, each of many rivals, and misfit under one noise.

        Parameters
        ----------
        rivals : ChannelColumns
            Columns of the rivals.
        modes : ndarray, shape (pairs, columns)
            Their modes at the noise's correlation time.
        columns : ndarray of int, shape (rivals, width)
            Which columns are whose.
        setting : (int, int)
            Place of the noise.
        """
        known = np.hstack([self.base.inside, self.misfit.inside])
        return NormalEquations(
            inside=_bordered(_inner, known, rivals.inside, columns) / self.point**2,
            between=_bordered(
                partial(weighted_gram, self.spectra, setting),
                self.known[setting[0]],
                modes,
                columns,
            ),
            determinant=float(self.null.determinant[setting]),
            freedom=self.null.freedom,
        )


def _inner(first: Array, second: Array) -> Array:
    return np.asarray(first.swapaxes(-1, -2) @ second)


def _bordered(
    product: Callable[[Array, Array], Array],
    known: Array,
    rivals: Array,
    columns: Indices,
) -> Array:
    """Return inner products of the base's columns, each rival's, and the misfit.

    Parameters
    ----------
    product : callable
        Inner products of the columns of one array with those of another.
    known : ndarray, shape (rows, base + 1)
        The base's columns, then the misfit; their products are the same beside all rivals.
    rivals : ndarray, shape (rows, columns)
        Columns of the rivals.
    columns : ndarray of int, shape (rivals, width)
        Which columns are whose.

    Returns
    -------
    ndarray, shape (rivals, base + width + 1, base + width + 1)
        The base's columns first, the misfit last.
    """
    own = np.moveaxis(rivals[:, columns], 1, 0)
    across = product(own, known)
    base, width = known.shape[1] - 1, columns.shape[1]
    found = np.empty((len(columns), base + width + 1, base + width + 1))
    middle = slice(base, base + width)
    place = np.delete(np.arange(base + width + 1), middle)
    found[:, place[:, np.newaxis], place] = product(known, known)
    found[:, middle, middle] = product(own, own)
    found[:, middle, place] = across
    found[:, place, middle] = across.swapaxes(-1, -2)
    return found
