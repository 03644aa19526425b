"""Friction that differs between the directions."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, sign
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class DirectionAsymmetry(PlantedEffect):
    r"""Friction that is greater in one direction.

    Attributes
    ----------
    magnitude : float
        Torque at 50 deg/s and 40 °C. [N·m]
    constant : float
        Share w that does not depend on speed. [-]
    exponent : float
        Exponent p of the rest. [-]
    thinning : float
        Fall of the rest with motor temperature. [1/K]
    way : float
        +1: more friction forward; -1: more backward. [-]

    Notes
    -----
    .. math:: s\,m \operatorname{sign}(v) \left(w + (1 - w)(|v|/50)^p e^{-d (T_m - 40)}\right)

    Ranges: share of the constant part 0 to 1, exponent 0.3 to 0.7, thinning 0.02 to 0.06 1/K,
    either sign. A textbook column has the speed law of the model that is fitted.
    """

    name: ClassVar[str] = "direction_asymmetry"
    equation: ClassVar[str] = "s m sign(v) (w + (1 - w) (|v| / 50)^p exp(-d (Tmotor - 40)))"

    constant: float
    exponent: float
    thinning: float
    way: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            constant=float(generator.uniform(0.0, 1.0)),
            exponent=float(generator.uniform(0.3, 0.7)),
            thinning=float(generator.uniform(0.02, 0.06)),
            way=sign(generator),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        thin = np.exp(-self.thinning * (state.motor - 40.0))
        viscous = (state.speed / 50.0) ** self.exponent * thin
        law = self.constant + (1.0 - self.constant) * viscous
        return Extra(friction=self.way * self.magnitude * state.direction * law)
