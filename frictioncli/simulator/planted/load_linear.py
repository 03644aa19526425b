"""Friction that grows with the absolute load."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadLinear(PlantedEffect):
    r"""Friction proportional to the absolute load, rounded where the load vanishes.

    Attributes
    ----------
    magnitude : float
        Torque at 50 N·m. [N·m]
    rounding : float
        Load below which the law is round. [N·m]

    Notes
    -----
    .. math:: m \left(\sqrt{L^2 + L_r^2} - L_r\right) / 50

    Range: rounding 0.5 to 5 N·m. A textbook column is the absolute load with its cusp.
    """

    name: ClassVar[str] = "load_linear"
    equation: ClassVar[str] = "m (sqrt(L^2 + Lr^2) - Lr) / 50"

    rounding: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            rounding=log_uniform(generator, 0.5, 5.0),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        rounded = np.hypot(state.load, self.rounding) - self.rounding
        return Extra(friction=self.magnitude * rounded / 50.0)
