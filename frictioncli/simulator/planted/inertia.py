"""Speed that still settles when it already looks constant."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertia(PlantedEffect):
    r"""Inertia that is not in the model, and a speed that settles slowly.

    Attributes
    ----------
    magnitude : float
        Inertia. [kg·m²]
    settling : float
        Time constant of the settling speed. [s]

    Notes
    -----
    .. math:: m \left(\ddot q + \frac{v}{\tau} e^{-t/\tau}\right)

    Range: settling 0.15 to 0.6 s. Its size counts within 20 deg after a reversal. A textbook column
    is an inertia times the measured acceleration, or a term with the square of speed.
    """

    name: ClassVar[str] = "inertia"
    equation: ClassVar[str] = (
        "m (dv/dt + v / tau exp(-t / tau)) pi / 180, t since the reversal, on the load"
    )
    at_reversal: ClassVar[bool] = True

    settling: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            settling=log_uniform(generator, 0.15, 0.6),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        fading = np.exp(-state.since_reversal / self.settling)
        settling = state.velocity / self.settling * fading
        return Extra(load=self.magnitude * np.radians(state.acceleration + settling))
