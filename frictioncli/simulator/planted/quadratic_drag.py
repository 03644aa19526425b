"""Churning of the lubricant, which grows about with the square of speed."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class QuadraticDrag(PlantedEffect):
    r"""Churning drag.

    Attributes
    ----------
    magnitude : float
        Torque at 100 deg/s and 40 °C. [N·m]
    exponent : float
        Exponent n. [-]
    thinning : float
        Fall with gear temperature. [1/K]

    Notes
    -----
    .. math:: m\,(|v|/100)^n e^{-c (T_g - 40)}

    Ranges: exponent 1.85 to 2.3, thinning 0 to 0.01 1/K. A textbook column is the exact square.
    """

    name: ClassVar[str] = "quadratic_drag"
    equation: ClassVar[str] = "m (|v| / 100)^n exp(-c (Tgear - 40))"

    exponent: float
    thinning: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            exponent=float(generator.uniform(1.85, 2.3)),
            thinning=float(generator.uniform(0.0, 0.01)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        thin = np.exp(-self.thinning * (state.gear - 40.0))
        return Extra(friction=self.magnitude * thin * (state.speed / 100.0) ** self.exponent)
