"""One channel of a step: base and accepted effects there, under the noise that suits them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictioncli.diagnosis.columns import Channel
from frictioncli.diagnosis.joint import Equations, noise_of
from frictioncli.diagnosis.scan import Groups, Null, Scan, Setting, null_of, scan, weighted_gram
from frictioncli.diagnosis.spectra import Modes, Spectra
from frictioncli.model.noise import Noise

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """Friction or load in a step.

    Attributes
    ----------
    spectra : Spectra
        The channel's noises.
    point : float
        Noise of a row about its pair. [N·m]
    base : Channel
        Columns of the base and of the accepted effects.
    misfit : Channel
        The misfit of the simulated torque, one column.
    known : Modes
        Modes of the base's columns and the misfit, at each correlation time.
    null : Null
        The base with the accepted effects alone.
    """

    spectra: Spectra
    point: float
    base: Channel
    misfit: Channel
    known: Modes
    null: Null

    @classmethod
    def of(cls, spectra: Spectra, point: float, base: Channel, misfit: Channel) -> "Side":
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

    def equations(self, rival: Channel, modes: Array, setting: Setting) -> Equations:
        """Return the inner products of base, rival and misfit under one noise.

        Parameters
        ----------
        rival : Channel
            The rival's columns.
        modes : ndarray, shape (pairs, columns)
            Their modes at the noise's correlation time.
        setting : (int, int)
            Place of the noise.
        """
        rows = np.hstack([self.base.inside, rival.inside, self.misfit.inside])
        known = self.known[setting[0]]
        means = np.hstack([known[:, :-1], modes, known[:, -1:]])
        return Equations(
            inside=np.asarray(rows.T @ rows) / self.point**2,
            between=weighted_gram(self.spectra, setting, means),
            determinant=float(self.null.determinant[setting]),
            freedom=self.null.freedom,
        )
