"""Coulomb friction that falls with the motor temperature."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class CoulombTemperature(PlantedEffect):
    r"""Coulomb friction that depends on temperature.

    Attributes
    ----------
    magnitude : float
        Torque that falls. [N·m]
    rate : float
        Rate k of the fall. [1/K]
    reference : float
        Temperature at which nothing is added. [°C]

    Notes
    -----
    .. math:: m \left(e^{-k (T_m - T_0)} - 1\right)

    Ranges: rate 0.005 to 0.03 1/K, reference 30 to 55 °C. A textbook column is linear in
    temperature.
    """

    name: ClassVar[str] = "coulomb_temperature"
    equation: ClassVar[str] = "m (exp(-k (Tmotor - T0)) - 1)"

    rate: float
    reference: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            rate=log_uniform(generator, 0.005, 0.03),
            reference=float(generator.uniform(30.0, 55.0)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        fall = np.expm1(-self.rate * (state.motor - self.reference))
        return Extra(friction=self.magnitude * fall)
