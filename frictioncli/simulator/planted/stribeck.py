"""Boundary lubrication at low speed, with a Stribeck velocity that shifts with temperature."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(PlantedEffect):
    r"""Friction that falls with speed out of boundary lubrication.

    Attributes
    ----------
    magnitude : float
        Torque at rest. [N·m]
    velocity : float
        Stribeck velocity at 40 °C. [deg/s]
    exponent : float
        Exponent k. [-]
    shift : float
        Growth of the velocity with gear temperature. [1/K]

    Notes
    -----
    .. math:: m\,e^{-(|v|/v_s)^k},\quad v_s = v_{40} e^{c (T_g - 40)}

    Ranges: velocity 3 to 15 deg/s, exponent 0.8 to 2, shift 0 to 0.02 1/K. A textbook column has a
    fixed velocity and exponent 1 or 2; here warm grease moves the fall to higher speeds.
    """

    name: ClassVar[str] = "stribeck"
    equation: ClassVar[str] = "m exp(-(|v| / vs)^k), vs = vs40 exp(c (Tgear - 40))"

    velocity: float
    exponent: float
    shift: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            velocity=log_uniform(generator, 3.0, 15.0),
            exponent=float(generator.uniform(0.8, 2.0)),
            shift=float(generator.uniform(0.0, 0.02)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        velocity = self.velocity * np.exp(self.shift * (state.gear - 40.0))
        return Extra(friction=self.magnitude * np.exp(-((state.speed / velocity) ** self.exponent)))
