"""Friction that builds up again after each reversal."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class ReversalTransient(PlantedEffect):
    r"""Presliding: friction that is not whole yet after a reversal.

    Attributes
    ----------
    magnitude : float
        Torque that is missing right after the reversal. [N·m]
    travel : float
        Angle over which friction comes back. [deg]
    exponent : float
        Exponent c. [-]

    Notes
    -----
    .. math:: -m\,e^{-(s/s_0)^c}

    Ranges: travel 4 to 15 deg, exponent 0.8 to 1.3. Its size counts within 20 deg after a reversal.
    A textbook column is a plain exponential.
    """

    name: ClassVar[str] = "reversal_transient"
    equation: ClassVar[str] = "-m exp(-(s / s0)^c), s angle since the reversal"
    at_reversal: ClassVar[bool] = True

    travel: float
    exponent: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            travel=log_uniform(generator, 4.0, 15.0),
            exponent=float(generator.uniform(0.8, 1.3)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        ratio = state.since_turn / self.travel
        return Extra(friction=-self.magnitude * np.exp(-(ratio**self.exponent)))
